// What most pixels show, with what their rays have in common computed once. Needs column.glsl and samples.glsl before it.

float room_shade(View v, vec3 normal) { return 0.88 + 0.12 * dot(normal, v.light); }
float object_shade(vec3 normal, vec3 light) { return 0.65 + 0.35 * dot(normalize(normal), light); }

// One plane of the room: the axis across it, and how far it is along the axis.
struct Wall {
  int axis;
  float far;
  float shade;
  Material material;
};

// The one that d meets.
Wall find_wall(Column c, vec3 d) {
  View v = c.view;
  int number;
  vec3 normal;
  hit_room(v, d, number, normal);
  Wall w;
  w.axis = normal.z != 0.0 ? 2 : normal.x != 0.0 ? 0 : 1;
  float side = w.axis < 2 ? v.room_half : d.z < 0.0 ? 0.0 : v.room_height;
  w.far = w.axis == 2 ? side - v.eye.z : w.axis == 0 ? -normal.x * side - v.eye.x : -normal.y * side - v.eye.y;
  w.shade = room_shade(v, normal);
  w.material = surface(c, number);
  return w;
}

float along(Wall w, vec3 d) { return w.axis == 0 ? d.x : w.axis == 1 ? d.y : d.z; }

// An object as the rays of a pixel meet it.
struct Target {
  Solid solid;
  vec3 origin, light;   // in the solid's frame; the origin where a = b = 1 unless it is a torus
  Linear direction;     // likewise
  Material material;
  vec3 from;            // in the pattern's frame
  Linear turned;
};

Linear to_solid(Body b, Linear x) { return Linear(to_solid(b, x.start), to_solid(b, x.right), to_solid(b, x.down)); }
Linear to_object(Linear x, vec2 turn) {
  return Linear(to_object(x.start, turn), to_object(x.right, turn), to_object(x.down, turn));
}

Target load_target(View v, int number, Linear d, bool torus) {
  int row = object_row(v, number);
  Body body = load_body(row);
  Target x;
  x.solid = body.solid;
  x.material = load_material(row + kSolidRows);
  vec3 unit = torus ? vec3(1) : 1.0 / vec3(body.solid.a, body.solid.b, 1), eye = v.eye - body.middle;
  x.origin = to_solid(body, eye) * unit;
  x.light = to_solid(body, v.light);
  x.direction = scale(to_solid(body, d), unit);
  x.from = x.material.turn * to_object(eye, body.turn) + x.material.phase;
  x.turned = transform(x.material.turn, to_object(d, body.turn));
  return x;
}

// Of the given kind.
Entry meet(Target x, int kind, int i, int j) {
  vec3 d = at(x.direction, i, j);
  if (kind == kRound) return hit_round(x.solid, x.origin, d);
  if (kind != kTorus) return hit_polygon(x.solid, x.origin, d);
  Entry entry = hit_torus(x.solid, x.origin, normalize(d));
  entry.t /= length(d);
  return entry;
}

// Of any kind but a torus.
Entry meet_convex(Target x, int i, int j) {
  Entry round = meet(x, kRound, i, j), polygon = meet(x, kSquare, i, j);
  if (x.solid.kind == kRound) return round;
  return polygon;
}
