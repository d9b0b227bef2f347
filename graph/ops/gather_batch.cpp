#include "graph/ops/gather_batch.h"

#include "graph/kernels/add_scaled.h"
#include "runtime/device.h"
#include "runtime/transfer.h"

namespace vkopple {

std::vector<TensorSpec> GatherBatch::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 1 && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32,
          "takes a row-major tensor of floats");
  return {row_major(x[0].shape.with(0, x[0].shape[0] * count()))};
}

Needs GatherBatch::needs(std::span<const TensorSpec> x, const Caps&) const {
  return {.backward_scratch = aligned(x[0].bytes()), .inputs_for_backward = 0, .outputs_for_backward = 0};
}

Slice GatherBatch::own_part(const Slice& all) const {
  const uint64_t bytes = all.bytes / static_cast<uint64_t>(count());
  return all.sub(bytes * static_cast<uint64_t>(peers_ == nullptr ? 0 : peers_->rank()), bytes);
}

void GatherBatch::record_forward(Recorder& recorder, const Forward& io) const {
  if (!several(peers_)) {
    recorder.copy(io.x[0].slice, io.y[0].slice);
    return;
  }
  recorder.host_step([&device = recorder.device(), peers = peers_, own = io.x[0].slice, all = io.y[0].slice] {
    upload_values<float>(device, all, peers->gather(download_values<float>(device, own)));
  });
}

void GatherBatch::record_backward(Recorder& recorder, const Backward& io) const {
  // A part begins where it may not be bound; copies may begin anywhere.
  const Operand own{io.dx[0].spec, io.scratch.sub(0, io.dx[0].slice.bytes)};
  recorder.copy(own_part(io.dy[0].slice), own.slice);
  add_scaled(recorder, own, io.dx[0], static_cast<float>(count()), io.accumulates(0) != 0);
}

Value gather_batch(Value x, Peers* peers) {
  return several(peers) ? x.graph().apply1(std::make_shared<GatherBatch>(peers), {x}) : x;
}

}  // namespace vkopple
