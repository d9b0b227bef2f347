"""onnxruntime's part of tools/test-exchange: runs an exported model on the images of an example.

    python onnx_side.py model.onnx example.safetensors expected.safetensors
"""
import sys

import onnxruntime
import safetensors.numpy

import comparison


def main(model, example, expected):
    session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
    shown = safetensors.numpy.load_file(example)
    names = [output.name for output in session.get_outputs()]
    seen = dict(zip(names, session.run(names, {"images": shown.pop("images")})))
    comparison.report({"vkopple": comparison.compare("onnxruntime against vkopple", shown, seen),
                       "PyTorch": comparison.compare("onnxruntime against PyTorch", safetensors.numpy.load_file(expected), seen)})


if __name__ == "__main__":
    main(*sys.argv[1:])
