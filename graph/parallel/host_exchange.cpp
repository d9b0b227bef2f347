#include "graph/parallel/host_exchange.h"

#include <utility>
#include <vector>

#include "runtime/device.h"
#include "runtime/transfer.h"

namespace vkopple {

void record_change(Recorder& recorder, const Slice& floats, std::function<void(std::span<float>)> change) {
  recorder.host_step([&device = recorder.device(), floats, change = std::move(change)] {
    std::vector<float> values = download_values<float>(device, floats);
    change(values);
    upload_values<float>(device, floats, values);
  });
}

}  // namespace vkopple
