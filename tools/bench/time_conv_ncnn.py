"""Time 3x3 and 1x1 convolutions of stride 1, as many channels in as out, on ncnn's Vulkan backend. One JSON object on standard output.

    LP_NUM_THREADS=2 OPENBLAS_NUM_THREADS=1 python time_conv_ncnn.py --shapes '[{"kernel": 3, "in_channels": 64, "size": 128}]'

Storage, packing and arithmetic are float32. ncnn's Python bindings hand over and return images in the host's memory only, so the
time of a convolution without transfers is that of a chain of them less that of a shorter chain, divided by the difference in length.
ncnn's own work has one thread, the main one, so that the CPU time of all others is that of a Vulkan driver for CPUs: their share
shows that the work was done there.
"""
import argparse
import json
import pathlib
import tempfile
import time

import ncnn
import numpy

SHORT, LONG = 1, 5


def network(folder, shape, weights, bias, length):
    """A chain of `length` equal convolutions, without anything between them."""
    k, c = shape["kernel"], shape["in_channels"]
    lines = ["7767517", f"{length + 1} {length + 1}", "Input in 0 1 b0"]
    for i in range(length):
        lines.append(f"Convolution c{i} 1 1 b{i} b{i + 1} 0={c} 1={k} 3=1 4={k // 2} 5=1 6={weights.size}")
    (folder / "net.param").write_text("\n".join(lines) + "\n")
    # A zero tag says that float32 follows.
    (folder / "net.bin").write_bytes((bytes(4) + weights.tobytes() + bias.tobytes()) * length)
    net = ncnn.Net()
    net.opt.use_vulkan_compute = True
    net.opt.num_threads = 1
    for flag in ("fp16_packed", "fp16_storage", "fp16_arithmetic", "bf16_storage", "bf16_packed", "int8_inference"):
        setattr(net.opt, f"use_{flag}", False)
    if net.load_param(str(folder / "net.param")) != 0 or net.load_model(str(folder / "net.bin")) != 0:
        raise SystemExit("time_conv_ncnn.py: ncnn can't load the network")
    return net


def run(net, image, length):
    with net.create_extractor() as extractor:
        extractor.input("b0", image)
        result, out = extractor.extract(f"b{length}")
    if result != 0:
        raise SystemExit(f"time_conv_ncnn.py: ncnn failed with {result}")
    return out


class Clock:
    """Times work, and counts the CPU time that it took in the main thread and in all."""

    def __init__(self):
        self.main = self.all = 0.0

    def best(self, work, steps):
        work()
        least = float("inf")
        for _ in range(steps):
            start, cpu, main = time.perf_counter(), time.process_time(), time.thread_time()
            work()
            least = min(least, time.perf_counter() - start)
            self.all += time.process_time() - cpu
            self.main += time.thread_time() - main
        return least


def direct(x, w, bias):
    """The convolution in double precision."""
    k = w.shape[2]
    padded = numpy.pad(x.astype(float), ((0, 0), (k // 2, k // 2), (k // 2, k // 2)))
    y = numpy.zeros((w.shape[0], *x.shape[1:])) + bias[:, None, None]
    for dy in range(k):
        for dx in range(k):
            part = padded[:, dy:dy + x.shape[1], dx:dx + x.shape[2]]
            y += numpy.tensordot(w[:, :, dy, dx].astype(float), part, 1)
    return y


def measure(shape, steps, clock):
    k, c, size = shape["kernel"], shape["in_channels"], shape["size"]
    random = numpy.random.default_rng(0)
    x = random.random((c, size, size), dtype=numpy.float32)
    weights = random.random((c, c, k, k), dtype=numpy.float32) / (c * k * k)
    bias = random.random(c, dtype=numpy.float32)
    gflop = 2e-9 * c * c * k * k * size * size
    seconds = {}
    for length in (SHORT, LONG):
        with tempfile.TemporaryDirectory() as folder:
            net = network(pathlib.Path(folder), shape, weights, bias, length)
        image = ncnn.Mat(x)
        if length == 1:
            error = numpy.abs(numpy.array(run(net, image, 1)) - direct(x, weights, bias)).max()
            if not error <= 1e-4:
                raise SystemExit(f"time_conv_ncnn.py: ncnn's result is off by {error}")
        seconds[length] = clock.best(lambda: run(net, image, length), steps)
        net.clear()
    chained = (seconds[LONG] - seconds[SHORT]) / (LONG - SHORT)
    return dict(shape, with_transfers_gflops=gflop / seconds[SHORT], chained_gflops=gflop / chained)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=json.loads, required=True, help="JSON, as in the example")
    parser.add_argument("--steps", type=int, default=5, help="timed runs of each, of which the best counts")
    a = parser.parse_args()
    if ncnn.get_gpu_count() == 0:
        raise SystemExit("time_conv_ncnn.py: ncnn finds no Vulkan device")
    device = ncnn.get_gpu_info(ncnn.get_default_gpu_index())
    clock = Clock()
    convolutions = [measure(shape, a.steps, clock) for shape in a.shapes]
    print(json.dumps(dict(convolutions=convolutions, ncnn=ncnn.__version__, device=device.device_name(),
                          driver_share=1 - clock.main / clock.all)))
    ncnn.destroy_gpu_instance()


if __name__ == "__main__":
    main()
