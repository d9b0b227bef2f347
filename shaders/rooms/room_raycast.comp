// Ray-casts views of rooms. One invocation makes one pixel of one view.
//
// scene: the views packed as train/rooms/scene_pack.h says, `view_rows` rows each
// image (views, height, width): red, green, blue in [0, 1], 0: the mean of kSamples x kSamples rays
// depth (views, height, width): Euclidean distance of what the ray through the pixel's centre meets
// label (views, height, width): 0 background, i + 1 object i, likewise at the centre
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "shapes.glsl"
#include "texture.glsl"

READ4(0, scene)
WRITE4(1, image)
WRITE1(2, depth)
WRITEU(3, label)

layout(constant_id = 1) const int kSamples = 4;

layout(push_constant) uniform Push {
  int views, height, width;
  int view_rows;
  float focal;   // pixels
};

const int kHeaderRows = 5, kMaterialRows = 5, kSolidRows = 4, kObjectRows = kSolidRows + kMaterialRows;
const float kLying = 8.0;   // added to the kind of a solid whose axis is x
const int kNothing = -1;
const int kRun = 8;   // pixels of a line that decide together whether an object may be seen

struct View {
  int base;      // its first row
  int objects;
  vec3 eye, right, forward, up;   // the camera's axes in the world
  vec3 light;
  float room_half, room_height;
};

View load_view(int index) {
  View v;
  v.base = index * view_rows;
  vec4 r0 = load4(scene, v.base), r1 = load4(scene, v.base + 1), r2 = load4(scene, v.base + 2), r3 = load4(scene, v.base + 3);
  vec4 room = load4(scene, v.base + 4);
  v.eye = r0.xyz;
  v.objects = int(r0.w);
  v.right = vec3(r1.x, r2.x, r3.x);
  v.forward = vec3(r1.y, r2.y, r3.y);
  v.up = vec3(r1.z, r2.z, r3.z);
  v.light = vec3(r1.w, r2.w, r3.w);
  v.room_half = room.x;
  v.room_height = room.y;
  return v;
}

// Direction of the ray through a place of the image, in pixels right of and below its centre.
vec3 ray(View v, vec2 at) { return normalize(v.forward + (at.x * v.right - at.y * v.up) / focal); }

int object_row(View v, int i) { return v.base + kHeaderRows + i * kObjectRows; }

// Bit i: some ray that is at most `wide` pixels away may come within reach of object i.
uint candidates(View v, vec3 d, float wide) {
  uint mask = 0u;
  for (int i = 0; i < v.objects; ++i) {
    vec3 to = load4(scene, object_row(v, i)).xyz - v.eye;
    float reach = load4(scene, object_row(v, i) + 1).z + wide / focal * length(to);
    float along = dot(to, d);
    vec3 aside = to - along * d;
    if (along > -reach && dot(aside, aside) < reach * reach) mask |= 1u << i;
  }
  return mask;
}

vec3 to_object(vec3 p, vec2 turn) { return vec3(turn.x * p.x + turn.y * p.y, turn.x * p.y - turn.y * p.x, p.z); }
vec3 from_object(vec3 p, vec2 turn) { return vec3(turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y, p.z); }

struct Hit {
  float t;
  int object;
  vec3 normal;   // of the object hit, in the world
};

Solid load_solid(int row, float kind, float h) {
  vec4 r2 = load4(scene, row + 2), r3 = load4(scene, row + 3);
  return Solid(int(kind), h, r2.x, r2.y, r2.z, r2.w, r3.x, r3.y);
}

// The nearest object of the mask before `t`.
Hit hit_objects(View v, uint mask, vec3 d, float t) {
  Hit hit = Hit(t, kNothing, vec3(0));
  while (mask != 0u) {
    int i = findLSB(mask);
    mask &= mask - 1u;
    int row = object_row(v, i);
    vec4 r0 = load4(scene, row), r1 = load4(scene, row + 1);
    bool lies = r0.w >= kLying;
    vec3 o = to_object(v.eye - r0.xyz, r1.xy), along = to_object(d, r1.xy);
    Entry entry = hit_solid(load_solid(row, lies ? r0.w - kLying : r0.w, r1.w), lies ? o.yzx : o, lies ? along.yzx : along);
    if (entry.t < hit.t) {
      hit.t = entry.t;
      hit.object = i;
      hit.normal = from_object(lies ? entry.normal.zxy : entry.normal, r1.xy);
    }
  }
  return hit;
}

// Distance to the room's shell; surface: 0 wall, 1 floor, 2 ceiling.
float hit_room(View v, vec3 d, out int surface, out vec3 normal) {
  vec2 side = vec2(d.x < 0.0 ? -v.room_half : v.room_half, d.y < 0.0 ? -v.room_half : v.room_half);
  float tx = d.x == 0.0 ? kMiss : (side.x - v.eye.x) / d.x;
  float ty = d.y == 0.0 ? kMiss : (side.y - v.eye.y) / d.y;
  float tz = d.z == 0.0 ? kMiss : ((d.z < 0.0 ? 0.0 : v.room_height) - v.eye.z) / d.z;
  float t = min(tx, min(ty, tz));
  surface = tz == t ? (d.z < 0.0 ? 1 : 2) : 0;
  normal = tz == t ? vec3(0, 0, -sign(d.z)) : tx == t ? vec3(-sign(d.x), 0, 0) : vec3(0, -sign(d.y), 0);
  return t;
}

Material load_material(int row) {
  vec4 r0 = load4(scene, row), r1 = load4(scene, row + 1), r2 = load4(scene, row + 2), r3 = load4(scene, row + 3);
  return Material(r0.xyz, r1.xyz, r2.xyz, r3.xyz, load4(scene, row + 4), r1.w, int(r0.w));
}

// Of the room alone.
vec3 colour_of_room(View v, vec3 d) {
  int surface;
  vec3 normal;
  vec3 point = v.eye + hit_room(v, d, surface, normal) * d;
  float shade = 0.88 + 0.12 * dot(normal, v.light);
  return clamp(paint(load_material(object_row(v, v.objects) + surface * kMaterialRows), point) * shade, 0.0, 1.0);
}

vec3 colour_along(View v, uint mask, vec3 d) {
  int surface;
  vec3 normal;
  float wall = hit_room(v, d, surface, normal);
  Hit hit = hit_objects(v, mask, d, wall);
  vec3 point = v.eye + hit.t * d;
  int row = object_row(v, v.objects) + surface * kMaterialRows;
  float shade = 0.88 + 0.12 * dot(normal, v.light);
  if (hit.object != kNothing) {
    row = object_row(v, hit.object);
    point = to_object(point - load4(scene, row).xyz, load4(scene, row + 1).xy);
    shade = 0.65 + 0.35 * dot(normalize(hit.normal), v.light);
    row += kSolidRows;
  }
  return clamp(paint(load_material(row), point) * shade, 0.0, 1.0);
}

// Of ray s from the pixel's centre, in pixels.
vec2 offset(int s) { return (vec2(s % kSamples, s / kSamples) + 0.5) / float(kSamples) - 0.5; }

void main() {
  int index = int(flat_index());
  if (index >= views * height * width) return;
  int column = index % width, line = index / width % height;
  View v = load_view(index / (width * height));
  vec2 centre = vec2(column, line) + 0.5 - 0.5 * vec2(width, height);

  vec3 d = ray(v, centre);
  uint mask = candidates(v, d, 0.75);
  int surface;
  vec3 normal;
  Hit hit = hit_objects(v, mask, d, hit_room(v, d, surface, normal));
  depth[index] = hit.t;
  label[index] = uint(hit.object + 1);

  // Objects cost most. On CPU devices a wave leaves out only loops that none of its pixels runs, so that the pixels of a run
  // decide together.
  vec2 run_centre = vec2(column / kRun * kRun, line) + 0.5 * vec2(kRun, 1) - 0.5 * vec2(width, height);
  bool empty = candidates(v, ray(v, run_centre), 0.5 * float(kRun) + 1.0) == 0u;
  int samples = kSamples * kSamples;
  vec3 sum = vec3(0);
  for (int s = empty ? 0 : samples; s < samples; ++s) sum += colour_of_room(v, ray(v, centre + offset(s)));
  for (int s = empty ? samples : 0; s < samples; ++s) sum += colour_along(v, mask, ray(v, centre + offset(s)));
  store4(image, index, vec4(sum / float(kSamples * kSamples), 0.0));
}
