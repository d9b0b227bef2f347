#include "train/rooms/room_source.h"

#include "runtime/device.h"
#include "runtime/transfer.h"
#include "train/random.h"

namespace vkopple {
namespace {

// Scenes take the streams from 0 on, the choice of their frames those from here on.
constexpr uint64_t kChoiceStreams = uint64_t{1} << 63;

}  // namespace

RoomSource::RoomSource(const Device& device, const Lens& lens, const RoomsConfig& rooms, int batch,
                       uint64_t seed)
    : rooms_(rooms),
      batch_(batch),
      seed_(seed),
      renderer_(device, lens, rooms, 3 * batch),
      choices_(strided_triplets(rooms.frames)) {}

void RoomSource::render(uint64_t step) {
  scenes_.clear();
  frames_.clear();
  for (uint64_t b = 0; b < static_cast<uint64_t>(batch_); ++b) {
    const uint64_t index = step * static_cast<uint64_t>(batch_) + b;
    scenes_.push_back(sample_scene(rooms_, renderer_.lens().half_view(), seed_, index));
    Random random(seed_, kChoiceStreams + index);
    frames_.push_back(choices_[random.below(static_cast<uint32_t>(choices_.size()))]);
  }
  std::vector<View> views;
  for (std::size_t frame = 0; frame < 3; ++frame) {
    poses_[frame].clear();
    for (std::size_t b = 0; b < scenes_.size(); ++b) {
      views.push_back({&scenes_[b], frames_[b][frame]});
      const auto pose = scenes_[b].cameras[static_cast<std::size_t>(frames_[b][frame])].numbers();
      poses_[frame].insert(poses_[frame].end(), pose.begin(), pose.end());
    }
  }
  renderer_.render(views);
}

Slice RoomSource::third(const Slice& whole, int frame) const {
  return whole.sub(whole.bytes / 3 * static_cast<uint64_t>(frame), whole.bytes / 3);
}

Slice RoomSource::image(int frame) { return third(renderer_.image(), frame); }
Slice RoomSource::depth() { return third(renderer_.depth(), 1); }
Slice RoomSource::label() { return third(renderer_.label(), 1); }

std::vector<std::vector<ObjectTruth>> RoomSource::truths(const std::vector<uint32_t>& label) const {
  std::vector<std::vector<ObjectTruth>> result;
  const std::size_t area = renderer_.lens().pixels();
  for (std::size_t b = 0; b < scenes_.size(); ++b) {
    const Scene& scene = scenes_[b];
    const int frame = frames_[b][1];
    std::vector<ObjectTruth> objects;
    for (const RoomObject& object : scene.objects) {
      objects.push_back({scene.cameras[static_cast<std::size_t>(frame)].see(object.position(frame)), 0});
    }
    for (std::size_t i = b * area; i < (b + 1) * area; ++i) {
      if (label[i] > 0) ++objects[label[i] - 1].pixels;
    }
    result.push_back(std::move(objects));
  }
  return result;
}

TripletBatch RoomSource::download() {
  TripletBatch result;
  result.batch = batch_;
  result.height = renderer_.lens().height;
  result.width = renderer_.lens().width;
  for (int frame = 0; frame < 3; ++frame)
    result.images[static_cast<std::size_t>(frame)] = renderer_.planes(image(frame));
  result.poses = poses_;
  result.depth = download_values<float>(renderer_.device(), depth());
  result.label = download_values<uint32_t>(renderer_.device(), label());
  result.objects = truths(result.label);
  return result;
}

TripletBatch RoomSource::read(uint64_t step) {
  render(step);
  return download();
}

}  // namespace vkopple
