#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vkopple {

/// Element types of the safetensors format, all little-endian.
enum class StoredType { kBool, kU8, kI8, kU16, kI16, kF16, kBF16, kU32, kI32, kF32, kU64, kI64, kF64 };

std::size_t dtype_size(StoredType dtype);                          ///< bytes of one element
std::string_view dtype_name(StoredType dtype);                     ///< "F32", as in a file's header
std::optional<StoredType> dtype_from_name(std::string_view name);  ///< nothing when unknown

/// Sizes, outermost first; empty for a scalar. None is negative.
using StoredShape = std::vector<std::int64_t>;

/// The number of elements, or nothing when it overflows 63 bits or a size is negative.
std::optional<std::int64_t> element_count(const StoredShape& shape);
std::string to_string(const StoredShape& shape);  ///< "[2, 3]"

/// A tensor on the host as files hold it: row-major bytes.
struct StoredTensor {
  StoredType dtype = StoredType::kF32;
  StoredShape shape;
  std::vector<std::byte> bytes;

  static StoredTensor of(StoredShape shape, std::span<const float> values);
  static StoredTensor of(StoredShape shape, std::span<const double> values);
  static StoredTensor of(StoredShape shape, std::span<const std::int32_t> values);
  static StoredTensor of(StoredShape shape, std::span<const std::int64_t> values);
};

/// The same over memory that someone else owns.
struct TensorView {
  StoredType dtype = StoredType::kF32;
  StoredShape shape;
  std::span<const std::byte> bytes;

  TensorView(StoredType type, StoredShape sizes, std::span<const std::byte> memory)
      : dtype(type), shape(std::move(sizes)), bytes(memory) {}
  TensorView(StoredShape sizes, std::span<const float> values)
      : TensorView(StoredType::kF32, std::move(sizes), std::as_bytes(values)) {}
  // NOLINTNEXTLINE(google-explicit-constructor): a tensor is a view of itself
  TensorView(const StoredTensor& tensor) : TensorView(tensor.dtype, tensor.shape, tensor.bytes) {}
};

/// Each element as a float (double), from any element type but Bool; 64-bit values round.
std::vector<float> to_floats(const TensorView& tensor);
std::vector<double> to_doubles(const TensorView& tensor);

/// Each element of an integer or Bool tensor; `name` and `source` stand in the error that another type gives.
std::vector<std::int64_t> to_ints(const TensorView& tensor, std::string_view name, std::string_view source);

/// Throws an Error naming the file, the tensor and the first place when a value is NaN or infinite.
void require_finite(std::string_view name, std::span<const float> values, const std::filesystem::path& path);

}  // namespace vkopple
