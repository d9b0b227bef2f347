// variants: chunks images cells
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "splat.glsl"

// Where each cell's list begins among its image's points: the sum of the counts before it. `chunks` sums every chunk of cells,
// `images` makes of these the sums before each chunk, `cells` goes on inside the chunks and adds the end after the last cell.
#if defined(CHUNKS)
READU(0, counts)
WRITEU(1, sums)
#elif defined(IMAGES)
WRITEU(0, sums)
#else
READU(0, counts)
READU(1, sums)
WRITEU(2, starts)
#endif

void main() {
  uint i = flat_index();
#ifdef IMAGES
  if (i >= p.images) return;
  uint sum = 0;
  for (uint at = i * p.chunks; at < (i + 1) * p.chunks; ++at) {
    uint here = sums[at];
    sums[at] = sum;
    sum += here;
  }
#else
  uint image = i / p.chunks;
  if (image >= p.images) return;
  uint first = (i - image * p.chunks) * p.chunk_cells;
  uint end = min(first + p.chunk_cells, p.cells);
#ifdef CHUNKS
  uint sum = 0;
  for (uint cell = first; cell < end; ++cell) sum += counts[image * p.cells + cell];
  sums[i] = sum;
#else
  uint sum = sums[i];
  for (uint cell = first; cell < end; ++cell) {
    starts[image * (p.cells + 1) + cell] = sum;
    sum += counts[image * p.cells + cell];
  }
  if (end == p.cells) starts[image * (p.cells + 1) + p.cells] = sum;
#endif
#endif
}
