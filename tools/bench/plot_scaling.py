"""Draw what tools/bench-scaling measured.

    python plot_scaling.py scaling.json scaling.png
"""
import json
import os
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

AXES = {"batch": "triplets in a batch", "size": "height and width, pixels", "slots": "object slots"}
COLOURS = {"small": "#0072b2", "full": "#d55e00"}


def curve(points, preset, axis):
    chosen = [p for p in points if p["point"]["preset"] == preset and p["point"]["axis"] == axis]
    return [p["point"][axis] for p in chosen], [p["seconds_per_triplet"] for p in chosen], chosen


def draw(result, panel, axis):
    # Dotted: the time of the curve's first point, were it to grow as the work does.
    for preset, colour in COLOURS.items():
        x, y, chosen = curve(result["points"], preset, axis)
        if not x:
            continue
        held = "" if axis == "batch" else f", batch {chosen[0]['point']['batch']}"
        panel.plot(x, y, "o-", color=colour, label=preset + held, markersize=4)
        work = [p["gflop_per_triplet"] / chosen[0]["gflop_per_triplet"] * y[0] for p in chosen]
        if axis != "batch":
            panel.plot(x, work, ":", color=colour, linewidth=1)
    panel.set_yscale("log")
    if axis == "size":
        panel.set_xscale("log")
    ticks = sorted({p["point"][axis] for p in result["points"] if p["point"]["axis"] == axis})
    panel.set_xticks(ticks, [str(t) for t in ticks])
    panel.minorticks_off()
    panel.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    low, high = panel.get_ylim()
    steps = (1, 2, 5) if high / low > 8 else (1, 1.5, 2, 3, 4, 5, 6, 8)
    panel.set_yticks([m * 10.0**e for e in range(-4, 3) for m in steps if low <= m * 10.0**e <= high])
    panel.set_ylim(low, high)
    panel.grid(color="0.9")
    panel.set_xlabel(AXES[axis])
    panel.legend(frameon=False)


def main():
    source, target = map(pathlib.Path, sys.argv[1:])
    result = json.loads(source.read_text())
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    axes = [a for a in AXES if any(p["point"]["axis"] == a for p in result["points"])]
    figure, panels = plt.subplots(1, len(axes), figsize=(3.6 * len(axes), 3.4), squeeze=False, layout="constrained")
    for axis, panel in zip(axes, panels[0]):
        draw(result, panel, axis)
    panels[0][0].set_ylabel("seconds a triplet")
    figure.suptitle(f"Training step on {result['device']}, {result['driver']}; {result['cpu']}, {result['threads']} threads\n"
                    "dotted: in proportion to the work", fontsize=9)
    temporary = target.with_name(f".{os.getpid()}-{target.name}")
    figure.savefig(temporary, dpi=120, format="png")
    temporary.replace(target)


if __name__ == "__main__":
    main()
