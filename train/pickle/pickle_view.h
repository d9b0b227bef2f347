#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "train/pickle/pickle_value.h"

namespace vkopple {

/// A value of a pickle with its place there ("map.pickle: 'frame1'[2]"), as JsonView is of JSON: what has
/// another form than asked for is an Error that names the place. The Pickle must outlive it.
class PickleView {
 public:
  PickleView(PickleValue value, std::string where) : value_(value), where_(std::move(where)) {}

  const PickleValue& value() const { return value_; }
  const std::string& where() const { return where_; }

  /// Of a dict.
  bool contains(std::string_view key) const;
  PickleView operator[](std::string_view key) const;

  /// Of a list or a tuple.
  std::size_t size() const;
  PickleView operator[](std::size_t index) const;

  /// A whole number, or one of numpy.
  std::int64_t integer(std::int64_t lowest, std::int64_t highest) const;
  const std::string& string() const;
  /// Finite numbers of exactly this shape, row-major: nested lists, tuples and arrays of numpy.
  std::vector<double> numbers(std::span<const std::size_t> shape) const;
  std::vector<double> numbers(std::initializer_list<std::size_t> shape) const {
    return numbers(std::span(shape.begin(), shape.size()));
  }

  /// Throws an Error that says the value is wrong: "<where> must be <wanted>, not <kind>".
  [[noreturn]] void fail(std::string_view wanted) const;

 private:
  PickleValue value_;
  std::string where_;
};

}  // namespace vkopple
