"""Write records-*.tfrecord: small examples in each format of TFRecord files that vkopple reads, by other hands than its own.

    python make_records.py FOLDER     (packages: requirements-records.txt)

The framing is that of the package tfrecord, the messages are protobuf's, PNG and JPEG are Pillow's. What the pictures and
numbers are is in the functions below and once more in tests/train/formats/python_records_test.cpp.
"""
import gzip
import io
import os
import struct
import sys

import numpy as np
from PIL import Image
from tfrecord import example_pb2
from tfrecord.writer import TFRecordWriter


def feature(values):
    kind = example_pb2.Feature()
    if isinstance(values[0], bytes):
        kind.bytes_list.value.extend(values)
    elif isinstance(values[0], (int, np.integer)):
        kind.int64_list.value.extend(int(v) for v in values)
    else:
        kind.float_list.value.extend(float(v) for v in values)
    return kind


def example(features):
    message = example_pb2.Example()
    for name, values in features.items():
        message.features.feature[name].CopyFrom(feature(values))
    return message.SerializeToString()


def write(path, records):
    check = TFRecordWriter.masked_crc
    with open(path, "wb") as file:
        for record in records:
            length = struct.pack("<Q", len(record))
            file.write(length + check(length) + record + check(record))


def picture(array, kind="PNG", **options):
    out = io.BytesIO()
    Image.fromarray(array).save(out, kind, **options)
    return out.getvalue()


def sequence():
    message = example_pb2.SequenceExample()
    message.context.feature["name"].CopyFrom(feature([b"film"]))
    for step in range(3):
        message.feature_lists.feature_list["place"].feature.append(feature([step + 0.5, -step - 0.25]))
    return message.SerializeToString()


def plain():
    return example({"bytes": [b"", b"\x00\xff", b"text"], "floats": [1.5, -0.1, 3e38],
                    "integers": [0, -1, 2**62, -(2**63)]})


def rotation_y(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def gqn():
    """Three frames of 8 x 8: the camera circles 4 units from the middle, 1 above the floor, looking inwards."""
    frames, masks, depths, matrices = [], [], [], []
    for i in range(3):
        image = np.full((8, 8, 3), (40 * i + 20, 100, 200), np.uint8)
        mask = np.zeros((8, 8, 3), np.uint8)
        mask[2:4, 1 + i:3 + i] = (10, 20, 30)
        mask[5:7, 4:6] = (200, 100, 50)
        depth = np.full((8, 8), 2 + i, np.float32)
        depth[0] = 0  # sky
        yaw = 0.25 + 0.5 * i
        matrix = np.eye(4)
        matrix[:3, :3] = rotation_y(yaw)
        matrix[:3, 3] = 4 * np.sin(yaw), 1, 4 * np.cos(yaw)
        frames.append(picture(image, "JPEG", quality=95))
        masks.append(picture(mask))
        depths.append(depth)
        matrices.append(matrix)
    return example({"frames": frames, "masks": masks, "depths": np.ravel(depths).astype(np.float32).tolist(),
                    "camera_matrices": np.ravel(matrices).tolist(), "camera_yaws": [0.25, 0.75, 1.25]})


def movi():
    """Three frames of 8 x 8 of two instances: the camera 8 m from the middle, 3 m up, looking at y, level."""
    level = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]  # from straight down to level
    video, masks, depth = [], [], []
    for i in range(3):
        image = np.full((8, 8, 3), (60, 50 * i, 250), np.uint8)
        mask = np.zeros((8, 8), np.uint8)
        mask[1:3, 1 + i:4 + i] = 1
        mask[6:8] = 2
        video.append(picture(image))
        masks.append(picture(mask))
        depth.append(picture((np.arange(64).reshape(8, 8) * 1000 + i).astype(np.uint16)))
    positions = [[[0.5 + i, 2, 0.25] for i in range(3)], [[-1, 4, 1]] * 3]
    turned = [np.cos(0.3), 0, 0, np.sin(0.3)]  # by 0.6 about z
    return example({"video": video, "segmentations": masks, "depth": depth, "metadata/depth_range": [2.0, 12.0],
                    "metadata/num_instances": [2], "camera/positions": np.ravel([[0.5 * i, -8, 3] for i in range(3)]).tolist(),
                    "camera/quaternions": np.ravel([level] * 3).tolist(), "camera/field_of_view": [0.85756],
                    "instances/positions": np.ravel(positions).tolist(),
                    "instances/quaternions": np.ravel([[turned] * 3, [[1, 0, 0, 0]] * 3]).tolist()})


def clevr():
    """One image, as the data set has it: a string for every byte."""
    image = np.zeros((240, 320, 3), np.uint8)
    image[..., 0] = 102
    image[100:160, 100:190] = (0, 51, 255)
    masks = np.zeros((11, 240, 320, 1), np.uint8)
    masks[0] = 255
    masks[0, 100:160, 100:190] = 0
    masks[1, 100:160, 100:130] = 255
    masks[2, 100:160, 130:190] = 255
    single = [bytes([i]) for i in range(256)]
    return example({"image": [single[b] for b in image.ravel()], "mask": [single[b] for b in masks.ravel()],
                    "pixel_coords": [0.0] * 33, "visibility": [1.0] * 3 + [0.0] * 8})


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    write(f"{folder}/records-any.tfrecord", [plain(), sequence()])
    write(f"{folder}/records-gqn.tfrecord", [gqn()])
    write(f"{folder}/records-movi.tfrecord", [movi()])
    write(f"{folder}/clevr", [clevr()])
    with open(f"{folder}/clevr", "rb") as file, open(f"{folder}/records-clevr.tfrecord", "wb") as out:
        out.write(gzip.compress(file.read(), mtime=0))
    os.remove(f"{folder}/clevr")


if __name__ == "__main__":
    main()
