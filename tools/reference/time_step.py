"""Time full training steps: forward, losses, backward, clipping, Adam; dropout on. One JSON object on standard output.

    python time_step.py --preset full --batch 4 --steps 5 --warm-up 2 --threads 2
"""
import argparse
import json
import statistics
import time

import torch
from torch.utils.flop_counter import FlopCounterMode

import opple
import rooms


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", choices=sorted(opple.PRESETS), default="full")
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--steps", type=int, default=5, help="timed steps")
    parser.add_argument("--warm-up", type=int, default=2, help="steps before the clock starts, at least 1")
    parser.add_argument("--threads", type=int, required=True)
    a = parser.parse_args()
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    cfg = opple.PRESETS[a.preset]
    model = opple.Opple(cfg).train()
    images, poses, _, _ = rooms.triplets(a.batch, cfg.height, cfg.width, seed=0)
    optimiser = opple.adam(model)

    def step():
        start = time.perf_counter()
        optimiser.zero_grad()
        opple.losses(cfg, model(images, poses), images[2], torch.randperm(a.batch))["total"].backward()
        opple.clip_gradients(model)
        optimiser.step()
        return time.perf_counter() - start

    with FlopCounterMode(display=False) as counter:        # counts convolutions and products, not the LSTM (0.03 %)
        step()
    for _ in range(a.warm_up - 1):
        step()
    seconds = [step() for _ in range(a.steps)]
    parameters = {n: sum(p.numel() for p in getattr(model, n).parameters()) for n in ("depth_net", "object_net", "imagine_net")}
    print(json.dumps(dict(seconds_per_step=statistics.median(seconds), best_seconds=min(seconds), torch=torch.__version__,
                          threads=torch.get_num_threads(), parameters=parameters, total_parameters=sum(parameters.values()),
                          gflop_per_triplet=counter.get_total_flops() / a.batch / 1e9,
                          instructions=torch.backends.cpu.get_cpu_capability())))


if __name__ == "__main__":
    main()
