// Views of rooms as train/rooms/scene_pack.h packs them, and what a ray meets there. Needs READ4(n, scene) and a push constant
// `view_rows` (rows of a view) and `focal` (pixels) before it.
#include "shapes.glsl"

const int kHeaderRows = 5, kMaterialRows = 6, kSolidRows = 4, kObjectRows = kSolidRows + kMaterialRows;
const float kLying = 8.0;   // added to the kind of a solid whose axis is x
const int kNothing = -1;

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

// Towards a place of the image, in pixels right of and below its centre; of length 1 or more.
vec3 towards(View v, vec2 at) { return v.forward + (at.x * v.right - at.y * v.up) / focal; }
vec3 ray(View v, vec2 at) { return normalize(towards(v, at)); }

int object_row(View v, int i) { return v.base + kHeaderRows + i * kObjectRows; }

vec3 to_object(vec3 p, vec2 turn) { return vec3(turn.x * p.x + turn.y * p.y, turn.x * p.y - turn.y * p.x, p.z); }
vec3 from_object(vec3 p, vec2 turn) { return vec3(turn.x * p.x - turn.y * p.y, turn.y * p.x + turn.x * p.y, p.z); }

// An object without its paint.
struct Body {
  vec3 middle;
  vec2 turn;     // cosine and sine of its yaw
  bool lies;
  float reach;
  Solid solid;
};

Body load_body(int row) {
  vec4 r0 = load4(scene, row), r1 = load4(scene, row + 1), r2 = load4(scene, row + 2), r3 = load4(scene, row + 3);
  bool lies = r0.w >= kLying;
  return Body(r0.xyz, r1.xy, lies, r1.z, Solid(int(lies ? r0.w - kLying : r0.w), r1.w, r2.x, r2.y, r2.z, r2.w, r3.x, r3.y));
}

// A direction of the world in the solid's frame.
vec3 to_solid(Body b, vec3 p) {
  vec3 turned = to_object(p, b.turn);
  return b.lies ? turned.yzx : turned;
}

struct Hit {
  float t;
  int object;
  vec3 normal;   // of the object hit, in the world
};

void hit_body(View v, Body b, int i, vec3 d, inout Hit hit) {
  Entry entry = hit_solid(b.solid, to_solid(b, v.eye - b.middle), to_solid(b, d));
  if (entry.t < hit.t) {
    hit.t = entry.t;
    hit.object = i;
    hit.normal = from_object(b.lies ? entry.normal.zxy : entry.normal, b.turn);
  }
}

// The nearest object of the mask before `t`.
Hit hit_objects(View v, uint mask, vec3 d, float t) {
  Hit hit = Hit(t, kNothing, vec3(0));
  // Asks at the end: CPU devices run what follows a `break` once more, for no pixel.
  if (mask != 0u) for (;;) {
    int i = findLSB(mask);
    mask &= mask - 1u;
    hit_body(v, load_body(object_row(v, i)), i, d, hit);
    if (mask == 0u) break;
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

int surface_row(View v, int surface) { return object_row(v, v.objects) + surface * kMaterialRows; }

// Whether some ray at most `wide` pixels away from d, of length 1 or more, may meet the body. It lies in a box about its middle, here
// made larger by what the rays spread; a line misses a box where a plane through the line, along one of its sides, does.
bool may_meet(View v, Body b, vec3 d, float wide) {
  vec3 to = b.middle - v.eye;
  float spread = wide / focal * (length(to) + b.reach);
  float ahead = dot(to, d), reach = b.reach + spread;
  if (ahead < 0.0 && ahead * ahead > reach * reach * dot(d, d)) return false;
  vec3 o = to_solid(b, to), along = to_solid(b, d);
  Solid x = b.solid;
  vec3 size = (x.kind == kTorus ? vec3(x.a + x.b, x.b, x.a + x.b) : vec3(x.a, x.b, x.h)) + spread;
  vec3 apart = abs(cross(o, along)), most = size.yzx * abs(along.zxy) + size.zxy * abs(along.yzx);
  return all(lessThanEqual(apart, most));
}
