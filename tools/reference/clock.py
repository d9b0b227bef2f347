"""What time_step.py and time_infer.py share: options, the clock, and the JSON object that they print."""
import argparse
import json
import statistics
import time

import torch
from torch.utils.flop_counter import FlopCounterMode

import opple


def read_options(description, batch, steps, warm_up):
    """Parses the command line, whose defaults are given, and sets up PyTorch's threads and seed."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", choices=sorted(opple.PRESETS), default="full")
    parser.add_argument("--batch", type=int, default=batch)
    parser.add_argument("--steps", type=int, default=steps, help="timed runs")
    parser.add_argument("--warm-up", type=int, default=warm_up, help="runs before the clock starts, at least 1")
    parser.add_argument("--threads", type=int, required=True)
    a = parser.parse_args()
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    return a


def report(run, a, **more):
    """Times run() and prints seconds, operations (of convolutions and products, not the LSTM: 0.03 %) and `more`."""
    def seconds_of_one():
        start = time.perf_counter()
        run()
        return time.perf_counter() - start

    with FlopCounterMode(display=False) as counter:
        run()
    for _ in range(a.warm_up - 1):
        run()
    seconds = [seconds_of_one() for _ in range(a.steps)]
    print(json.dumps(dict(seconds_per_step=statistics.median(seconds), best_seconds=min(seconds), torch=torch.__version__,
                          threads=torch.get_num_threads(), gflop_per_triplet=counter.get_total_flops() / a.batch / 1e9,
                          instructions=torch.backends.cpu.get_cpu_capability(), **more)))
