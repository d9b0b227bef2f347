// Up to 32 pixels of a column of a picture, sorted by what they show. Needs scene.glsl, texture.glsl and kLines, the pixels of a
// column, before it.

const float kHalfPixel = 0.71;   // no place of a pixel is farther from its centre

// Pixels of a column are bits of words, its first pixel bit 0. Each is of one kind.
struct Column {
  View view;
  Material wall, floor, ceiling;
  vec2 centre;       // of its first pixel, from the image's
  int first;         // place of that in the image
  uint walls;        // one surface of the room
  uvec4 pattern;     // bit by bit the pattern that it has
  uint edges;        // several surfaces of the room
  uint round, polygon, torus;   // perhaps one object of the kind, before one surface
  uvec3 object;      // bit by bit its number, below 8
  uint pairs;        // perhaps `object` and perhaps `other`, neither a torus
  uvec3 other;
  uint anything;
};

vec2 centre(Column c, int k) { return c.centre + vec2(0, k); }

// Of the kinds that are walls: of pattern 0-8, and of 16-18 from kSmooth on.
const int kSmooth = 9;

uint walls_of(Column c, int number) {
  uint found = c.walls;
  for (int bit = 0; bit < 4; ++bit) found &= (number >> bit & 1) != 0 ? c.pattern[bit] : ~c.pattern[bit];
  return found;
}

// The number whose bits pixel k has in three words.
int number_of(uvec3 object, int k) {
  uvec3 bits = object >> k & 1u;
  return int(bits.x | bits.y << 1 | bits.z << 2);
}

Material load_material(int row) {
  vec4 r0 = load4(scene, row), r1 = load4(scene, row + 1), r2 = load4(scene, row + 2);
  vec4 c0 = load4(scene, row + 3), c1 = load4(scene, row + 4), c2 = load4(scene, row + 5);
  mat3 turn = transpose(mat3(r0.xyz, r1.xyz, r2.xyz));
  return Material(turn, vec3(r0.w, r1.w, r2.w), mat3(c0.xyz, c1.xyz, c2.xyz), int(c0.w), c1.w);
}

Material choose(bool first, Material a, Material b) {
  return Material(first ? a.turn : b.turn, first ? a.phase : b.phase, first ? a.colours : b.colours,
                  first ? a.pattern : b.pattern, first ? a.shift : b.shift);
}

Material surface(Column c, int number) { return choose(number == 0, c.wall, choose(number == 1, c.floor, c.ceiling)); }

// Which of the room's 6 lies at a place of the image: 1 the floor, 2 the ceiling, above 2 the walls.
int face(View v, vec2 place) {
  int surface;
  vec3 normal;
  hit_room(v, towards(v, place), surface, normal);
  return surface > 0 ? surface : normal.x != 0.0 ? 4 + int(normal.x) : 7 + int(normal.y);
}

// `lines`: how many of its pixels lie in the picture.
void sort_pixels(inout Column c, int lines) {
  uint inside = lines < 32 ? (1u << lines) - 1u : ~0u;
  uint some = 0u, several = 0u, many = 0u, torus = 0u, polygon = 0u;
  c.object = c.other = uvec3(0);
  for (int i = 0;;) {
    Body body = load_body(object_row(c.view, i));
    uint met = 0u;
    for (int k = 0; k < kLines; ++k) met |= may_meet(c.view, body, towards(c.view, centre(c, k)), kHalfPixel) ? 1u << k : 0u;
    bvec3 bits = notEqual(i & ivec3(1, 2, 4), ivec3(0));
    c.object |= mix(uvec3(0), uvec3(met & ~some), bits);
    c.other |= mix(uvec3(0), uvec3(met & some), bits);
    many |= several & met;
    several |= some & met;
    some |= met;
    if (body.solid.kind == kTorus) torus |= met;
    else if (body.solid.kind != kRound) polygon |= met;
    if (++i == c.view.objects) break;
  }
  uint whole = 0u;
  c.pattern = uvec4(0);
  int left = face(c.view, c.centre - 0.5), right = face(c.view, c.centre + vec2(0.5, -0.5));
  for (int k = 0; k < kLines; ++k) {
    int below_left = face(c.view, centre(c, k) + vec2(-0.5, 0.5)), below_right = face(c.view, centre(c, k) + 0.5);
    // A face is convex: one that all corners of a pixel show fills it.
    if (left == right && left == below_left && left == below_right) whole |= 1u << k;
    int pattern = left == 1 ? c.floor.pattern : left == 2 ? c.ceiling.pattern : c.wall.pattern;
    if (pattern >= kFirstSmooth) pattern += kSmooth - kFirstSmooth;
    c.pattern |= mix(uvec4(0), uvec4(1u << k), notEqual(pattern & ivec4(1, 2, 4, 8), ivec4(0)));
    left = below_left;
    right = below_right;
  }
  c.walls = inside & ~some & whole;
  c.edges = inside & ~some & ~whole;
  uint simple = inside & some & ~several & whole;
  c.round = simple & ~polygon & ~torus;
  c.polygon = simple & polygon;
  c.torus = simple & torus;
  c.pairs = inside & some & ~simple & ~many & ~torus;
  c.other |= c.object & ~several;   // one object alone is paired with itself
  c.anything = inside & some & ~simple & ~c.pairs;
}
