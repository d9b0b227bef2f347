#!/usr/bin/env python3
"""Writes tests/fixtures/state_dict.pt: tensors of every kind that a state dict may hold, as torch.save writes them."""
import argparse
import collections
import pathlib

import torch


def tensors():
    counts = torch.arange(24.0).reshape(2, 3, 4)
    return collections.OrderedDict(
        float32=counts, float64=torch.tensor([[0.1, -1e300]], dtype=torch.float64), float16=torch.tensor([1.5, -65504.0]).half(),
        bfloat16=torch.tensor([1.0, -3.0]).bfloat16(), int64=torch.tensor(2**40), int32=torch.tensor([-7], dtype=torch.int32),
        uint8=torch.tensor([200], dtype=torch.uint8), bool=torch.tensor([True, False]),
        transposed=counts.permute(2, 0, 1), column=counts[:, :, 1], part=counts[1, 1:], empty=torch.zeros(0, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=pathlib.Path, nargs="?",
                        default=pathlib.Path(__file__).resolve().parents[2] / "tests/fixtures/state_dict.pt")
    torch.save(tensors(), parser.parse_args().out)


if __name__ == "__main__":
    main()
