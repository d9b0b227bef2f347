"""Training steps and inference against PyTorch: seconds, rates and their ratio."""
from common import positive
from contest import Contest, header_lines


def add_model_options(parser, batch, steps):
    parser.add_argument("--preset", choices=("full", "small", "tiny"), default="full")
    parser.add_argument("--batch", type=positive, default=batch)
    parser.add_argument("--steps", type=positive, default=steps, help="timed runs of each program in a round, of which the median counts")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="handed to vkopple bench (an entry of its configuration); PyTorch always runs the authors' graph")


def add_step(parser):
    add_model_options(parser, batch=4, steps=5)


def add_infer(parser):
    add_model_options(parser, batch=1, steps=20)


def measure(a):
    contest = Contest(a)
    model = ["--preset", a.preset, "--batch", a.batch]
    sets = [word for entry in a.set for word in ("--set", entry)]
    contest.run(["bench", a.what, *model, "--repeats", a.steps, *sets], [f"time_{a.what}.py", *model, "--steps", a.steps],
                lambda r: f"{r['seconds_per_step']:.4f} s")
    result = contest.header(preset=a.preset, batch=a.batch, set=a.set)
    for name, runs in (("vkopple", contest.ours), ("torch", contest.theirs)):
        if runs:
            result[name] = min(runs, key=lambda r: r["seconds_per_step"])
            result[f"{name}_seconds"] = result[name]["seconds_per_step"]
    if contest.ours and contest.theirs:
        result["ratio"] = result["vkopple_seconds"] / result["torch_seconds"]
        result["speed"] = 1 / result["ratio"]
    return result


def table(r):
    step = r["what"] == "step"
    yield f"{'training step' if step else 'single images'}, preset {r['preset']}, batch {r['batch']}" + "".join(f", {s}" for s in r["set"])
    yield from header_lines(r)
    yield f"{'':9}{'s/step' if step else 's/run':>9}{'triplets/s' if step else 'images/s':>12}{'GFLOP/s':>9}"
    for name in ("vkopple", "torch"):
        if name in r:
            seconds, gflop = r[f"{name}_seconds"], r[name].get("gflop_per_triplet")
            rate = f"{gflop * r['batch'] / seconds:9.1f}" if gflop else f"{'?':>9}"
            yield f"{name:9}{seconds:9.4f}{r['batch'] / seconds:12.2f}{rate}"
    if "ratio" in r:
        yield f"vkopple takes {r['ratio']:.2f} times what PyTorch takes: {r['speed']:.2f} times as fast"
