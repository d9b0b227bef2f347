#include "runtime/pipeline_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "runtime/warn.h"

namespace vkopple {
namespace {

constexpr uint64_t kLargestCache = uint64_t{256} << 20;

struct Header {
  std::array<char, 8> magic{'v', 'k', 'o', 'p', 'p', 'l', 'e', '\n'};
  uint32_t version = 1;
  uint32_t driver_version = 0;
  std::array<uint8_t, 16> device_uuid{};
  std::array<uint8_t, 16> driver_uuid{};
  uint64_t bytes = 0;
  uint64_t checksum = 0;
  bool operator==(const Header&) const = default;
};
static_assert(sizeof(Header) == 64);

/// FNV-1a, 64 bits: against damage, not against malice.
uint64_t checksum(std::span<const std::byte> data) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (std::byte b : data) hash = (hash ^ static_cast<uint64_t>(b)) * 0x100000001b3U;
  return hash;
}

Header header_for(const Caps& caps, std::span<const std::byte> data) {
  Header header;
  header.driver_version = caps.driver_version;
  header.device_uuid = caps.uuid;
  header.driver_uuid = caps.driver_uuid;
  header.bytes = data.size();
  header.checksum = checksum(data);
  return header;
}

}  // namespace

std::string pipeline_cache_name(const Caps& caps) {
  return fmt::format("pipelines-{}-{:x}.bin", uuid_text(caps.uuid), caps.driver_version);
}

std::vector<std::byte> load_pipeline_cache(const std::filesystem::path& file, const Caps& caps) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return {};
  const auto ignored = [&](std::string_view why) {
    warn(fmt::format("{}: {}; ignoring this pipeline cache", file.string(), why));
    return std::vector<std::byte>{};
  };
  Header found;
  if (!in.read(reinterpret_cast<char*>(&found), sizeof found)) return ignored("too short");
  if (found.magic != Header{}.magic || found.version != Header{}.version)
    return ignored("not a pipeline cache");
  std::error_code failure;  // which makes the size one that does not fit
  if (found.bytes > kLargestCache || std::filesystem::file_size(file, failure) != sizeof found + found.bytes)
    return ignored("damaged");
  std::vector<std::byte> data(found.bytes);
  if (!in.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size())) ||
      in.peek() != std::ifstream::traits_type::eof())
    return ignored("damaged");
  Header expected = header_for(caps, data);
  if (found.checksum != expected.checksum) return ignored("damaged");
  if (found != expected) return ignored("made by another device or driver");
  return data;
}

void save_pipeline_cache(const std::filesystem::path& file, const Caps& caps, std::span<const std::byte> data) {
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  // Two threads of a process may end their devices at once.
  const auto temporary = std::filesystem::path(file.string() + fmt::format(".tmp-{}", ::gettid()));
  const Header header = header_for(caps, data);
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    if (!out.flush()) error = std::make_error_code(std::errc::io_error);
  }
  if (!error) std::filesystem::rename(temporary, file, error);
  if (error) {
    warn(fmt::format("{}: can't write the pipeline cache ({})", file.string(), error.message()));
    std::filesystem::remove(temporary, error);
  }
}

}  // namespace vkopple
