// What the ray through each pixel's centre meets in views of rooms. One invocation makes one pixel of one view.
//
// scene: the views packed as train/rooms/scene_pack.h says, `view_rows` rows each
// depth (views, height, width): Euclidean distance of it
// label (views, height, width): 0 background, i + 1 object i
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"

READ4(0, scene)
WRITE1(1, depth)
WRITEU(2, label)

layout(push_constant) uniform Push {
  int views, height, width;
  int view_rows;
  float focal;
};

#include "scene.glsl"

void main() {
  int index = int(flat_index());
  if (index >= views * height * width) return;
  int column = index % width, line = index / width % height;
  View v = load_view(index / (width * height));
  vec3 d = ray(v, vec2(column, line) + 0.5 - 0.5 * vec2(width, height));
  int surface;
  vec3 normal;
  uint mask = 0u;
  for (int i = 0; i < v.objects; ++i) mask |= may_meet(v, load_body(object_row(v, i)), d, 0.01) ? 1u << i : 0u;
  Hit hit = hit_objects(v, mask, d, hit_room(v, d, surface, normal));
  depth[index] = hit.t;
  label[index] = uint(hit.object + 1);
}
