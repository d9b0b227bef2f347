// Where a ray first meets a solid, in the solid's own frame: its middle at the origin, z along its axis.
//
// A solid is the part of the slab |z| <= h where, with x' = x / a, y' = y / b and the size of the section s(z) = s0 + s1 z,
//   round:    x'^2 + y'^2 + e (z - c)^2 <= s(z)^2
//   polygon:  n_i . (x', y') <= s(z) for the outward normals n_i of a regular triangle or square
// A torus has its axis along y, ring radius a and tube radius b.

const float kMiss = 1e9;
const int kRound = 0, kTriangle = 1, kSquare = 2, kTorus = 3;

struct Solid {
  int kind;
  float h;
  float a, b, s0, s1;
  float e, c;
};

struct Entry {
  float t;       // kMiss where the ray misses
  vec3 normal;   // outward, of any length
};

// Cuts the ray's interval inside the solid by a half-space from which the ray is `gap` away, inside positive, and leaves at `speed`.
void clip(float gap, float speed, vec3 normal, inout Entry near, inout float far) {
  float t = gap / (abs(speed) < 1e-12 ? 1e-12 : speed);
  bool enters = speed < 0.0;
  if (enters && t > near.t) {
    near.t = t;
    near.normal = normal;
  }
  if (!enters) far = min(far, t);
}

void clip_side(Solid solid, vec3 o, vec3 d, vec2 n, inout Entry near, inout float far) {
  float gap = solid.s0 + solid.s1 * o.z - dot(n, o.xy), speed = dot(n, d.xy) - solid.s1 * d.z;
  clip(gap, speed, vec3(n.x / solid.a, n.y / solid.b, -solid.s1), near, far);
}

void clip_polygon(Solid solid, vec3 o, vec3 d, inout Entry near, inout float far) {
  bool square = solid.kind == kSquare;
  clip_side(solid, o, d, vec2(-1, 0), near, far);
  clip_side(solid, o, d, square ? vec2(1, 0) : vec2(0.5, 0.8660254), near, far);
  clip_side(solid, o, d, square ? vec2(0, 1) : vec2(0.5, -0.8660254), near, far);
  clip_side(solid, o, d, square ? vec2(0, -1) : vec2(-1, 0), near, far);
}

// The quadric q(t) = A t^2 + 2 B t + C <= 0 along the ray.
void clip_round(Solid solid, vec3 o, vec3 d, inout Entry near, inout float far) {
  float z = o.z - solid.c, s = solid.s0 + solid.s1 * o.z, ds = solid.s1 * d.z;
  float A = dot(d.xy, d.xy) + solid.e * d.z * d.z - ds * ds;
  float B = dot(o.xy, d.xy) + solid.e * z * d.z - s * ds;
  float C = dot(o.xy, o.xy) + solid.e * z * z - s * s;
  float discriminant = B * B - A * C;
  float root = sqrt(max(discriminant, 0.0));
  float q = -(B + (B < 0.0 ? -root : root));
  float t1 = q / (abs(A) < 1e-12 ? 1e-12 : A), t2 = C / (abs(q) < 1e-12 ? 1e-12 : q);
  float first = min(t1, t2), last = max(t1, t2);
  // A < 0: inside a double cone, which the ray leaves at `first` by one nappe and enters at `last` by the other. The solid's is
  // the one where s > 0, far ahead where s grows along the ray.
  if (A < 0.0) {
    float leaves = first;
    first = ds > 0.0 ? last : -kMiss;
    last = ds > 0.0 ? kMiss : leaves;
  }
  if (discriminant < 0.0) last = A < 0.0 ? last : -kMiss;
  if (first > near.t) {
    near.t = first;
    vec3 p = o + first * d;
    near.normal = vec3(p.x / solid.a, p.y / solid.b, solid.e * (p.z - solid.c) - solid.s1 * (solid.s0 + solid.s1 * p.z));
  }
  far = min(far, last);
}

float torus_distance(Solid solid, vec3 p) { return length(vec2(length(p.xz) - solid.a, p.y)) - solid.b; }

// Steps by the distance to the surface, so never through it, but by a fiftieth of the tube at least; once inside, halves the
// last step. Sturdier than the quartic, whose float roots go wild near tangents.
Entry hit_torus(Solid solid, vec3 o, vec3 d) {
  float outer = solid.a + solid.b, b = dot(o, d);
  vec3 closest = o - b * d;
  float chord = outer * outer - dot(closest, closest);
  float half_chord = sqrt(max(chord, 0.0));
  float t = max(-b - half_chord, 0.0), far = -b + half_chord, before = t, skin = 1e-5 * solid.a;
  bool inside = false;
  if (solid.kind != kTorus || chord <= 0.0) far = -kMiss;
  while (t < far && !inside) {
    float gap = torus_distance(solid, o + t * d);
    inside = gap < skin;
    if (!inside) {
      before = t;
      t += max(gap, 0.02 * solid.b);
    }
  }
  for (int i = 0; i < 12 && inside; ++i) {
    float middle = 0.5 * (before + t);
    if (torus_distance(solid, o + middle * d) < skin) t = middle;
    else before = middle;
  }
  vec3 p = o + t * d;
  float scale = solid.a / max(length(p.xz), 1e-9);
  return Entry(inside && t > 0.0 ? t : kMiss, p - scale * vec3(p.x, 0, p.z));
}

void clip_caps(Solid solid, vec3 o, vec3 d, inout Entry near, inout float far) {
  clip(solid.h - o.z, d.z, vec3(0, 0, 1), near, far);
  clip(solid.h + o.z, -d.z, vec3(0, 0, -1), near, far);
}

Entry entered(Entry near, float far) {
  if (near.t >= far || near.t <= 0.0) near.t = kMiss;
  return near;
}

// Of a round solid and of a polygonal one. The ray, whose d may have any length, is in the frame where a = b = 1, the normal in
// the solid's.
Entry hit_round(Solid solid, vec3 o, vec3 d) {
  Entry near = Entry(0.0, vec3(0));
  float far = kMiss;
  clip_caps(solid, o, d, near, far);
  clip_round(solid, o, d, near, far);
  return entered(near, far);
}

Entry hit_polygon(Solid solid, vec3 o, vec3 d) {
  Entry near = Entry(0.0, vec3(0));
  float far = kMiss;
  clip_caps(solid, o, d, near, far);
  clip_polygon(solid, o, d, near, far);
  return entered(near, far);
}

// Of any. o: the ray's origin, outside the solid; d: its direction, a unit vector.
Entry hit_solid(Solid solid, vec3 o, vec3 d) {
  Entry torus = hit_torus(solid, o, d);
  vec3 po = o / vec3(solid.a, solid.b, 1), pd = d / vec3(solid.a, solid.b, 1);
  Entry round = hit_round(solid, po, pd), polygon = hit_polygon(solid, po, pd);
  if (solid.kind == kTorus) return torus;
  if (solid.kind == kRound) return round;
  return polygon;
}
