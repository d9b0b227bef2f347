#include "tests/fuzz/guarded_copy.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>

namespace vkopple::fuzz {

GuardedCopy::GuardedCopy(Input bytes, Edge edge) {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t inner = (bytes.size() / page + 1) * page;
  length_ = inner + 2 * page;
  pages_ = ::mmap(nullptr, length_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  require(pages_ != MAP_FAILED, "pages can be mapped");
  auto* begin = static_cast<std::byte*>(pages_) + page;
  require(::mprotect(begin, inner, PROT_READ | PROT_WRITE) == 0, "pages can be opened");
  if (edge == Edge::kLast) begin += inner - bytes.size();
  std::copy(bytes.begin(), bytes.end(), begin);
  copy_ = Input(begin, bytes.size());
}

GuardedCopy::~GuardedCopy() { ::munmap(pages_, length_); }

}  // namespace vkopple::fuzz
