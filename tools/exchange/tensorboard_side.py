"""Read a run's folder by tensorboard's own reader, and compare with its log.jsonl."""
import json
import pathlib
import struct
import sys

from tensorboard.backend.event_processing import event_accumulator

STEPS_OF_A_POINT = 10


def require(condition, what):
    if not condition:
        sys.exit(f"tensorboard_side.py: {what}")


def points(lines):
    """Step and mean losses of every ten steps that one process trained in one stage, and of what was left at its end."""
    found, part = {}, []
    for line, after in zip(lines, [*lines[1:], None]):
        part.append(line)
        if len(part) == STEPS_OF_A_POINT or after is None or after["stage"] != line["stage"]:
            found[line["step"]] = {name: sum(p["losses"][name] for p in part) / len(part) for name in line["losses"]}
            part = []
    return found


def main():
    folder = pathlib.Path(sys.argv[1])
    lines = [json.loads(line) for line in (folder / "log.jsonl").read_text().splitlines()]
    board = event_accumulator.EventAccumulator(str(folder), size_guidance={event_accumulator.SCALARS: 0, event_accumulator.IMAGES: 0})
    board.Reload()
    tags = set(board.Tags()["scalars"])
    expected = points(lines)
    compared = 0
    for name in lines[-1]["losses"]:
        got = {e.step: e.value for e in board.Scalars(f"loss/{name}")}
        require(sorted(got) == sorted(expected), f"loss/{name} has points at {sorted(got)}, not at {sorted(expected)}")
        for step, value in got.items():
            want = expected[step][name]
            require(abs(value - want) <= 1e-6 * abs(want), f"loss/{name} at step {step} is {value}, not {want}")
            compared += 1
    measured = {line["step"]: line for line in lines if "depth_r" in line}
    require(measured, "nothing was measured")
    for key in ("depth_r", "iou", "ari_fg"):
        want = {step: line[key] for step, line in measured.items() if key in line}
        got = {e.step: e.value for e in board.Scalars(f"held_out/{key}")}
        require(sorted(got) == sorted(want) and all(abs(got[s] - want[s]) <= 1e-6 for s in want), f"held_out/{key} is {got}, not {want}")
    for tag in ("learning_rate", "speed/triplets_per_second", "speed/data_share"):
        require(tag in tags, f"there is no {tag}")
    pictures = board.Images("held_out")
    require([p.step for p in pictures] == [STEPS_OF_A_POINT], f"pictures are at {[p.step for p in pictures]}")
    png = pictures[0].encoded_image_string
    size = struct.unpack(">II", png[16:24])
    require(png[:8] == b"\x89PNG\r\n\x1a\n" and size == (pictures[0].width, pictures[0].height), "the picture is no PNG of its size")
    print(f"{len(tags)} curves; {compared} points of losses are those of the log, none is of an abandoned step; a picture of {size[0]} x {size[1]}")


main()
