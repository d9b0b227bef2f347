#include "graph/shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "runtime/error.h"

namespace vkopple {

Shape::Shape(std::span<const int64_t> sizes) : rank_(sizes.size()) {
  if (sizes.size() > kMaxRank)
    throw Error(fmt::format("a tensor of {} axes; at most {} are allowed", rank_, kMaxRank));
  std::copy(sizes.begin(), sizes.end(), sizes_.begin());
  for (int64_t size : sizes)
    if (size < 1) throw Error(fmt::format("shape {} has a size below 1", text()));
}

int64_t Shape::elements() const { return product(0, rank_); }

int64_t Shape::product(size_t begin, size_t end) const {
  int64_t n = 1;
  for (size_t i = begin; i < end; ++i) n *= sizes_[i];
  return n;
}

Shape Shape::with(size_t axis, int64_t size) const {
  auto sizes = sizes_;
  sizes.at(axis) = size;
  return Shape(std::span<const int64_t>(sizes).first(rank_));
}

std::string Shape::text() const { return fmt::format("({})", fmt::join(sizes(), ", ")); }

bool Shape::operator==(const Shape& other) const {
  return std::equal(sizes().begin(), sizes().end(), other.sizes().begin(), other.sizes().end());
}

}  // namespace vkopple
