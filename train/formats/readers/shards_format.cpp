#include <fmt/format.h>

#include <system_error>

#include "runtime/error.h"
#include "train/formats/scene_reader.h"
#include "train/formats/shard_scene.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

bool recognises(const fs::path& path) {
  std::error_code failed;
  const auto is_shard = [](const fs::path& file) { return file.extension() == ".tar"; };
  if (!fs::is_directory(path, failed)) return is_shard(path);
  for (auto entry = fs::directory_iterator(path, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed))
    if (is_shard(entry->path())) return true;
  return false;
}

class ShardSceneReader : public SceneReader {
 public:
  explicit ShardSceneReader(const fs::path& path) : reader_(path) {}

  std::optional<SceneData> next() override {
    const std::optional<Sample> sample = reader_.next();
    if (!sample) return std::nullopt;
    return ShardScene(*sample).whole();
  }

 private:
  ShardReader reader_;
};

class ShardSceneWriter : public SceneWriter {
 public:
  ShardSceneWriter(const fs::path& path, const FormatOptions& options)
      : writer_(path, "scenes",
                static_cast<std::size_t>(options.integer("scenes_per_shard", 1, 100'000, 256))) {}

  void add(const SceneData& scene) override { writer_.add(shard_sample(scene)); }
  void finish() override { writer_.finish(); }

 private:
  ShardWriter writer_;
};

}  // namespace

SceneFormat shards_format() {
  return {
      .name = "shards",
      .about = "tar shards in the WebDataset convention, as generate writes them",
      .settings = {},
      .write_settings = {{"scenes_per_shard", "scenes in one tar file, 256 unless given"}},
      .fields = {},
      .recognises = recognises,
      .open = [](const fs::path& path, const FormatOptions&) -> std::unique_ptr<SceneReader> {
        return std::make_unique<ShardSceneReader>(path);
      },
      .create = [](const fs::path& path, const FormatOptions& options) -> std::unique_ptr<SceneWriter> {
        std::error_code failed;
        if (fs::exists(path, failed) && recognises(path))
          throw Error(fmt::format("{} holds shards already; remove the old data set or choose another folder",
                                  quote(path.string(), 4096)));
        return std::make_unique<ShardSceneWriter>(path, options);
      },
  };
}

}  // namespace vkopple
