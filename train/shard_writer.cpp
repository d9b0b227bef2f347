#include <archive.h>
#include <archive_entry.h>
#include <fmt/core.h>

#include <exception>
#include <system_error>

#include "runtime/error.h"
#include "train/atomic_file.h"
#include "train/quote.h"
#include "train/shards.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

struct Release {
  void operator()(archive* a) const { archive_write_free(a); }
  void operator()(archive_entry* e) const { archive_entry_free(e); }
};

fs::path shard_path(const fs::path& folder, const std::string& prefix, std::size_t number) {
  return folder / fmt::format("{}-{:06}.tar", prefix, number);
}

void refuse_old_shards(const fs::path& folder, const std::string& prefix) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix + "-") || !name.ends_with(".tar")) continue;
    throw Error(fmt::format("{} holds {} already; remove the old data set or choose another folder",
                            quote(folder.string(), 4096), one_line(name)));
  }
}

void check_key(const std::string& key) {
  if (!key.empty() && key.find_first_of("./") == std::string::npos) return;
  throw Error(
      fmt::format("{} can't be the key of a sample: it must be some text without '.' and '/'", quote(key)));
}

}  // namespace

/// A tar file in the making, without anything that differs from run to run.
class ShardWriter::Tar {
 public:
  explicit Tar(const fs::path& path) : file_(path), archive_(archive_write_new()) {
    check(archive_write_set_format_ustar(archive_.get()));
    check(archive_write_set_bytes_per_block(archive_.get(), 1 << 16));
    check(archive_write_set_bytes_in_last_block(archive_.get(), 512));
    check(archive_write_open(archive_.get(), this, nullptr, &Tar::write, nullptr));
  }
  Tar(const Tar&) = delete;
  Tar& operator=(const Tar&) = delete;

  void add(const std::string& name, const std::vector<std::byte>& bytes) {
    const std::unique_ptr<archive_entry, Release> entry(archive_entry_new());
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_mtime(entry.get(), 0, 0);
    check(archive_write_header(archive_.get(), entry.get()));
    if (archive_write_data(archive_.get(), bytes.data(), bytes.size()) !=
        static_cast<la_ssize_t>(bytes.size())) {
      check(ARCHIVE_FATAL);
    }
  }

  void commit() {
    check(archive_write_close(archive_.get()));
    file_.commit();
  }

 private:
  /// Exceptions must not pass through the C library: kept here, thrown by `check`.
  static la_ssize_t write(archive*, void* self, const void* bytes, std::size_t size) {
    Tar& tar = *static_cast<Tar*>(self);
    try {
      tar.file_.write(std::span(static_cast<const std::byte*>(bytes), size));
      return static_cast<la_ssize_t>(size);
    } catch (...) {
      tar.problem_ = std::current_exception();
      return -1;
    }
  }

  void check(int result) {
    if (problem_) std::rethrow_exception(problem_);
    if (result == ARCHIVE_OK) return;
    const char* why = archive_error_string(archive_.get());
    throw Error(fmt::format("cannot write {}: {}", quote(file_.target().string(), 4096),
                            one_line(why != nullptr ? why : "unknown reason")));
  }

  AtomicFile file_;  // outlives the archive, which writes its end to it even when abandoned
  std::exception_ptr problem_;
  std::unique_ptr<archive, Release> archive_;
};

ShardWriter::ShardWriter(fs::path folder, std::string prefix, std::size_t samples_per_shard)
    : folder_(std::move(folder)), prefix_(std::move(prefix)), samples_per_shard_(samples_per_shard) {
  if (samples_per_shard_ == 0) throw Error("a shard must hold at least one sample");
  try {
    fs::create_directories(folder_);
    refuse_old_shards(folder_, prefix_);
  } catch (const fs::filesystem_error& problem) {
    throw Error(
        fmt::format("cannot use the folder {}: {}", quote(folder_.string(), 4096), problem.code().message()));
  }
}

ShardWriter::~ShardWriter() = default;

void ShardWriter::add(const Sample& sample) {
  check_key(sample.key);
  check_usable();
  if (keys_.contains(sample.key)) throw Error(fmt::format("the sample {} is given twice", quote(sample.key)));
  usable_ = false;  // until the sample is whole
  if (!tar_) tar_ = std::make_unique<Tar>(shard_path(folder_, prefix_, shards_));
  for (const auto& [extension, bytes] : sample.parts) tar_->add(sample.key + "." + extension, bytes);
  usable_ = true;
  keys_.insert(sample.key);
  if (keys_.size() == samples_per_shard_) finish();
}

void ShardWriter::finish() {
  check_usable();
  if (!tar_) return;
  usable_ = false;
  tar_->commit();
  usable_ = true;
  tar_.reset();
  keys_.clear();
  ++shards_;
}

void ShardWriter::check_usable() const {
  if (usable_) return;
  throw Error(fmt::format("the data set in {} stays incomplete after an earlier error; write it anew",
                          quote(folder_.string(), 4096)));
}

}  // namespace vkopple
