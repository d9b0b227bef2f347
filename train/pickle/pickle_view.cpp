#include "train/pickle/pickle_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "runtime/error.h"
#include "train/pickle/numpy_array.h"
#include "train/quote.h"

namespace vkopple {
namespace {

bool is_sequence(const PickleValue& value) {
  return value.is(PickleKind::kList) || value.is(PickleKind::kTuple);
}

std::optional<double> as_number(const PickleValue& value) {
  if (value.is(PickleKind::kInt)) return static_cast<double>(value.integer());
  if (value.is(PickleKind::kFloat)) return value.real();
  const auto scalar = numpy_array(value);
  if (!scalar || !scalar->shape.empty() || scalar->dtype == StoredType::kBool) return std::nullopt;
  return to_doubles(*scalar).front();
}

/// Appends the numbers of a value of that shape; false where it has another.
bool append_numbers(const PickleValue& value, std::span<const std::size_t> shape, std::vector<double>& into) {
  if (shape.empty()) {
    const auto number = as_number(value);
    if (number) into.push_back(*number);
    return number.has_value();
  }
  if (is_sequence(value)) {
    const auto items = value.items();
    return items.size() == shape[0] && std::all_of(items.begin(), items.end(), [&](const PickleValue& item) {
             return append_numbers(item, shape.subspan(1), into);
           });
  }
  const auto array = numpy_array(value);
  if (!array || array->dtype == StoredType::kBool ||
      !std::equal(shape.begin(), shape.end(), array->shape.begin(), array->shape.end(),
                  [](std::size_t a, std::int64_t b) { return static_cast<std::int64_t>(a) == b; }))
    return false;
  const std::vector<double> numbers = to_doubles(*array);
  into.insert(into.end(), numbers.begin(), numbers.end());
  return true;
}

}  // namespace

void PickleView::fail(std::string_view wanted) const {
  throw Error(fmt::format("{} must be {}, not {}", where_, wanted, name_of(value_.kind())));
}

bool PickleView::contains(std::string_view key) const {
  if (!value_.is(PickleKind::kDict)) fail("a dict");
  return value_.find(key) != nullptr;
}

PickleView PickleView::operator[](std::string_view key) const {
  if (!contains(key)) throw Error(fmt::format("{} has no {}", where_, quote(key)));
  return {*value_.find(key), fmt::format("{}: {}", where_, quote(key))};
}

std::size_t PickleView::size() const {
  if (!is_sequence(value_)) fail("a list");
  return value_.items().size();
}

PickleView PickleView::operator[](std::size_t index) const {
  if (index >= size()) throw Error(fmt::format("{} has {} items, no [{}]", where_, size(), index));
  return {value_.items()[index], fmt::format("{}[{}]", where_, index)};
}

std::int64_t PickleView::integer(std::int64_t lowest, std::int64_t highest) const {
  const std::string wanted = fmt::format("a whole number from {} to {}", lowest, highest);
  std::int64_t number = 0;
  if (value_.is(PickleKind::kInt)) {
    number = value_.integer();
  } else {
    const auto scalar = numpy_array(value_);
    const bool whole = scalar && scalar->shape.empty() && dtype_name(scalar->dtype).front() != 'F' &&
                       scalar->dtype != StoredType::kU64;
    if (!whole) fail(wanted);
    number = to_ints(*scalar, "number", where_).front();
  }
  if (number < lowest || number > highest)
    throw Error(fmt::format("{} must be {}, not {}", where_, wanted, number));
  return number;
}

const std::string& PickleView::string() const {
  if (!value_.is(PickleKind::kString)) fail("a string");
  return value_.text();
}

std::vector<double> PickleView::numbers(std::span<const std::size_t> shape) const {
  std::vector<double> numbers;
  if (!append_numbers(value_, shape, numbers)) {
    throw Error(fmt::format("{} must be {} numbers, a list or an array of numpy with little-endian numbers",
                            where_, fmt::join(shape, " x ")));
  }
  for (const double number : numbers)
    if (!std::isfinite(number)) throw Error(fmt::format("{} must be finite, not {}", where_, number));
  return numbers;
}

}  // namespace vkopple
