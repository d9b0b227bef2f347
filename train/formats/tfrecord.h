#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace vkopple {

/// One record of a TFRecord file: bytes whose meaning the format does not know.
struct TfRecord {
  std::vector<std::byte> bytes;
  std::filesystem::path file;
  std::uint64_t index = 0;  ///< in the file, from 0

  /// "movi_e-train.tfrecord-00003-of-01024: record 12", for messages.
  std::string where() const;
};

/// Longer records are refused; MOVi-E's films of 24 frames of 256 x 256 pixels take about 15 MB.
inline constexpr std::size_t kMostRecordBytes = std::size_t{64} << 20;

/// The TFRecord files that `path` names: itself, or all of a folder whose names hold ".tfrecord" (as
/// 0000.tfrecords and movi_e-train.tfrecord-00003-of-01024 do), sorted. Throws Error where there is none.
std::vector<std::filesystem::path> find_tfrecords(const std::filesystem::path& path);

/// Reads the records of TFRecord files, plain or compressed by GZIP, one after another. Both checksums of every
/// record are compared, and a length is believed only once its own is right. A file that is cut off, damaged or
/// of another kind, and a record of more than `most_bytes`, is an Error that names file and record.
class TfRecordReader {
 public:
  explicit TfRecordReader(std::vector<std::filesystem::path> files, std::size_t most_bytes = kMostRecordBytes);
  ~TfRecordReader();
  TfRecordReader(const TfRecordReader&) = delete;
  TfRecordReader& operator=(const TfRecordReader&) = delete;

  /// Nothing behind the last record of the last file.
  std::optional<TfRecord> next();

 private:
  class File;

  std::vector<std::filesystem::path> files_;
  std::size_t most_bytes_;
  std::size_t opened_ = 0;
  std::unique_ptr<File> file_;
};

/// Appends a record, plain. The stream tells whether it could be written.
void write_tfrecord(std::ostream& to, std::span<const std::byte> record);

}  // namespace vkopple
