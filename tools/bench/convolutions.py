"""Convolutions and their gradients against PyTorch, and forward against ncnn's Vulkan backend."""
import json

from common import BENCH, Failure, environment_python, positive, require_vkopple, run_json, run_vkopple, say
from contest import Contest, header, header_lines

PRODUCTS = ("forward", "data_gradient", "weight_gradient")


def add_conv(parser):
    parser.add_argument("--batch", type=positive, help="4 if not given; 1 with --ncnn")
    parser.add_argument("--steps", type=positive, default=5, help="timed runs of every product in a round, of which the best counts")
    parser.add_argument("--ncnn", action="store_true", help="compare forward with ncnn's Vulkan backend on the same device, not with PyTorch")


def best(runs):
    """The largest rate of every product of every shape over several runs of vkopple or PyTorch."""
    shapes = [dict(c) for c in runs[0]["convolutions"]]
    for shape, *others in zip(shapes, *(r["convolutions"] for r in runs)):
        for product in PRODUCTS:
            shape[f"{product}_gflops"] = max(o[f"{product}_gflops"] for o in others)
    return shapes


def geometry(convolutions):
    return json.dumps([{k: c[k] for k in ("transposed", "kernel", "stride", "batch", "in_channels", "size", "out_channels")} for c in convolutions])


def measure(a):
    if not a.ncnn:
        return measure_torch(a, a.batch or 4)
    if a.only or (a.batch or 1) != 1:
        raise Failure("--ncnn compares single images (batch 1) of both programs: leave out --only and --batch")
    return measure_ncnn(a)


def measure_torch(a, batch):
    require_vkopple(a.vkopple)
    contest = Contest(a)
    shapes = geometry(run_vkopple(a, "bench", "conv", "--batch", batch, "--repeats", 1)["convolutions"])
    contest.run(["bench", "conv", "--batch", batch, "--repeats", a.steps], ["time_conv.py", "--shapes", shapes, "--steps", a.steps],
                lambda r: f"{r['convolutions'][0]['forward_gflops']:.0f} GFLOP/s")
    result = contest.header(batch=batch, convolutions=[])
    runs = {name: best(r) for name, r in (("vkopple", contest.ours), ("torch", contest.theirs)) if r}
    for i, shape in enumerate(next(iter(runs.values()))):
        entry = {k: v for k, v in shape.items() if not k.endswith("_gflops")}
        for name, shapes in runs.items():
            entry[name] = {p: shapes[i][f"{p}_gflops"] for p in PRODUCTS}
        if len(runs) == 2:
            entry["speed"] = {p: entry["vkopple"][p] / entry["torch"][p] for p in PRODUCTS}
        result["convolutions"].append(entry)
    return result


def measure_ncnn(a):
    require_vkopple(a.vkopple)
    python = environment_python(a.venv, BENCH / "requirements-ncnn.txt")
    ours, theirs = [], []
    for number in range(a.rounds):
        ours.append(run_vkopple(a, "bench", "conv", "--batch", 1, "--repeats", a.steps))
        shapes = [c for c in ours[0]["convolutions"] if not c["transposed"] and c["stride"] == 1 and c["in_channels"] == c["out_channels"]]
        theirs.append(run_json([python, "-B", BENCH / "time_conv_ncnn.py", "--shapes", geometry(shapes), "--steps", a.steps],
                               {"LP_NUM_THREADS": str(a.threads), "OPENBLAS_NUM_THREADS": "1"}))
        say(f"round {number + 1} of {a.rounds}: vkopple {ours[-1]['convolutions'][0]['forward_gflops']:.0f} GFLOP/s, "
            f"ncnn {theirs[-1]['convolutions'][0]['chained_gflops']:.1f} GFLOP/s")
    result = header(a, ours, [], batch=1, ncnn=theirs[0]["ncnn"], ncnn_device=theirs[0]["device"],
                    ncnn_driver_share=min(r["driver_share"] for r in theirs), convolutions=[])
    forward = {c["shape"]: c["forward_gflops"] for c in best(ours)}
    for i, shape in enumerate(shapes):
        entry = {k: v for k, v in shape.items() if not k.endswith("_gflops")}
        entry["vkopple"] = forward[shape["shape"]]
        for way in ("chained", "with_transfers"):
            entry[f"ncnn_{way}"] = max(r["convolutions"][i][f"{way}_gflops"] for r in theirs)
        entry["speed"] = entry["vkopple"] / entry["ncnn_chained"]
        result["convolutions"].append(entry)
    return result


def table(r):
    yield from header_lines(r)
    if "ncnn" in r:
        yield from ncnn_table(r)
        return
    names = [n for n in ("vkopple", "torch", "speed") if n in r["convolutions"][0]]
    yield "GFLOP/s" + (" and vkopple's over PyTorch's" if "speed" in names else "")
    yield f"{'N,Ci,H,W -> Co':<42}" + "".join(f"{p.replace('_', ' '):>{8 * len(names)}}" for p in PRODUCTS)
    yield " " * 42 + "".join(f"{n:>8}" for _ in PRODUCTS for n in names)
    for c in r["convolutions"]:
        yield f"{c['shape']:<42}" + "".join(f"{c[n][p]:8.2f}" if n == "speed" else f"{c[n][p]:8.1f}" for p in PRODUCTS for n in names)


def ncnn_table(r):
    yield f"ncnn     {r['ncnn']} on {r['ncnn_device']}, float32; {100 * r['ncnn_driver_share']:.0f} % of its CPU time in the driver's threads"
    yield f"{'forward, GFLOP/s':<42}{'vkopple':>9}{'ncnn':>9}{'with transfers':>16}{'vkopple / ncnn':>16}"
    for c in r["convolutions"]:
        yield f"{c['shape']:<42}{c['vkopple']:9.1f}{c['ncnn_chained']:9.1f}{c['ncnn_with_transfers']:16.1f}{c['speed']:16.1f}"
