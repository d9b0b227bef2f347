#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace vkopple {

class ArchiveWriter;

/// What belongs together in a data set of tar shards (the WebDataset convention): the members of one tar file
/// whose names are equal up to the first dot. "000012.json", "000012.0.png" and "000012.0.exr" are one sample
/// with the key "000012" and the parts "json", "0.png" and "0.exr".
struct Sample {
  std::string key;
  std::map<std::string, std::vector<std::byte>> parts;  ///< bytes by extension
  std::filesystem::path shard;                          ///< where it was read; unused in writing

  /// "rooms-000000.tar: 000012.json", for messages.
  std::string where(const std::string& extension) const;

  /// Throws an Error that names shard and sample where there is no such part.
  const std::vector<std::byte>& part(const std::string& extension) const;
};

/// Where a sample lies, so that it can be read later and alone.
struct SamplePlace {
  struct Part {
    std::string extension;
    std::uint64_t offset = 0, bytes = 0;  ///< in the shard's file
  };
  std::string key;
  std::size_t shard = 0;  ///< of ShardReader::shards()
  std::vector<Part> parts;
};

/// Writes FOLDER/PREFIX-000000.tar, PREFIX-000001.tar, ... of `samples_per_shard` samples each. The same
/// samples give the same bytes. A shard appears under its name when it is full; the last one with `finish`,
/// without which it is dropped. The folder is created; one that holds shards of this prefix already is refused,
/// lest two sets mix.
class ShardWriter {
 public:
  ShardWriter(std::filesystem::path folder, std::string prefix, std::size_t samples_per_shard);
  ~ShardWriter();
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;

  /// Parts are stored in the order of their extensions. Keys must be new and free of dots and slashes.
  void add(const Sample& sample);
  void finish();

  std::size_t shards() const { return shards_; }  ///< complete ones

 private:
  void check_usable() const;

  std::filesystem::path folder_;
  std::string prefix_;
  std::size_t samples_per_shard_;
  std::size_t shards_ = 0;
  bool usable_ = true;          ///< false once a sample or shard was left half written
  std::set<std::string> keys_;  ///< of the open shard
  std::unique_ptr<ArchiveWriter> tar_;
};

/// What a shard may hold before it is refused.
struct ShardLimits {
  std::set<std::string> suffixes{"png", "exr", "json"};  ///< of names, after the last dot
  std::size_t max_part_bytes = std::size_t{64} << 20;
  std::size_t max_parts = 256;          ///< of one sample
  std::size_t max_samples = 1'000'000;  ///< of one shard
};

/// Reads samples one after another, in the order in which they lie, from one shard or all `*.tar` of a folder
/// by name. A truncated or damaged tar, a member that is no plain file, a name that is absolute, climbs with
/// ".." or has an unknown suffix, a part or key given twice, and whatever exceeds the limits is an Error that
/// names shard and member.
class ShardReader {
 public:
  explicit ShardReader(const std::filesystem::path& path, ShardLimits limits = {});
  ~ShardReader();
  ShardReader(const ShardReader&) = delete;
  ShardReader& operator=(const ShardReader&) = delete;

  const std::vector<std::filesystem::path>& shards() const { return shards_; }

  /// Nothing after the last sample.
  std::optional<Sample> next();

  /// Likewise, without reading what the parts hold: fast even where they are large.
  std::optional<SamplePlace> next_place();

  /// The sample at a place that next_place() gave, with those parts only that `extensions` names (all where it
  /// is empty).
  Sample read(const SamplePlace& place, const std::set<std::string>& extensions = {}) const;

  /// Back to the first sample.
  void rewind();

 private:
  class Tar;

  template <class Result>
  std::optional<Result> next_as();

  std::vector<std::filesystem::path> shards_;
  ShardLimits limits_;
  std::size_t opened_ = 0;
  std::unique_ptr<Tar> tar_;
};

}  // namespace vkopple
