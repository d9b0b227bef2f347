#include <fmt/core.h>

#include <system_error>

#include "runtime/error.h"
#include "train/archive_writer.h"
#include "train/quote.h"
#include "train/shards.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

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
  if (!tar_) tar_ = std::make_unique<ArchiveWriter>(shard_path(folder_, prefix_, shards_), ArchiveKind::kTar);
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
