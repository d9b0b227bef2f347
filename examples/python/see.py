#!/usr/bin/env python3
"""Shows images to a trained model and prints what it sees as JSON, as `vkopple infer --json` does.

    see.py MODEL IMAGE.ppm... [--save FOLDER]

MODEL is a checkpoint or the folder of a run, images are binary PPM. --save keeps mask and depth as NAME.npz.
"""

import argparse
import json
import pathlib

import numpy

import vkopple


def read_ppm(path):
    with open(path, "rb") as file:
        data = file.read()
    magic, width, height, most = data.split(maxsplit=4)[:4]
    if magic != b"P6" or most != b"255":
        raise SystemExit(f"{path}: is no binary PPM of 8 bits")
    shape = int(height), int(width), 3
    return numpy.frombuffer(data[-numpy.prod(shape):], numpy.uint8).reshape(shape)


def orientation_json(o):
    if o.rotation is None:
        return {"yaw": o.yaw, "yaw_probability": o.yaw_probability}
    return {"rotation": o.rotation.ravel().tolist()}


def as_json(path, seen):
    height, width = seen.mask.shape
    objects = [{"slot": k, "share": o.share, "location": list(o.location), "angle": o.angle, "distance": o.distance,
                **orientation_json(o)} for k, o in enumerate(seen.objects)]
    return {"image": path, "name": pathlib.Path(path).stem, "height": height, "width": width,
            "background": {"index": seen.background, "share": seen.background_share}, "objects": objects}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("images", nargs="+")
    parser.add_argument("--save", type=pathlib.Path)
    arguments = parser.parse_args()
    told = []
    with vkopple.Model(arguments.model) as model:
        for path in arguments.images:
            seen = model.see(read_ppm(path))
            told.append(as_json(path, seen))
            if arguments.save:
                arguments.save.mkdir(parents=True, exist_ok=True)
                numpy.savez(arguments.save / (pathlib.Path(path).stem + ".npz"), mask=seen.mask, depth=seen.depth)
    print(json.dumps(told, indent=2))


if __name__ == "__main__":
    main()
