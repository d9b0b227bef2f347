"""Time single convolutions, forward and both gradients (the weights' with the bias's). One JSON object on standard output.

    python time_conv.py --threads 2 --shapes '[{"transposed": false, "kernel": 3, "stride": 1, "batch": 4, "in_channels": 64,
        "size": 128, "out_channels": 64}]'

Rates count a multiply and an add as one operation each, of the direct sum, whatever algorithm runs.
"""
import argparse
import json
import time

import torch
from torch.nn import functional as F


def best(work, steps):
    work()
    least = float("inf")
    for _ in range(steps):
        start = time.perf_counter()
        work()
        least = min(least, time.perf_counter() - start)
    return least


def measure(shape, steps):
    k, stride, ci, co = (shape[n] for n in ("kernel", "stride", "in_channels", "out_channels"))
    transposed = shape["transposed"]
    padding = 0 if k == 2 else k // 2
    output_padding = 1 if transposed and k == 3 else 0
    x = torch.rand(shape["batch"], ci, shape["size"], shape["size"])
    w = torch.rand(*((ci, co) if transposed else (co, ci)), k, k) / (ci * k * k)
    b = torch.rand(co)
    if transposed:
        forward = lambda: F.conv_transpose2d(x, w, b, stride=stride, padding=padding, output_padding=output_padding)
    else:
        forward = lambda: F.conv2d(x, w, b, stride=stride, padding=padding)
    y = forward()
    dy = torch.rand_like(y)

    def backward(wanted):
        return torch.ops.aten.convolution_backward(dy, x, w, [co], [stride] * 2, [padding] * 2, [1, 1], transposed,
                                                   [output_padding] * 2, 1, wanted)

    positions = x.shape[2] * x.shape[3] if transposed else y.shape[2] * y.shape[3]
    gflop = 2e-9 * shape["batch"] * ci * co * k * k * positions
    return dict(shape, forward_gflops=gflop / best(forward, steps),
                data_gradient_gflops=gflop / best(lambda: backward([True, False, False]), steps),
                weight_gradient_gflops=gflop / best(lambda: backward([False, True, True]), steps))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=json.loads, required=True, help="JSON, as in the example")
    parser.add_argument("--steps", type=int, default=5, help="timed runs of each product, of which the best counts")
    parser.add_argument("--threads", type=int, required=True)
    a = parser.parse_args()
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    with torch.no_grad():
        convolutions = [measure(shape, a.steps) for shape in a.shapes]
    print(json.dumps(dict(convolutions=convolutions, torch=torch.__version__, threads=torch.get_num_threads(),
                          instructions=torch.backends.cpu.get_cpu_capability())))


if __name__ == "__main__":
    main()
