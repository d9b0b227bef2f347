"""Time what one image shows: depth, masks, locations, poses and codes, in evaluation. One JSON object on standard output.

    python time_infer.py --preset full --batch 1 --steps 20 --threads 2
"""
import torch

import clock
import opple


def main():
    a = clock.read_options(__doc__, batch=1, steps=20, warm_up=3)
    cfg = opple.PRESETS[a.preset]
    model = opple.Opple(cfg).eval()
    image = torch.rand(a.batch, 3, cfg.height, cfg.width)
    with torch.no_grad():
        clock.report(lambda: model.perceive(image), a)


if __name__ == "__main__":
    main()
