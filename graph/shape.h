#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace vkopple {

/// Sizes of a tensor, outermost first; rank 0 (a scalar) to 6, every size at least 1.
class Shape {
 public:
  static constexpr size_t kMaxRank = 6;
  Shape() = default;
  /// Throws Error for a size below 1 or too many of them.
  Shape(std::initializer_list<int64_t> sizes) : Shape(std::span(sizes.begin(), sizes.size())) {}
  explicit Shape(std::span<const int64_t> sizes);

  size_t rank() const { return rank_; }
  int64_t operator[](size_t axis) const { return sizes_[axis]; }
  /// Axis counted from the end: back(0) is the innermost.
  int64_t back(size_t axis) const { return sizes_[rank_ - 1 - axis]; }
  int64_t elements() const;
  /// Product of the sizes from axis `begin` up to, not including, `end`.
  int64_t product(size_t begin, size_t end) const;
  std::span<const int64_t> sizes() const { return std::span(sizes_).first(rank_); }
  /// The same with one size replaced.
  Shape with(size_t axis, int64_t size) const;
  std::string text() const;  ///< "(4, 3, 32, 32)"
  bool operator==(const Shape& other) const;

 private:
  std::array<int64_t, kMaxRank> sizes_{};
  size_t rank_ = 0;
};

}  // namespace vkopple
