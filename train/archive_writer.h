#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "train/atomic_file.h"

struct archive;

namespace vkopple {

enum class ArchiveKind { kTar, kStoredZip };

/// A tar file, or a zip file without compression, in the making, without anything that differs from run to run.
/// It appears when it is complete. Throws Error naming the file.
class ArchiveWriter {
 public:
  ArchiveWriter(const std::filesystem::path& path, ArchiveKind kind);
  ArchiveWriter(const ArchiveWriter&) = delete;
  ArchiveWriter& operator=(const ArchiveWriter&) = delete;

  void add(const std::string& name, std::span<const std::byte> bytes);
  /// At most once, as the last call.
  void commit();

 private:
  struct Release {
    void operator()(archive* a) const;
  };

  static std::ptrdiff_t write(archive*, void* self, const void* bytes, std::size_t size);
  void check(int result);

  AtomicFile file_;  // outlives the archive, which writes its end to it even when abandoned
  std::exception_ptr problem_;
  std::unique_ptr<archive, Release> archive_;
};

}  // namespace vkopple
