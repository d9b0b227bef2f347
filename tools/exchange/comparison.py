"""What both sides of tools/test-exchange share: comparing tensors by name."""
import json
import sys

import numpy

LIMIT = 1e-4


def compare(what, wanted, actual, limit=LIMIT):
    """Largest difference of every tensor of `wanted`, relative to 1 + its size; exits where one is above the limit."""
    worst = {}
    for name, tensor in sorted(wanted.items()):
        if actual[name].shape != tensor.shape:
            sys.exit(f"{what}: {name} has the shape {actual[name].shape} instead of {tensor.shape}")
        difference = numpy.abs(actual[name].astype("f8") - tensor) / (1 + numpy.abs(tensor))
        worst[name] = float(difference.max())
        if not worst[name] <= limit:
            sys.exit(f"{what}: {name} differs by {worst[name]:.2e}, above {limit:g}")
    return worst


def report(results):
    print(json.dumps(results))
