// variants: fill sort
#version 450
#extension GL_GOOGLE_include_directive : require
#include "access.glsl"
#include "splat.glsl"

// Lists of the points of each cell. `fill`: one invocation puts one point into its list. `sort`: one invocation puts one list into
// ascending order, so that it no longer tells in which order threads ran.
#ifdef FILL
READU(0, places)
READU(1, starts)
WRITEU(2, lists)

void main() {
  uint i = flat_index();
  uint points = p.slots * p.width * p.height;  // of an image
  uint image = i / points;
  if (image >= p.images) return;
  uint cell = places[2 * i];
  if (cell == kNowhere) return;
  lists[image * points + starts[image * (p.cells + 1) + cell] + places[2 * i + 1]] = i - image * points;
}
#else
READU(0, starts)
WRITEU(1, lists)

// Beyond this length insertion's quadratic cost outgrows heapsort's.
const uint kInsertion = 48;

void insertion_sort(uint begin, uint end) {
  for (uint i = begin + 1; i < end; ++i) {
    uint moving = lists[i];
    uint hole = i;
    while (hole > begin) {
      uint before = lists[hole - 1];
      if (before <= moving) break;
      lists[hole--] = before;
    }
    lists[hole] = moving;
  }
}

// Lets `moving` sink from `node` of the heap of `size` entries at `begin`.
void sink(uint begin, uint node, uint size, uint moving) {
  for (uint child = 2 * node + 1; child < size; child = 2 * node + 1) {
    uint larger = lists[begin + child];
    if (child + 1 < size) {
      uint other = lists[begin + child + 1];
      if (other > larger) {
        larger = other;
        ++child;
      }
    }
    if (larger <= moving) break;
    lists[begin + node] = larger;
    node = child;
  }
  lists[begin + node] = moving;
}

// In place; bounded by n log n even where every point lands in one cell.
void heap_sort(uint begin, uint end) {
  uint size = end - begin;
  for (uint node = size / 2; node > 0; --node) sink(begin, node - 1, size, lists[begin + node - 1]);
  for (uint last = size - 1; last > 0; --last) {
    uint moving = lists[begin + last];
    lists[begin + last] = lists[begin];
    sink(begin, 0, last, moving);
  }
}

void main() {
  uint i = flat_index();
  uint image = i / p.cells;
  if (image >= p.images) return;
  uint first = image * p.slots * p.width * p.height;
  uint begin = first + starts[i + image];  // each image before has one entry more than cells
  uint end = first + starts[i + image + 1];
  if (end - begin <= kInsertion) insertion_sort(begin, end);
  else heap_sort(begin, end);
}
#endif
