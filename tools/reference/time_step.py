"""Time full training steps: forward, losses, backward, clipping, Adam; dropout on. One JSON object on standard output.

    python time_step.py --preset full --batch 4 --steps 5 --warm-up 2 --threads 2
"""
import torch

import clock
import opple
import rooms


def main():
    a = clock.read_options(__doc__, batch=4, steps=5, warm_up=2)
    cfg = opple.PRESETS[a.preset]
    model = opple.Opple(cfg).train()
    images, poses, _, _ = rooms.triplets(a.batch, cfg.height, cfg.width, seed=0)
    optimiser = opple.adam(model)

    def step():
        optimiser.zero_grad()
        opple.losses(cfg, model(images, poses), images[2], torch.randperm(a.batch))["total"].backward()
        opple.clip_gradients(model)
        optimiser.step()

    parameters = {n: sum(p.numel() for p in getattr(model, n).parameters()) for n in ("depth_net", "object_net", "imagine_net")}
    clock.report(step, a, parameters=parameters, total_parameters=sum(parameters.values()))


if __name__ == "__main__":
    main()
