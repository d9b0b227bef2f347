#include "train/parallel/memory_share.h"

#include <unistd.h>

#include <array>
#include <string>

#include "runtime/caps.h"
#include "train/parallel/agreement.h"

namespace vkopple {

uint64_t memory_share(uint64_t free, const Caps& caps, Peers* peers) {
  std::array<char, 256> machine{};
  ::gethostname(machine.data(), machine.size() - 1);
  return free / static_cast<uint64_t>(count_same(peers, machine.data() + uuid_text(caps.uuid)));
}

}  // namespace vkopple
