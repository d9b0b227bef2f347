#include "train/data/sample_store.h"

#include <algorithm>

namespace vkopple {

ShardStore::ShardStore(const std::filesystem::path& path) : reader_(path) {
  while (auto place = reader_.next_place()) places_.push_back(std::move(*place));
}

bool ShardStore::has(std::size_t index, const std::string& extension) const {
  const auto& parts = places_.at(index).parts;
  return std::any_of(parts.begin(), parts.end(),
                     [&](const SamplePlace::Part& part) { return part.extension == extension; });
}

Sample ShardStore::read(std::size_t index, const std::set<std::string>& extensions) const {
  return reader_.read(places_.at(index), extensions);
}

bool MemoryStore::has(std::size_t index, const std::string& extension) const {
  return samples_.at(index).parts.contains(extension);
}

Sample MemoryStore::read(std::size_t index, const std::set<std::string>& extensions) const {
  const Sample& whole = samples_.at(index);
  Sample sample{whole.key, {}, whole.shard};
  for (const std::string& extension : extensions)
    if (const auto part = whole.parts.find(extension); part != whole.parts.end()) sample.parts.insert(*part);
  return sample;
}

}  // namespace vkopple
