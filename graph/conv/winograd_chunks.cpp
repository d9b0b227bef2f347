#include "graph/conv/winograd_chunks.h"

#include <algorithm>
#include <string>

#include "graph/tensor.h"

namespace vkopple {
namespace {

/// Of one chunk's transformed values, for 64 channels at 128 x 128. Measured on 2 cores of AMD Zen 5 (1 MiB of
/// L2 each, 32 MiB of L3): 6 to 24 MiB run alike, all tiles at once 10 to 15 % slower; on an Intel with 2 MiB
/// of L2: 12 and 24 alike, 6 and all at once 20 % slower, 1.5 and 3, which would fit L2, 50 to 70 % slower.
constexpr int64_t kCacheBytes = 16 << 20;

int64_t ceil_div(int64_t a, int64_t b) { return (a + b - 1) / b; }
int32_t i32(int64_t value) { return static_cast<int32_t>(value); }

}  // namespace

WinogradChunks winograd_chunks(WinogradTile tile, int64_t images, int64_t h, int64_t w, int64_t width,
                               int64_t channels4, int64_t most_tiles) {
  const auto made = static_cast<int64_t>(tile);
  WinogradChunks chunks{.made = made,
                        .images = images,
                        .rows = ceil_div(h, made),
                        .columns = ceil_div(w, made),
                        .width = width,
                        .chunk_blocks = 1};
  const auto block_bytes = static_cast<int64_t>(chunks.bytes(channels4));
  const int64_t most = std::max<int64_t>(1, std::min(kCacheBytes / block_bytes, most_tiles / width));
  // Chunks of equal size, so that none is too short to share among threads.
  const int64_t count = ceil_div(chunks.blocks(), most);
  chunks.chunk_blocks = ceil_div(chunks.blocks(), count);
  return chunks;
}

void record_winograd_transform(Recorder& recorder, const char* shader, const WinogradChunks& chunks,
                               int64_t first_block, int64_t blocks, const TiledTensor& tensor,
                               std::initializer_list<Slice> bindings, bool has_bias,
                               const std::vector<uint32_t>& constants) {
  const int64_t first = first_block * chunks.width;
  const Caps& caps = recorder.caps();
  const int64_t local =
      std::min<int64_t>(chunks.width, caps.row_stores ? caps.subgroup_size : caps.flat_workgroup());
  const WinogradPush push{.images = i32(chunks.images),
                          .channels4 = i32(blocks4(tensor.channels)),
                          .h = i32(tensor.h),
                          .w = i32(tensor.w),
                          .rows = i32(chunks.rows),
                          .columns = i32(chunks.columns),
                          .first_image = i32(first / (chunks.rows * chunks.columns)),
                          .first_row = i32(first / chunks.columns % chunks.rows),
                          .first_column = i32(first % chunks.columns),
                          .width = i32(chunks.width),
                          .offset = i32(tensor.offset),
                          .channels = i32(tensor.channels),
                          .has_bias = has_bias ? 1 : 0};
  std::vector<uint32_t> all{static_cast<uint32_t>(local)};
  all.insert(all.end(), constants.begin(), constants.end());
  recorder.dispatch(std::string(shader) + (chunks.made == 4 ? ".f4" : ".f2"), all, bindings, push,
                    {static_cast<uint32_t>(blocks4(tensor.channels)),
                     static_cast<uint32_t>(chunks.width / local), static_cast<uint32_t>(blocks)});
}

}  // namespace vkopple
