#include "train/rooms/room_source.h"

#include <span>
#include <utility>

#include "runtime/device.h"
#include "runtime/transfer.h"
#include "train/random.h"

namespace vkopple {
namespace {

// Scenes take the streams from 0 on, the choice of their frames those from here on.
constexpr uint64_t kChoiceStreams = uint64_t{1} << 63;
constexpr int kFrames = 3;

/// One of equal parts.
Slice part(const Slice& whole, int index, int count) {
  const uint64_t bytes = whole.bytes / static_cast<uint64_t>(count);
  return whole.sub(bytes * static_cast<uint64_t>(index), bytes);
}

/// `label`: of the frame, at the pixels' centres.
std::vector<ObjectTruth> truth_of(const Scene& scene, int frame, std::span<const uint32_t> label) {
  std::vector<ObjectTruth> objects;
  const RoomCamera& camera = scene.cameras[static_cast<std::size_t>(frame)];
  for (const RoomObject& object : scene.objects)
    objects.push_back({camera.see(object.position(frame)), 0, object.yaw(frame) - camera.yaw});
  for (const uint32_t id : label)
    if (id > 0) ++objects[id - 1].pixels;
  return objects;
}

}  // namespace

RoomSource::RoomSource(const Device& device, const Lens& lens, const RoomsConfig& rooms, int batch,
                       uint64_t seed)
    : device_(&device),
      lens_(lens),
      rooms_(rooms),
      batch_(batch),
      seed_(seed),
      choices_(strided_triplets(rooms.frames)) {}

uint64_t RoomSource::read_bytes(const Lens& lens, const RoomsConfig& rooms, int batch) {
  return RoomRenderer::device_bytes(lens, rooms, kFrames * batch, RoomRenderer::Truth::kDrawn);
}

uint64_t RoomSource::show_bytes(const Lens& lens, const RoomsConfig& rooms, int batch, int first_frame) {
  return RoomRenderer::device_bytes(lens, rooms, (kFrames - first_frame) * batch,
                                    RoomRenderer::Truth::kLeftOut);
}

std::vector<RoomTriplet> RoomSource::scenes(uint64_t step) const {
  std::vector<RoomTriplet> shown;
  for (uint64_t b = 0; b < static_cast<uint64_t>(batch_); ++b) {
    const uint64_t index = step * static_cast<uint64_t>(batch_) + b;
    Random random(seed_, kChoiceStreams + index);
    shown.push_back({sample_scene(rooms_, lens_.half_view(), seed_, index),
                     choices_[random.below(static_cast<uint32_t>(choices_.size()))]});
  }
  return shown;
}

TripletBatch RoomSource::draw(const std::vector<RoomTriplet>& shown, int first_frame,
                              RoomRenderer& renderer) const {
  TripletBatch batch{.batch = batch_, .height = lens_.height, .width = lens_.width};
  std::vector<View> views;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (const auto& [scene, frames] : shown) {
      const int which = frames[static_cast<std::size_t>(frame)];
      if (frame >= first_frame) views.push_back({&scene, which});
      const auto pose = scene.cameras[static_cast<std::size_t>(which)].numbers();
      auto& poses = batch.poses[static_cast<std::size_t>(frame)];
      poses.insert(poses.end(), pose.begin(), pose.end());
    }
  }
  renderer.render(views);
  return batch;
}

TripletBatch RoomSource::read(uint64_t step) {
  if (!whole_) whole_.emplace(*device_, lens_, rooms_, kFrames * batch_);
  const std::vector<RoomTriplet> shown = scenes(step);
  TripletBatch batch = draw(shown, 0, *whole_);
  for (int frame = 0; frame < kFrames; ++frame)
    batch.images[static_cast<std::size_t>(frame)] =
        download_values<float>(*device_, part(whole_->image(), frame, kFrames));
  batch.depth = download_values<float>(*device_, part(whole_->depth(), 1, kFrames));
  batch.label = download_values<uint32_t>(*device_, part(whole_->label(), 1, kFrames));
  for (std::size_t b = 0; b < shown.size(); ++b)
    batch.objects.push_back(truth_of(shown[b].scene, shown[b].frames[1],
                                     std::span(batch.label).subspan(b * lens_.pixels(), lens_.pixels())));
  return batch;
}

TripletBatch RoomSource::show(uint64_t step, const std::vector<bool>& reversed, int first_frame) {
  const int views = (kFrames - first_frame) * batch_;
  if (!training_ || training_->views() != views)
    training_.emplace(*device_, lens_, rooms_, views, RoomRenderer::Truth::kLeftOut);
  std::vector<RoomTriplet> shown = scenes(step);
  for (std::size_t b = 0; b < shown.size(); ++b)
    if (reversed.at(b)) std::swap(shown[b].frames[0], shown[b].frames[2]);
  TripletBatch batch = draw(shown, first_frame, *training_);
  batch.drawn = training_->image();
  return batch;
}

}  // namespace vkopple
