"""PyTorch's part of tools/test-exchange: makes random models and holds what vkopple wrote against them. A model is named by a
preset or the file of a configuration.

    python torch_side.py make small foreign.pt
    python torch_side.py check small foreign.pt back.pt back.safetensors example.safetensors expected.safetensors
"""
import json
import pathlib
import sys

import safetensors.numpy
import safetensors.torch
import torch

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "reference"))
import comparison
import opple

WHAT_IMAGES_SHOW = ("depth", "masks", "location", "log_pose")


def configuration(name):
    return opple.PRESETS[name] if name in opple.PRESETS else opple.Config(**json.loads(pathlib.Path(name).read_text())["model"])


def random_model(name):
    """Weights as they start; running averages and batch norms' weights unlike those at the start."""
    torch.manual_seed(1)
    model = opple.Opple(configuration(name)).eval()
    for module in model.modules():
        if not isinstance(module, torch.nn.BatchNorm2d):
            continue
        module.running_mean.normal_(0, 0.2)
        module.running_var.uniform_(0.2, 0.8)
        module.num_batches_tracked.fill_(7)
        torch.nn.init.uniform_(module.weight, 0.8, 1.4)
        torch.nn.init.normal_(module.bias, 0, 0.1)
    return model


def authors_state(model):
    """The state dict by the names of the authors' checkpoints, without what is computed from the configuration."""
    return {opple.authors_name(name): value for name, value in model.state_dict().items() if not name.startswith("pose.")}


def memory(tensor):
    """The bytes themselves: NaN is then like itself, and 0 unlike -0."""
    return tensor.contiguous().reshape(-1).view(torch.uint8).numpy().tobytes()


def same_bits(what, wanted, actual):
    if wanted.keys() != actual.keys():
        sys.exit(f"{what}: other tensors: {sorted(wanted.keys() ^ actual.keys())[:5]}")
    for name, tensor in wanted.items():
        if actual[name].dtype != tensor.dtype or actual[name].shape != tensor.shape or memory(actual[name]) != memory(tensor):
            sys.exit(f"{what}: {name} is not bit for bit the same")


def make(name, foreign):
    torch.save(authors_state(random_model(name)), foreign)


def check(name, foreign, back_pt, back_safetensors, example, expected):
    wanted = torch.load(foreign, weights_only=True)
    back = torch.load(back_pt, weights_only=True)
    same_bits(back_pt, wanted, back)
    same_bits(back_safetensors, wanted, safetensors.torch.load_file(back_safetensors))
    model = opple.Opple(configuration(name)).eval()
    names = {opple.authors_name(name): name for name in model.state_dict()}
    model.load_state_dict({**model.state_dict(), **{names[name]: value for name, value in back.items()}}, strict=True)
    shown = safetensors.numpy.load_file(example)
    with torch.no_grad():
        seen = model.perceive(torch.from_numpy(shown["images"]))
    seen = {name: value.numpy() for name, value in seen.items() if name in (*WHAT_IMAGES_SHOW, "code")}
    seen["depth"] = seen["depth"][:, None]
    safetensors.numpy.save_file({name: value.copy() for name, value in seen.items()}, expected)
    comparison.report(comparison.compare("vkopple against PyTorch", {name: seen[name] for name in WHAT_IMAGES_SHOW}, shown))


if __name__ == "__main__":
    {"make": make, "check": check}[sys.argv[1]](*sys.argv[2:])
