#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "train/data/sample_store.h"
#include "train/data/triplets.h"
#include "train/rooms/renderer.h"

namespace vkopple {

/// What a data set of shards is read for.
enum class Reading {
  kTraining,    ///< every evenly strided triplet of every scene, in an order that each epoch shuffles anew
  kEvaluation,  ///< the middle frame of each scene with its neighbours, in the order of the files
};

/// Triplets of a data set of samples (docs/data.md), resampled to the model's size. Nothing in the files is
/// trusted: Error names shard and member. Several threads may read at once.
class ShardSource : public TripletSource {
 public:
  /// `parts`: batches of an epoch are a multiple of it, the parts of larger ones that follow each other. Throws
  /// Error, which names `path`, where there is no triplet.
  ShardSource(std::unique_ptr<SampleStore> store, const std::filesystem::path& path, const Lens& lens,
              int batch, uint64_t seed, Reading reading, uint64_t parts = 1);
  /// `path`: a shard or a folder of them.
  ShardSource(const std::filesystem::path& path, const Lens& lens, int batch, uint64_t seed, Reading reading,
              uint64_t parts = 1)
      : ShardSource(std::make_unique<ShardStore>(path), path, lens, batch, seed, reading, parts) {}

  /// Of training, step counts on from epoch to epoch, each without what is left of its last incomplete batch; a
  /// data set smaller than a batch repeats itself. In evaluation the set starts again behind its last triplet;
  /// where a scene has less than three frames, neighbours that are missing are the middle frame itself, and
  /// cameras may be unknown.
  TripletBatch read(uint64_t step) override { return read(step, true); }
  TripletBatch read_shown(uint64_t step) override { return read(step, false); }

  std::optional<uint64_t> size() const override { return triplets_.size(); }

 private:
  struct Triplet {
    uint32_t scene;
    std::array<uint16_t, 3> frames;
  };
  using Order = std::vector<uint32_t>;

  void find_triplets();
  void add_scene(std::size_t scene);
  TripletBatch read(uint64_t step, bool truth);
  /// The triplets of step's batch.
  std::vector<Triplet> choose(uint64_t step);
  std::shared_ptr<const Order> order(uint64_t epoch);

  std::unique_ptr<SampleStore> store_;
  Lens lens_;
  int batch_;
  uint64_t seed_;
  Reading reading_;
  uint64_t parts_;
  std::vector<Triplet> triplets_;
  std::mutex orders_mutex_;
  std::map<uint64_t, std::shared_ptr<const Order>> orders_;  ///< by epoch: the last few that were asked for
};

}  // namespace vkopple
