"""Time what one image shows: depth, masks, locations, poses and codes, in evaluation. One JSON object on standard output.

    python time_infer.py --preset full --batch 1 --steps 20 --threads 2
"""
import argparse
import json
import statistics
import time

import torch
from torch.utils.flop_counter import FlopCounterMode

import opple


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", choices=sorted(opple.PRESETS), default="full")
    parser.add_argument("--batch", type=int, default=1)
    parser.add_argument("--steps", type=int, default=20, help="timed runs")
    parser.add_argument("--warm-up", type=int, default=3, help="runs before the clock starts, at least 1")
    parser.add_argument("--threads", type=int, required=True)
    a = parser.parse_args()
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    cfg = opple.PRESETS[a.preset]
    model = opple.Opple(cfg).eval()
    image = torch.rand(a.batch, 3, cfg.height, cfg.width)

    def see():
        start = time.perf_counter()
        model.perceive(image)
        return time.perf_counter() - start

    with torch.no_grad():
        with FlopCounterMode(display=False) as counter:
            see()
        for _ in range(a.warm_up - 1):
            see()
        seconds = [see() for _ in range(a.steps)]
    print(json.dumps(dict(seconds_per_step=statistics.median(seconds), best_seconds=min(seconds), torch=torch.__version__,
                          threads=torch.get_num_threads(), gflop_per_triplet=counter.get_total_flops() / a.batch / 1e9,
                          instructions=torch.backends.cpu.get_cpu_capability())))


if __name__ == "__main__":
    main()
