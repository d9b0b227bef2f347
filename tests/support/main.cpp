#include <gtest/gtest.h>

#include "runtime/wide_vectors.h"

/// Lavapipe's vectors are chosen before any device is made, as the program does: Mesa goes by the environment
/// anew for every device, so those made earlier would go on with another width and keep kernels of both in one
/// folder.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  vkopple::prefer_wide_vectors();
  return RUN_ALL_TESTS();
}
