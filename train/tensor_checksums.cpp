#include "train/tensor_checksums.h"

#include <fmt/format.h>

#include <span>
#include <utility>

#include "runtime/error.h"
#include "train/crc32c.h"
#include "train/json_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

using Metadata = std::map<std::string, std::string>;

constexpr const char* kTensors = "crc32c";
constexpr const char* kMetadata = "metadata_crc32c";
constexpr JsonLimits kLimits{.max_depth = 2, .max_values = 2'000'000};

std::string digits(std::uint32_t crc) { return fmt::format("{:08x}", crc); }

std::uint32_t crc_of(const std::string& text, std::uint32_t before = 0) {
  return crc32c(std::as_bytes(std::span(text)), before);
}

std::string crc_of(const TensorView& tensor) {
  const std::string what = fmt::format("{} {}", dtype_name(tensor.dtype), to_string(tensor.shape));
  return digits(crc32c(tensor.bytes, crc_of(what)));
}

std::string crc_of(const Metadata& metadata) {
  const std::string zero(1, '\0');
  std::uint32_t crc = 0;
  for (const auto& [key, text] : metadata)
    if (key != kMetadata) crc = crc_of(text + zero, crc_of(key + zero, crc));
  return digits(crc);
}

}  // namespace

TensorChecksums::TensorChecksums(const Metadata& metadata, std::filesystem::path path)
    : path_(std::move(path)) {
  const std::string shown = one_line(path_.string(), 4096);
  const auto own = metadata.find(kMetadata);
  if (own != metadata.end() && own->second != crc_of(metadata))
    throw Error(
        fmt::format("{}: its metadata are damaged: they give the checksum {}, not {}; fetch the file "
                    "again, or take another checkpoint",
                    shown, crc_of(metadata), quote(own->second)));
  const auto found = metadata.find(kTensors);
  if (found == metadata.end()) return;
  present_ = true;
  const Json sums = parse_json(found->second, shown + " (crc32c in its metadata)", kLimits);
  for (const auto& [name, sum] : sums.items())
    if (sum.is_string()) tensors_.emplace(name, sum.get<std::string>());
}

void TensorChecksums::check(const std::string& name, const TensorView& tensor) const {
  if (!present_) return;
  const auto found = tensors_.find(name);
  const std::string crc = crc_of(tensor);
  if (found != tensors_.end() && found->second == crc) return;
  throw Error(
      fmt::format("{}: tensor {} is damaged: it gives the checksum {}, not {}; fetch the file again, or "
                  "take another checkpoint",
                  one_line(path_.string(), 4096), quote(name), crc,
                  found == tensors_.end() ? "none" : quote(found->second)));
}

Metadata with_checksums(Metadata metadata, const std::map<std::string, StoredTensor>& tensors) {
  Json sums = Json::object();
  for (const auto& [name, tensor] : tensors) sums[name] = crc_of(TensorView(tensor));
  metadata[kTensors] = sums.dump();
  metadata[kMetadata] = crc_of(metadata);
  return metadata;
}

Metadata without_checksums(Metadata metadata) {
  metadata.erase(kTensors);
  metadata.erase(kMetadata);
  return metadata;
}

}  // namespace vkopple
