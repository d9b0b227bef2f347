#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "train/image.h"

namespace vkopple {

// Pictures in files and in memory, by OpenImageIO. Reading trusts nothing: sizes are checked before memory is
// taken (at most 16384 on a side and 2^26 pixels), and whatever is wrong is an Error naming the file
// (`source`). Writing gives the same bytes for the same picture, every time.

/// Any picture of a kind that picture_reader() knows: grey becomes RGB, alpha and further channels are dropped,
/// integers are scaled to [0, 1], floats clamped to it.
RgbImage read_rgb(const std::filesystem::path& path);

/// The same of a PNG in memory.
RgbImage decode_png(std::span<const std::byte> bytes, const std::string& source);

/// The same of a PNG or a JPEG in memory.
RgbImage decode_rgb(std::span<const std::byte> bytes, const std::string& source);

/// The numbers of a PNG of one channel, stored with as many bits as `T` (8 or 16).
template <class T>
Plane<T> decode_grey(std::span<const std::byte> bytes, const std::string& source);

/// 8 bits a channel, values clamped to [0, 1] and rounded.
std::vector<std::byte> encode_png(const RgbImage& image);
/// 8-bit grey, for indices.
std::vector<std::byte> encode_png(const Plane<std::uint8_t>& plane);

/// One float channel, Z.
std::vector<std::byte> encode_depth_exr(const Plane<float>& depth);

/// Float channel Z and uint32 channel objectId, of which one is left out where its plane has no pixels.
std::vector<std::byte> encode_exr(const DepthAndIds& layers);
/// Channels that the file lacks are planes without pixels; one must be there.
DepthAndIds decode_exr(std::span<const std::byte> bytes, const std::string& source);

/// Whole files, through AtomicFile.
void write_png(const std::filesystem::path& path, const RgbImage& image);
void write_png(const std::filesystem::path& path, const Plane<std::uint8_t>& plane);
void write_depth_exr(const std::filesystem::path& path, const Plane<float>& depth);

}  // namespace vkopple
