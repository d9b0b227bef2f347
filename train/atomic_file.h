#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "train/file_descriptor.h"
#include "train/file_system.h"

namespace vkopple {

/// A file that appears under its name only once it is complete and on disk.
///
/// Bytes go to `<name>.tmp-<process>-<n>` in the same folder. `commit` syncs them, renames the temporary over
/// the target and syncs the folder; without it the destructor removes the temporary and the target stays as it
/// was. A target that is a symbolic link is followed. Every failure (missing folder, full disk, ...) is an
/// `Error` with the target's path and the system's reason.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& target, FileSystem& files = system_files());
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Unbuffered: hand over large pieces.
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// At most once, as the last call.
  void commit();

  const std::filesystem::path& target() const { return target_; }

 private:
  void sync_folder() const;

  FileSystem* files_;
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  FileDescriptor file_;
};

/// Writes a whole file through `AtomicFile`.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

/// The whole of a regular file; an `Error` names the path when it can't be read or holds more than `max_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& path, std::size_t max_bytes);
std::string read_text_file(const std::filesystem::path& path, std::size_t max_bytes);

/// Opens a regular file for reading; anything else (folder, pipe, device) is refused.
FileDescriptor open_for_reading(const std::filesystem::path& path);

}  // namespace vkopple
