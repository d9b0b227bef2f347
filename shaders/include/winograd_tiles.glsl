// Which tile an invocation of a Winograd transform takes. Tiles are numbered through the rows and images of the batch; a dispatch takes
// a chunk of them, in blocks of `width`. Transformed values lie as [block][frequency][channels / 4][tile of the block].
// Workgroups: x the vector of 4 channels, y the part of a block, z the block. Include row_store.glsl before.
layout(push_constant) uniform Push {
  int images;
  int channels4;
  int h;  // of the tensor read or written
  int w;
  int rows;  // of tiles in an image
  int columns;
  int first_image;  // of the chunk's first tile
  int first_row;
  int first_column;
  int width;
  int offset;    // of the first row and column that a tile reads from the first that it makes
  int channels;  // of the output
  int has_bias;
  ROW_DIGITS
} p;

const int kOutside = -1073741824;

struct Tile {
  int image;  // p.images or more beyond the last tile
  int row;
  int column;
};

Tile tile_at(int block, int within) {
  // Numbers within a chunk are small enough for floats.
  int column = p.first_column + block * p.width + within;
  int rows_on = int((float(column) + 0.5) / float(p.columns));
  int row = p.first_row + rows_on;
  int images_on = int((float(row) + 0.5) / float(p.rows));
  return Tile(p.first_image + images_on, row - images_on * p.rows, column - rows_on * p.columns);
}

int first_of_group() { return int(gl_WorkGroupID.y * gl_WorkGroupSize.x); }
Tile find_tile() { return tile_at(int(gl_WorkGroupID.z), first_of_group() + int(gl_LocalInvocationID.x)); }

// Where the transformed values of a workgroup's first tile start, and the distance from frequency to frequency.
int frequency_step() { return p.channels4 * p.width; }
int first_frequency(int block, int vector, int within) { return block * kFrequencies * frequency_step() + vector * p.width + within; }

// The same block, vector and tile, known to be uniform (row_store.glsl).
int known_block() { return known_uniform6(int(gl_WorkGroupID.z)); }
int known_vector() { return known_uniform4(int(gl_WorkGroupID.x)); }
int known_first_of_group() { return known_uniform4(int(gl_WorkGroupID.y)) * int(gl_WorkGroupSize.x); }
