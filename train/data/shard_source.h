#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "train/data/triplets.h"
#include "train/rooms/renderer.h"
#include "train/shards.h"

namespace vkopple {

/// What a data set of shards is read for.
enum class Reading {
  kTraining,    ///< every evenly strided triplet of every scene, in an order that each epoch shuffles anew
  kEvaluation,  ///< one triplet of each scene, about its middle frame, in the order of the files
};

/// Triplets of a data set of shards (docs/data.md), resampled to the model's size. Nothing in the files is
/// trusted: Error names shard and member.
class ShardSource : public TripletSource {
 public:
  /// `path`: a shard or a folder of them. `parts`: batches of an epoch are a multiple of it, the parts of
  /// larger ones that follow each other. Looks through the headers of all. Throws Error where there is no
  /// triplet.
  ShardSource(const std::filesystem::path& path, const Lens& lens, int batch, uint64_t seed, Reading reading,
              uint64_t parts = 1);

  /// Of training, step counts on from epoch to epoch, each without what is left of its last incomplete batch; a
  /// data set smaller than a batch repeats itself. In evaluation the set starts again behind its last triplet.
  TripletBatch read(uint64_t step) override;

  std::optional<uint64_t> size() const override { return triplets_.size(); }

 private:
  struct Triplet {
    uint32_t scene;
    std::array<uint16_t, 3> frames;
  };

  void find_triplets();
  void add_scene(const SamplePlace& place);
  /// The triplet that is element `element` of step's batch.
  const Triplet& choose(uint64_t step, uint64_t element);
  void shuffle(uint64_t epoch);

  ShardReader reader_;
  Lens lens_;
  int batch_;
  uint64_t seed_;
  Reading reading_;
  uint64_t parts_;
  std::vector<SamplePlace> scenes_;
  std::vector<Triplet> triplets_;
  std::vector<uint32_t> order_;  ///< of the epoch read last
  uint64_t order_epoch_ = UINT64_MAX;
};

}  // namespace vkopple
