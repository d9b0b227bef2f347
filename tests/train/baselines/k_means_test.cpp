#include "train/baselines/k_means.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

using Labels = std::vector<std::int32_t>;

/// A grey picture 6 wide and 4 high: 0.5, two blobs of 0 and of 1 within.
std::vector<float> two_blobs() {
  std::vector<float> image(72, 0.5F);
  for (std::size_t c = 0; c < 3; ++c)
    for (const std::size_t row : {1, 2}) {
      image[24 * c + 6 * row + 1] = 0;
      image[24 * c + 6 * row + 4] = 1;
    }
  return image;
}

TEST(KMeans, BlobsComeApartAndTheBorderIsLast) {
  const Labels labels = k_means_labels(two_blobs(), 4, 6, 3);
  const Labels dark{7, 13}, bright{10, 16};
  ASSERT_EQ(labels.size(), 24U);
  for (std::size_t p = 0; p < labels.size(); ++p) {
    const bool is_dark = p == 7 || p == 13, is_bright = p == 10 || p == 16;
    EXPECT_EQ(labels[p], is_dark ? labels[7] : is_bright ? labels[10] : 2) << p;
  }
  EXPECT_NE(labels[7], labels[10]);
  EXPECT_EQ(labels[7] + labels[10], 1);
}

TEST(KMeans, OneColourIsCutByPlace) {
  const Labels labels = k_means_labels(std::vector<float>(3 * 8, 0.5F), 1, 8, 2);
  EXPECT_EQ(labels[0], labels[3]);
  EXPECT_EQ(labels[5], labels[7]);
  EXPECT_NE(labels[0], labels[7]);
}

TEST(KMeans, CentresMoveToTheMiddleOfTheirPixels) {
  // Centres start at the pixels of 0.4, nearest to the mean, and of 1: 0.62 is nearer to the first. As means of
  // their pixels they are at 0.2 and 0.98, of which 0.62 is nearer to the second.
  std::vector<float> image;
  for (int c = 0; c < 3; ++c) image.insert(image.end(), {0.0F, 0.0F, 0.0F, 0.4F, 0.62F, 1.0F, 0.95F});
  const Labels labels = k_means_labels(image, 1, 7, 2);
  EXPECT_EQ(labels[0], labels[3]);
  EXPECT_EQ(labels[4], labels[5]);
  EXPECT_NE(labels[0], labels[5]);
}

TEST(KMeans, OneClusterAndMoreClustersThanPixels) {
  EXPECT_EQ(k_means_labels(two_blobs(), 4, 6, 1), Labels(24, 0));
  const Labels labels = k_means_labels(std::vector<float>{0, 1, 0, 1, 0, 1}, 1, 2, 5);
  EXPECT_NE(labels[0], labels[1]);
}

}  // namespace
}  // namespace vkopple
