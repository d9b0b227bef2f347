#pragma once

namespace vkopple {

class Device;

/// GFLOP/s of fused multiply-adds in float32 that the device reaches where nothing waits for memory, a multiply
/// and an add counting one each: what a kernel's speed is a share of. Best of several runs; takes a fraction of
/// a second.
double measure_peak_gflops(const Device& device);

}  // namespace vkopple
