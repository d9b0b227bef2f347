"""How much this process grows by a training step: peak afterwards less what it had before the model was built. One JSON object.

    python measure_memory.py --preset full --batch 20 --threads 2
"""
import argparse
import json

import torch

import opple


def resident(field):
    """Bytes: VmRSS now, VmHWM at most so far."""
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith(field))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", choices=sorted(opple.PRESETS), default="full")
    parser.add_argument("--batch", type=int, default=20)
    parser.add_argument("--threads", type=int, required=True)
    a = parser.parse_args()
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    cfg = opple.PRESETS[a.preset]
    images = [torch.rand(a.batch, 3, cfg.height, cfg.width) for _ in range(3)]
    poses = [torch.tensor([[0.05 * i, 0.02 * i, 0.7, 0.03 * i, 0, 0]]).expand(a.batch, 6) for i in range(3)]
    before = resident("VmRSS")
    model = opple.Opple(cfg).train()
    optimiser = opple.adam(model)
    opple.losses(cfg, model(images, poses), images[2], torch.randperm(a.batch))["total"].backward()
    opple.clip_gradients(model)
    optimiser.step()
    print(json.dumps(dict(resident_growth_bytes=resident("VmHWM") - before, resident_before_bytes=before, torch=torch.__version__,
                          threads=torch.get_num_threads(), instructions=torch.backends.cpu.get_cpu_capability())))


if __name__ == "__main__":
    main()
