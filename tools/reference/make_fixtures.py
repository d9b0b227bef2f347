"""Write a parity fixture: weights, inputs, every stage, losses, gradients and a short training run.

    python make_fixtures.py OUT.safetensors [--seed 0] [--batch 6] [--mode train|eval] [--set height=32 ...]

Those in tests/fixtures, rigid, train, euler and odd:
    python make_fixtures.py OUT --seed 20 --batch 4 --mode eval --set height=32 width=32 depth_width=2 object_width=4 imagine_width=1 lstm=16
    python make_fixtures.py OUT --seed 17 --batch 8 --mode train --set height=32 width=32 depth_width=2 object_width=4 imagine_width=2 lstm=16
    python make_fixtures.py OUT --seed 20 --batch 3 --mode eval --tilt 0.1 --set height=22 width=36 fov=1.3 slots=2 orientation='"euler"' depth_width=1 object_width=2 imagine_width=1 lstm=8
    python make_fixtures.py OUT --seed 22 --batch 3 --mode eval --set height=36 width=22 fov=1.3 slots=4 bins=72 smoothness=0.1 pose_contrast=0.5 depth_width=1 object_width=2 imagine_width=1 lstm=8

All values are computed in float64 and stored as float32. `noise/<tensor>` is the relative L2 error that PyTorch's own
float32 makes on that tensor: an implementation is right when its error is within a small factor of it
(max(1e-4, 5 x noise); where the exact value is zero and noise is huge, an absolute bound).
Tensors: param/, buffer/ (before), input/, out/, loss/, grad/, buffer_after/, trajectory/, noise/.
The pose of a camera is x, y, z, yaw, pitch, roll. Dropout is off. metadata.config is the configuration as JSON, metadata.mode
says which statistics batch norm used. Step s of the trajectory takes scene (i - s) mod B as its scene i, without the last one,
and pairs them for the collapse term by a roll by one.
"""
import argparse
import dataclasses
import json

import torch
from safetensors.torch import save_file

import opple
import rooms


def scramble(model, generator):
    """Weights as a few training steps would leave them: nothing at zero or one."""
    for name, p in model.named_parameters():
        noise = torch.randn(p.shape, generator=generator, dtype=torch.float64)
        if p.dim() > 1:
            fan = p[0].numel() if "up." not in name or p.dim() == 2 else p.shape[0] * p[0, 0].numel() // 4
            p.data = noise * (1.4 / fan ** 0.5)
        else:
            p.data = 0.1 * noise + (1.0 if name.endswith("weight") else 0.0)
    for name, b in model.named_buffers():
        if name.endswith("running_mean"):
            b.data = 0.1 * torch.randn(b.shape, generator=generator, dtype=torch.float64)
        if name.endswith("running_var"):
            b.data = 0.5 + torch.rand(b.shape, generator=generator, dtype=torch.float64)


def run(state, cfg, images, poses, permutation, mode, dtype):
    model = opple.Opple(cfg).to(dtype)
    model.load_state_dict(state)
    model.to(dtype).train(mode == "train")
    images, poses = [x.to(dtype) for x in images], [x.to(dtype) for x in poses]
    out = model(images, poses)
    terms = opple.losses(cfg, out, images[2], permutation)
    terms["total"].backward()
    result = {}
    for k, v in out.items():
        flat = {f"{k}.{n}": t for n, t in v.items()} if isinstance(v, dict) else {k: v}
        result.update({f"out/{n}": t.detach() for n, t in flat.items()})
    result.update({f"loss/{k}": v.detach().reshape(1) for k, v in terms.items()})
    result.update({f"grad/{opple.authors_name(n)}": p.grad for n, p in model.named_parameters()})
    if mode == "train":
        result.update({f"buffer_after/{opple.authors_name(n)}": b for n, b in model.named_buffers() if "running" in n})
    return result


def trajectory(state, cfg, images, poses, permutation, dtype, steps=12):
    """Total loss before each Adam step, rotating the batch by one scene a step."""
    model = opple.Opple(cfg).to(dtype)
    model.load_state_dict(state)
    model.to(dtype).train()
    images, poses = [x.to(dtype) for x in images], [x.to(dtype) for x in poses]
    optimiser = opple.adam(model)
    total = []
    for step in range(steps):
        roll = lambda x: x.roll(step, 0)[: len(x) - 1]
        im, po = [roll(x) for x in images], [roll(x) for x in poses]
        shift = torch.arange(len(im[0])).roll(1)
        optimiser.zero_grad()
        loss = opple.losses(cfg, model(im, po), im[2], shift)["total"]
        loss.backward()
        opple.clip_gradients(model)
        optimiser.step()
        total.append(loss.detach())
    return {"trajectory/total": torch.stack(total)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--batch", type=int, default=6)
    parser.add_argument("--mode", choices=("train", "eval"), default="train")
    parser.add_argument("--tilt", type=float, default=0, help="of the camera, beyond what the images show: the deviation of "
                        "pitch and roll in radians")
    parser.add_argument("--set", nargs="*", default=[], metavar="FIELD=VALUE", help="of Config")
    a = parser.parse_args()
    fields = {k: json.loads(v) for k, v in (f.split("=") for f in a.set)}
    cfg = dataclasses.replace(opple.Config(dropout=(0, 0, 0)), **fields)
    g = torch.Generator().manual_seed(a.seed)
    images, poses, depth, label = rooms.triplets(a.batch, cfg.height, cfg.width, a.seed)
    for pose in poses if a.tilt else []:
        pose[:, 4:] += a.tilt * torch.randn(a.batch, 2, generator=g, dtype=pose.dtype)
    permutation = torch.randperm(a.batch, generator=g)
    model = opple.Opple(cfg).double()
    scramble(model, g)
    model.float().double()                                   # both precisions start from the same float32 weights
    state = {k: v.clone() for k, v in model.state_dict().items()}
    exact = run(state, cfg, images, poses, permutation, a.mode, torch.float64)
    single = run(state, cfg, images, poses, permutation, a.mode, torch.float32)
    if a.mode == "train":
        exact.update(trajectory(state, cfg, images, poses, permutation, torch.float64))
        single.update(trajectory(state, cfg, images, poses, permutation, torch.float32))
    tensors = {f"noise/{k}": ((single[k].double() - v).norm() / (v.norm() + 1e-30)).reshape(1) for k, v in exact.items()}
    tensors.update(exact)
    tensors.update({f"param/{opple.authors_name(k)}": p.data for k, p in model.named_parameters()})
    tensors.update({f"buffer/{opple.authors_name(k)}": b for k, b in model.named_buffers() if "running" in k})
    tensors.update({f"input/image{i + 1}": x for i, x in enumerate(images)})
    tensors.update({f"input/pose{i + 1}": x for i, x in enumerate(poses)})
    tensors = {k: v.detach().float().contiguous() for k, v in tensors.items()}
    tensors["input/permutation"] = permutation.int()
    tensors["input/label2"] = label.int()
    tensors["input/depth2"] = depth
    save_file(tensors, a.out, metadata={"config": json.dumps(dataclasses.asdict(cfg)), "mode": a.mode})
    worst = sorted(((float(v), k) for k, v in tensors.items() if k.startswith("noise/")), reverse=True)
    print(a.out, "noise: worst", worst[:4], "median", worst[len(worst) // 2][0])


if __name__ == "__main__":
    main()
