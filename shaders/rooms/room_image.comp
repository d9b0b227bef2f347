// variants: sorted plain
// Ray-casts pictures of views of rooms. One invocation makes kLines pixels of a column.
//
// scene: the views packed as train/rooms/scene_pack.h says, `view_rows` rows each
// image (views, 3, height, width): red, green, blue in [0, 1], the mean of kSamples x kSamples rays
//
// On lavapipe the end of a loop is the only branch: all other code runs whether a pixel needs it or not, and a loop's once at
// least. So, in the variant `sorted`, an invocation first sorts its pixels by what they show, and then takes one kind after the
// other, each in a loop of its own that has the code of that kind alone. Loops ask at their end, since what follows a `break` would
// run once more for nothing. What is linear in a ray's place in the image is computed by differences; colours are mixed once a pixel
// where they can be.
// The variant `plain` has the code for the last kind alone, which can show anything. It is a fifth as long, for drivers that take
// gigabytes of memory to compile the other one.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "planes.glsl"

READ4(0, scene)
WRITE1(1, image)

layout(constant_id = 1) const int kSamples = 4;
layout(constant_id = 3) const int kLines = 32;

layout(push_constant) uniform Push {
  int views, height, width;
  int view_rows;
  float focal;   // pixels
};

#include "scene.glsl"
#include "texture.glsl"
#include "samples.glsl"
#include "column.glsl"
#include "targets.glsl"

void finish(Column c, int k, vec3 sum) {
  store3(image, c.first + k * width, height * width, min(sum / float(kSamples * kSamples), 1.0))
}

#ifdef SORTED
// One surface of the room, of the given pattern.
void draw_walls(Column c, int number, int pattern) {
  uint todo = walls_of(c, number);
  if (todo != 0u) for (;;) {
    int k = findLSB(todo);
    todo &= todo - 1u;
    Wall wall = find_wall(c, towards(c.view, centre(c, k)));
    Material material = wall.material;
    Linear d = direction(c.view, centre(c, k)), turned = transform(material.turn, d);
    vec3 across = vec3(along(wall, d.start), along(wall, d.right), along(wall, d.down)) / wall.far;
    vec3 from = material.turn * c.view.eye + material.phase, sum = vec3(0);
    for (int j = 0;;) {
      for (int i = 0; i < kSamples; ++i) {
        float t = 1.0 / (across.x + float(j) * across.z + float(i) * across.y);
        sum += shares(material, pattern, from + t * at(turned, i, j));
      }
      if (++j == kSamples) break;
    }
    finish(c, k, material.colours * sum * wall.shade);
    if (todo == 0u) break;
  }
}

// Several surfaces of the room.
void draw_edges(Column c) {
  uint todo = c.edges;
  if (todo != 0u) for (;;) {
    int k = findLSB(todo);
    todo &= todo - 1u;
    Linear direction = direction(c.view, centre(c, k));
    vec3 sum = vec3(0);
    for (int s = 0;;) {
      vec3 d = at(direction, column_of(s), line_of(s)), normal;
      int number;
      vec3 point = c.view.eye + hit_room(c.view, d, number, normal) * d;
      Material material = surface(c, number);
      vec3 shown = shares(material, material.pattern, material.turn * point + material.phase);
      sum += material.colours * shown * room_shade(c.view, normal);
      if (++s == kSamples * kSamples) break;
    }
    finish(c, k, sum);
    if (todo == 0u) break;
  }
}

// One object of the given kind, before one surface of the room.
void draw_body(Column c, uint todo, int kind) {
  if (todo != 0u) for (;;) {
    int k = findLSB(todo);
    todo &= todo - 1u;
    Linear d = direction(c.view, centre(c, k));
    Wall wall = find_wall(c, towards(c.view, centre(c, k)));
    vec3 across = vec3(along(wall, d.start), along(wall, d.right), along(wall, d.down)) / wall.far;
    Material behind = wall.material;
    Linear turned = transform(behind.turn, d);
    vec3 from = behind.turn * c.view.eye + behind.phase, sum_behind = vec3(0), sum = vec3(0);
    Target object = load_target(c.view, number_of(c.object, k), d, kind == kTorus);
    for (int s = 0;;) {
      int i = column_of(s), j = line_of(s);
      float far = 1.0 / (across.x + float(j) * across.z + float(i) * across.y);
      Entry entry = meet(object, kind, i, j);
      bool met = entry.t < far;
      Material material = choose(met, object.material, behind);
      vec3 q = met ? object.from + entry.t * at(object.turned, i, j) : from + far * at(turned, i, j);
      vec3 shown = shares(material, material.pattern, q);
      sum += met ? shown * object_shade(entry.normal, object.light) : vec3(0);
      sum_behind += met ? vec3(0) : shown;
      if (++s == kSamples * kSamples) break;
    }
    finish(c, k, object.material.colours * sum + behind.colours * sum_behind * wall.shade);
    if (todo == 0u) break;
  }
}

// Two objects at most, neither a torus.
void draw_pairs(Column c) {
  uint todo = c.pairs;
  if (todo != 0u) for (;;) {
    int k = findLSB(todo);
    todo &= todo - 1u;
    Linear direction = direction(c.view, centre(c, k));
    Target one = load_target(c.view, number_of(c.object, k), direction, false);
    Target other = load_target(c.view, number_of(c.other, k), direction, false);
    vec3 sum = vec3(0);
    for (int s = 0;;) {
      int i = column_of(s), j = line_of(s), number;
      vec3 d = at(direction, i, j), normal;
      float far = hit_room(c.view, d, number, normal);
      Material material = surface(c, number);
      vec3 q = material.turn * (c.view.eye + far * d) + material.phase;
      float shade = room_shade(c.view, normal);
      Entry entry = meet_convex(one, i, j), second = meet_convex(other, i, j);
      bool is_other = second.t < entry.t, met = min(entry.t, second.t) < far;
      if (is_other) entry = second;
      material = choose(met, choose(is_other, other.material, one.material), material);
      if (met) {
        q = is_other ? other.from + entry.t * at(other.turned, i, j) : one.from + entry.t * at(one.turned, i, j);
        shade = object_shade(entry.normal, is_other ? other.light : one.light);
      }
      sum += material.colours * shares(material, material.pattern, q) * shade;
      if (++s == kSamples * kSamples) break;
    }
    finish(c, k, sum);
    if (todo == 0u) break;
  }
}

#endif

// Pixels of any kind: all, or the few that are left.
void draw_anything(Column c) {
  uint todo = c.anything;
  if (todo != 0u) for (;;) {
    int k = findLSB(todo);
    todo &= todo - 1u;
    Linear direction = direction(c.view, centre(c, k));
    uint objects = 0u;
    for (int i = 0; i < c.view.objects; ++i)
      if (may_meet(c.view, load_body(object_row(c.view, i)), towards(c.view, centre(c, k)), kHalfPixel)) objects |= 1u << i;
    vec3 sum = vec3(0);
    for (int s = 0;;) {
      vec3 d = normalize(at(direction, column_of(s), line_of(s))), normal;
      int number;
      float far = hit_room(c.view, d, number, normal);
      Hit hit = hit_objects(c.view, objects, d, far);
      vec3 point = c.view.eye + hit.t * d;
      bool met = hit.object != kNothing;
      int row = object_row(c.view, met ? hit.object : 0);
      if (met) point = to_object(point - load4(scene, row).xyz, load4(scene, row + 1).xy);
      float shade = met ? object_shade(hit.normal, c.view.light) : room_shade(c.view, normal);
      Material material = choose(met, load_material(row + kSolidRows), surface(c, number));
      sum += material.colours * shares(material, material.pattern, material.turn * point + material.phase) * shade;
      if (++s == kSamples * kSamples) break;
    }
    finish(c, k, sum);
    if (todo == 0u) break;
  }
}

void main() {
  int index = int(flat_index()), blocks = (height + kLines - 1) / kLines;
  if (index >= views * blocks * width) return;
  int x = index % width, y = index / width % blocks * kLines, view = index / (width * blocks);
  Column c;
  c.view = load_view(view);
  c.centre = vec2(x, y) + 0.5 - 0.5 * vec2(width, height);
  c.wall = load_material(surface_row(c.view, 0));
  c.floor = load_material(surface_row(c.view, 1));
  c.ceiling = load_material(surface_row(c.view, 2));
  c.first = (view * 3 * height + y) * width + x;
  int lines = min(height - y, kLines);
#ifdef SORTED
  sort_pixels(c, lines);
  if (kTextures != kAllSmooth) {
    draw_walls(c, 0, 0);
    draw_walls(c, 1, 1);
    draw_walls(c, 2, 2);
    draw_walls(c, 3, 3);
    draw_walls(c, 4, 4);
    draw_walls(c, 5, 5);
    draw_walls(c, 6, 6);
    draw_walls(c, 7, 7);
    draw_walls(c, 8, 8);
  }
  if (kTextures != kAllPeriodic) {
    draw_walls(c, kSmooth, 16);
    draw_walls(c, kSmooth + 1, 17);
    draw_walls(c, kSmooth + 2, 18);
  }
  draw_edges(c);
  draw_body(c, c.round, kRound);
  draw_body(c, c.polygon, kSquare);
  draw_body(c, c.torus, kTorus);
  draw_pairs(c);
#else
  c.anything = ~0u >> (32 - lines);
#endif
  draw_anything(c);
}
