"""Memory of a training step against PyTorch's: how much the process grows from before the model is built to its peak."""
from common import positive
from contest import Contest, header_lines


def add_memory(parser):
    parser.add_argument("--preset", choices=("full", "small", "tiny"), default="full")
    parser.add_argument("--batch", type=positive, default=20)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="handed to vkopple bench (an entry of its configuration); PyTorch always runs the authors' graph")


def measure(a):
    contest = Contest(a)
    model = ["--preset", a.preset, "--batch", a.batch]
    sets = [word for entry in a.set for word in ("--set", entry)]
    contest.run(["bench", "step", *model, "--repeats", 1, "--no-profile", *sets], ["measure_memory.py", *model],
                lambda r: f"{r['resident_growth_bytes'] / 2**30:.2f} GiB")
    result = contest.header(preset=a.preset, batch=a.batch, set=a.set)
    for name, runs in (("vkopple", contest.ours), ("torch", contest.theirs)):
        if runs:
            result[f"{name}_bytes"] = min(r["resident_growth_bytes"] for r in runs)
    if contest.ours:
        result["vkopple_device_bytes"] = contest.ours[0]["peak_device_bytes"]
    if contest.ours and contest.theirs:
        result["ratio"] = result["vkopple_bytes"] / result["torch_bytes"]
    return result


def table(r):
    yield f"peak growth of the process in a training step, preset {r['preset']}, batch {r['batch']}" + "".join(f", {s}" for s in r["set"])
    yield from header_lines(r)
    for name in ("vkopple", "torch"):
        if f"{name}_bytes" in r:
            yield f"{name:9}{r[f'{name}_bytes'] / 2**20:9.0f} MiB" + (
                f" ({r['vkopple_device_bytes'] / 2**20:.0f} MiB allocated on the device)" if name == "vkopple" else "")
    if "ratio" in r:
        yield f"vkopple takes {r['ratio']:.2f} times what PyTorch takes"
