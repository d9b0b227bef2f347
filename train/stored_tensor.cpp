#include "train/stored_tensor.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

static_assert(std::endian::native == std::endian::little,
              "stored tensors are little-endian and copied as they are");

struct DTypeFacts {
  StoredType dtype;
  std::string_view name;
  std::size_t size;
};
constexpr std::array<DTypeFacts, 13> kDTypes{{{StoredType::kBool, "BOOL", 1},
                                              {StoredType::kU8, "U8", 1},
                                              {StoredType::kI8, "I8", 1},
                                              {StoredType::kU16, "U16", 2},
                                              {StoredType::kI16, "I16", 2},
                                              {StoredType::kF16, "F16", 2},
                                              {StoredType::kBF16, "BF16", 2},
                                              {StoredType::kU32, "U32", 4},
                                              {StoredType::kI32, "I32", 4},
                                              {StoredType::kF32, "F32", 4},
                                              {StoredType::kU64, "U64", 8},
                                              {StoredType::kI64, "I64", 8},
                                              {StoredType::kF64, "F64", 8}}};

const DTypeFacts& facts(StoredType dtype) { return kDTypes.at(static_cast<std::size_t>(dtype)); }

/// IEEE 754 binary16: 1 sign, 5 exponent (bias 15) and 10 mantissa bits.
float half_to_float(std::uint16_t half) {
  const float sign = (half & 0x8000u) != 0 ? -1.0f : 1.0f;
  const int exponent = (half >> 10) & 31;
  const auto mantissa = static_cast<float>(half & 1023u);
  if (exponent == 31) return mantissa == 0 ? sign * std::numeric_limits<float>::infinity() : std::nanf("");
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  return sign * std::ldexp(mantissa + 1024.0f, exponent - 25);
}

float bfloat_to_float(std::uint16_t bits) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16);
}

template <class Stored, class Out, class Convert>
std::vector<Out> convert_all(std::span<const std::byte> bytes, Convert&& convert) {
  std::vector<Out> values(bytes.size() / sizeof(Stored));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Stored stored;
    std::memcpy(&stored, bytes.data() + i * sizeof(Stored), sizeof(Stored));  // may be unaligned
    values[i] = convert(stored);
  }
  return values;
}

template <class Stored, class Out>
std::vector<Out> cast_all(std::span<const std::byte> bytes) {
  return convert_all<Stored, Out>(bytes, [](Stored value) { return static_cast<Out>(value); });
}

template <class Out>
std::vector<Out> to_reals(const TensorView& t) {
  switch (t.dtype) {
    case StoredType::kF32:
      return cast_all<float, Out>(t.bytes);
    case StoredType::kF64:
      return cast_all<double, Out>(t.bytes);
    case StoredType::kF16:
      return convert_all<std::uint16_t, Out>(t.bytes, half_to_float);
    case StoredType::kBF16:
      return convert_all<std::uint16_t, Out>(t.bytes, bfloat_to_float);
    case StoredType::kBool:
    case StoredType::kU8:
      return cast_all<std::uint8_t, Out>(t.bytes);
    case StoredType::kI8:
      return cast_all<std::int8_t, Out>(t.bytes);
    case StoredType::kU16:
      return cast_all<std::uint16_t, Out>(t.bytes);
    case StoredType::kI16:
      return cast_all<std::int16_t, Out>(t.bytes);
    case StoredType::kU32:
      return cast_all<std::uint32_t, Out>(t.bytes);
    case StoredType::kI32:
      return cast_all<std::int32_t, Out>(t.bytes);
    case StoredType::kU64:
      return cast_all<std::uint64_t, Out>(t.bytes);
    case StoredType::kI64:
      return cast_all<std::int64_t, Out>(t.bytes);
  }
  throw Error("unknown element type");
}

template <class T>
StoredTensor store(StoredType dtype, StoredShape shape, std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {dtype, std::move(shape), {bytes.begin(), bytes.end()}};
}

}  // namespace

std::size_t dtype_size(StoredType dtype) { return facts(dtype).size; }
std::string_view dtype_name(StoredType dtype) { return facts(dtype).name; }

std::optional<StoredType> dtype_from_name(std::string_view name) {
  for (const DTypeFacts& known : kDTypes) {
    if (known.name == name) return known.dtype;
  }
  return std::nullopt;
}

std::optional<std::int64_t> element_count(const StoredShape& shape) {
  std::int64_t count = 1;
  for (const std::int64_t size : shape) {
    if (size < 0 || __builtin_mul_overflow(count, size, &count)) return std::nullopt;
  }
  return count;
}

std::string to_string(const StoredShape& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

StoredTensor StoredTensor::of(StoredShape shape, std::span<const float> values) {
  return store(StoredType::kF32, std::move(shape), values);
}
StoredTensor StoredTensor::of(StoredShape shape, std::span<const double> values) {
  return store(StoredType::kF64, std::move(shape), values);
}
StoredTensor StoredTensor::of(StoredShape shape, std::span<const std::int32_t> values) {
  return store(StoredType::kI32, std::move(shape), values);
}
StoredTensor StoredTensor::of(StoredShape shape, std::span<const std::int64_t> values) {
  return store(StoredType::kI64, std::move(shape), values);
}

std::vector<float> to_floats(const TensorView& tensor) { return to_reals<float>(tensor); }
std::vector<double> to_doubles(const TensorView& tensor) { return to_reals<double>(tensor); }

std::vector<std::int64_t> to_ints(const TensorView& t, std::string_view name, std::string_view source) {
  switch (t.dtype) {
    case StoredType::kBool:
    case StoredType::kU8:
      return cast_all<std::uint8_t, std::int64_t>(t.bytes);
    case StoredType::kI8:
      return cast_all<std::int8_t, std::int64_t>(t.bytes);
    case StoredType::kU16:
      return cast_all<std::uint16_t, std::int64_t>(t.bytes);
    case StoredType::kI16:
      return cast_all<std::int16_t, std::int64_t>(t.bytes);
    case StoredType::kU32:
      return cast_all<std::uint32_t, std::int64_t>(t.bytes);
    case StoredType::kI32:
      return cast_all<std::int32_t, std::int64_t>(t.bytes);
    case StoredType::kI64:
      return cast_all<std::int64_t, std::int64_t>(t.bytes);
    default:
      throw Error(fmt::format("{}: tensor {} holds {}, but whole numbers up to 64 bits signed are needed",
                              source, quote(name), dtype_name(t.dtype)));
  }
}

void require_finite(std::string_view name, std::span<const float> values, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw Error(fmt::format("{}: tensor {} is {} at element {}; the file is damaged or its training diverged",
                              one_line(path.string(), 4096), quote(name), values[i], i));
    }
  }
}

}  // namespace vkopple
