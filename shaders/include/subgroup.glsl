#ifndef SUBGROUP_GLSL
#define SUBGROUP_GLSL
// What subgroups share. The size is nowhere assumed beyond what a kernel's host side requires of the device.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

layout(constant_id = 101) const uint kSubgroupSize = 1;

// Lanes of the widest subgroup that CPU devices have.
const int kMostLanes = 16;

// The value that lane number `lane` (a constant below 128, the same in all lanes) holds. The lane is written so that the front
// end can't see it to be constant: lavapipe's takes the constant for a broadcast and loops over the lanes (5 ns), whereas LLVM
// finds the constant and makes one permute of it.
#define from_lane(v, lane) subgroupShuffle(v, (gl_SubgroupInvocationID >> 7) + uint(lane))
#endif
