#include "graph/kernels/rigid_motion.h"

namespace vkopple {
namespace {

struct MovePush {
  RigidMotion sizes;
  uint32_t strips;  ///< invocations that share an image's pixels
  uint32_t accumulate;
};

/// An invocation's pixels, enough to make up for loading what moves them.
constexpr uint32_t kPixelsForward = 16;
constexpr uint32_t kPixelsBackward = 4;

MovePush push_of(const RigidMotion& sizes, uint32_t pixels, bool accumulate) {
  return {sizes, (sizes.pixels + pixels - 1) / pixels, accumulate ? 1U : 0U};
}

}  // namespace

void record_moved(Recorder& recorder, const RigidMotion& sizes, Turns turns, const Slice& points,
                  const MotionSlices& motion, const Slice& moved) {
  const MovePush push = push_of(sizes, kPixelsForward, false);
  recorder.dispatch_flat(turns == Turns::kAngles ? "move_pixels.forward" : "move_pixels.forward_turns",
                         static_cast<uint64_t>(sizes.images) * (sizes.slots + 1) * push.strips,
                         {motion.location, motion.velocity, motion.turn, motion.m23, points, moved}, push);
}

void record_moved_dpoints(Recorder& recorder, const RigidMotion& sizes, Turns turns, const MotionSlices& motion,
                          const Slice& dmoved, const Slice& dpoints, bool accumulate) {
  const MovePush push = push_of(sizes, kPixelsBackward, accumulate);
  recorder.dispatch_flat(turns == Turns::kAngles ? "move_pixels.points" : "move_pixels.points_turns",
                         static_cast<uint64_t>(sizes.images) * push.strips,
                         {motion.location, motion.velocity, motion.turn, motion.m23, dmoved, dpoints}, push);
}

}  // namespace vkopple
