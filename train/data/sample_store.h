#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "train/shards.h"

namespace vkopple {

/// Samples that can be read one by one, in any order, by several threads at once.
class SampleStore {
 public:
  virtual ~SampleStore() = default;
  virtual std::size_t size() const = 0;
  /// Whether a sample has a part.
  virtual bool has(std::size_t index, const std::string& extension) const = 0;
  /// The sample with those of its parts that `extensions` names. Throws Error.
  virtual Sample read(std::size_t index, const std::set<std::string>& extensions) const = 0;
};

/// Those of a shard or of a folder of shards, which stay on disk.
class ShardStore : public SampleStore {
 public:
  /// Looks through the headers of all.
  explicit ShardStore(const std::filesystem::path& path);

  std::size_t size() const override { return places_.size(); }
  bool has(std::size_t index, const std::string& extension) const override;
  Sample read(std::size_t index, const std::set<std::string>& extensions) const override;

 private:
  ShardReader reader_;
  std::vector<SamplePlace> places_;
};

/// Samples in memory.
class MemoryStore : public SampleStore {
 public:
  explicit MemoryStore(std::vector<Sample> samples) : samples_(std::move(samples)) {}

  std::size_t size() const override { return samples_.size(); }
  bool has(std::size_t index, const std::string& extension) const override;
  Sample read(std::size_t index, const std::set<std::string>& extensions) const override;

 private:
  std::vector<Sample> samples_;
};

}  // namespace vkopple
