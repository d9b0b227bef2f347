#include "train/pickle/numpy_array.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

namespace vkopple {
namespace {

// numpy 2 moved its modules from core to _core.
constexpr std::array<std::string_view, 2> kReconstruct{"numpy.core.multiarray._reconstruct",
                                                       "numpy._core.multiarray._reconstruct"};
constexpr std::array<std::string_view, 2> kScalar{"numpy.core.multiarray.scalar",
                                                  "numpy._core.multiarray.scalar"};
constexpr std::array<std::string_view, 2> kFromBuffer{"numpy.core.numeric._frombuffer",
                                                      "numpy._core.numeric._frombuffer"};

constexpr std::array<std::pair<std::string_view, StoredType>, 12> kTypes{{{"b1", StoredType::kBool},
                                                                          {"u1", StoredType::kU8},
                                                                          {"i1", StoredType::kI8},
                                                                          {"u2", StoredType::kU16},
                                                                          {"i2", StoredType::kI16},
                                                                          {"f2", StoredType::kF16},
                                                                          {"u4", StoredType::kU32},
                                                                          {"i4", StoredType::kI32},
                                                                          {"f4", StoredType::kF32},
                                                                          {"u8", StoredType::kU64},
                                                                          {"i8", StoredType::kI64},
                                                                          {"f8", StoredType::kF64}}};

using Values = std::span<const PickleValue>;

bool calls(const PickleValue& value, const std::array<std::string_view, 2>& globals) {
  return std::any_of(globals.begin(), globals.end(),
                     [&](std::string_view name) { return value.is_call(name); });
}

/// dtype("f8", False, True) with the state (3, "<", None, ...).
std::optional<StoredType> type_of(const PickleValue& value) {
  if (!value.is_call("numpy.dtype") || value.arguments().empty()) return std::nullopt;
  const PickleValue name = value.arguments()[0];
  const PickleValue state = value.state();
  if (!name.is(PickleKind::kString) || !state.is(PickleKind::kTuple) || state.items().size() < 2)
    return std::nullopt;
  const PickleValue order = state.items()[1];
  if (!order.is(PickleKind::kString) || (order.text() != "<" && order.text() != "|")) return std::nullopt;
  const auto* found =
      std::find_if(kTypes.begin(), kTypes.end(), [&](auto& t) { return t.first == name.text(); });
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

std::optional<StoredShape> shape_of(const PickleValue& value) {
  if (!value.is(PickleKind::kTuple)) return std::nullopt;
  StoredShape shape;
  for (const PickleValue& size : value.items()) {
    if (!size.is(PickleKind::kInt)) return std::nullopt;
    shape.push_back(size.integer());
  }
  return shape;
}

/// Column-major elements brought in row-major order. Fortran's order is that of the reversed shape.
std::vector<std::byte> from_columns(const StoredShape& shape, std::span<const std::byte> bytes,
                                    std::size_t size) {
  std::vector<std::byte> rows(bytes.size());
  std::vector<std::int64_t> index(shape.size(), 0);
  for (std::size_t to = 0; to < bytes.size(); to += size) {
    std::int64_t from = 0;
    for (std::size_t d = shape.size(); d-- > 0;) from = from * shape[d] + index[d];
    std::copy_n(bytes.begin() + from * static_cast<std::int64_t>(size), size,
                rows.begin() + static_cast<std::ptrdiff_t>(to));
    for (std::size_t d = shape.size(); d-- > 0;) {
      if (++index[d] < shape[d]) break;
      index[d] = 0;
    }
  }
  return rows;
}

/// Python 2 pickles bytes as strings.
std::optional<StoredTensor> array(const PickleValue& type, const std::optional<StoredShape>& shape,
                                  const PickleValue& data, bool columns) {
  const auto dtype = type_of(type);
  if (!dtype || !shape || !(data.is(PickleKind::kBytes) || data.is(PickleKind::kString))) return std::nullopt;
  const auto count = element_count(*shape);
  const auto bytes = std::as_bytes(std::span(data.text()));
  const std::size_t size = dtype_size(*dtype);
  if (!count || bytes.size() % size != 0 || static_cast<std::uint64_t>(*count) != bytes.size() / size)
    return std::nullopt;
  if (columns) return StoredTensor{*dtype, *shape, from_columns(*shape, bytes, size)};
  return StoredTensor{*dtype, *shape, {bytes.begin(), bytes.end()}};
}

/// State (1, shape, dtype, whether in Fortran's order, bytes).
std::optional<StoredTensor> reconstructed(const PickleValue& state) {
  if (!state.is(PickleKind::kTuple) || state.items().size() != 5) return std::nullopt;
  const Values items = state.items();
  if (!items[3].is(PickleKind::kBool)) return std::nullopt;
  return array(items[2], shape_of(items[1]), items[4], items[3].boolean());
}

/// _frombuffer(bytes, dtype, shape, order).
std::optional<StoredTensor> from_buffer(Values arguments) {
  if (arguments.size() != 4 || !arguments[3].is(PickleKind::kString)) return std::nullopt;
  return array(arguments[1], shape_of(arguments[2]), arguments[0], arguments[3].text() == "F");
}

}  // namespace

const std::set<std::string>& numpy_globals() {
  static const std::set<std::string> names = [] {
    std::set<std::string> all{"numpy.ndarray", "numpy.dtype"};
    for (const auto& group : {kReconstruct, kScalar, kFromBuffer}) all.insert(group.begin(), group.end());
    return all;
  }();
  return names;
}

std::optional<StoredTensor> numpy_array(const PickleValue& value) {
  if (calls(value, kReconstruct)) return reconstructed(value.state());
  if (calls(value, kFromBuffer)) return from_buffer(value.arguments());
  if (calls(value, kScalar) && value.arguments().size() == 2)
    return array(value.arguments()[0], StoredShape{}, value.arguments()[1], false);
  return std::nullopt;
}

}  // namespace vkopple
