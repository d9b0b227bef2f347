#include "train/archive_writer.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/core.h>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr int kBlock = 1 << 16;

struct ReleaseEntry {
  void operator()(archive_entry* e) const { archive_entry_free(e); }
};

}  // namespace

void ArchiveWriter::Release::operator()(archive* a) const { archive_write_free(a); }

ArchiveWriter::ArchiveWriter(const std::filesystem::path& path, ArchiveKind kind)
    : file_(path), archive_(archive_write_new()) {
  const bool tar = kind == ArchiveKind::kTar;
  check(tar ? archive_write_set_format_ustar(archive_.get()) : archive_write_set_format_zip(archive_.get()));
  if (!tar) check(archive_write_zip_set_compression_store(archive_.get()));
  check(archive_write_set_bytes_per_block(archive_.get(), kBlock));
  check(archive_write_set_bytes_in_last_block(archive_.get(), tar ? 512 : 1));
  check(archive_write_open(archive_.get(), this, nullptr, &ArchiveWriter::write, nullptr));
}

void ArchiveWriter::add(const std::string& name, std::span<const std::byte> bytes) {
  const std::unique_ptr<archive_entry, ReleaseEntry> entry(archive_entry_new());
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
  archive_entry_set_mtime(entry.get(), 0, 0);
  check(archive_write_header(archive_.get(), entry.get()));
  if (archive_write_data(archive_.get(), bytes.data(), bytes.size()) != static_cast<la_ssize_t>(bytes.size())) {
    check(ARCHIVE_FATAL);
  }
}

void ArchiveWriter::commit() {
  check(archive_write_close(archive_.get()));
  file_.commit();
}

/// Exceptions must not pass through the C library: kept here, thrown by `check`.
std::ptrdiff_t ArchiveWriter::write(archive*, void* self, const void* bytes, std::size_t size) {
  auto& writer = *static_cast<ArchiveWriter*>(self);
  try {
    writer.file_.write(std::span(static_cast<const std::byte*>(bytes), size));
    return static_cast<std::ptrdiff_t>(size);
  } catch (...) {
    writer.problem_ = std::current_exception();
    return -1;
  }
}

void ArchiveWriter::check(int result) {
  if (problem_) std::rethrow_exception(problem_);
  if (result == ARCHIVE_OK) return;
  const char* why = archive_error_string(archive_.get());
  throw Error(fmt::format("cannot write {}: {}", quote(file_.target().string(), 4096),
                          one_line(why != nullptr ? why : "unknown reason")));
}

}  // namespace vkopple
