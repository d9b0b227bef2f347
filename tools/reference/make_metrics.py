"""Write metrics.json: small label maps with the scores that docs/model.md section 10 gives them.

    python make_metrics.py OUT.json

Labels: 0 background, 1.. objects; a prediction is the argmax over K + 1 masks with K the background.
"""
import json
import sys

import numpy as np
from sklearn.metrics import adjusted_rand_score


def ari_fg(true, predicted):
    inside = true > 0
    return float(adjusted_rand_score(true[inside], predicted[inside])) if inside.any() else None


def iou(true, predicted):
    """IoU that greedy matching gives each true entity, in the order of np.unique(true)"""
    entities = np.unique(true)
    table = np.array([[((true == t) & (predicted == p)).sum() / ((true == t) | (predicted == p)).sum()
                       for p in np.unique(predicted)] for t in entities])
    score = np.zeros(len(entities))
    while table.max() > 0:
        t, p = np.unravel_index(table.argmax(), table.shape)
        score[t] = table[t, p]
        table[t, :], table[:, p] = 0, 0
    return score


def case(name, true, predicted):
    true, predicted = np.asarray(true), np.asarray(predicted)
    score, objects = iou(true, predicted), np.unique(true) > 0
    return dict(name=name, height=true.shape[0], width=true.shape[1], true=true.ravel().tolist(),
                predicted=predicted.ravel().tolist(), ari_fg=ari_fg(true, predicted),
                iou=float(score.mean()), iou_objects=float(score[objects].mean()) if objects.any() else None)


def main():
    rng = np.random.default_rng(0)
    true = np.zeros((12, 16), int)
    true[2:6, 2:7], true[5:11, 8:13], true[1:4, 11:15] = 1, 2, 3
    ideal = np.where(true == 0, 3, true - 1)
    noisy = np.where(rng.random(true.shape) < 0.25, rng.integers(0, 4, true.shape), ideal)
    one = np.where(true == 2, 1, 0)
    cases = [case("perfect", true, ideal), case("permuted", true, np.array([1, 2, 0, 3])[ideal]),
             case("noisy", true, noisy), case("all background", true, np.full_like(true, 3)),
             case("all one object", true, np.zeros_like(true)), case("no foreground", np.zeros_like(true), ideal),
             case("one object whole", one, np.where(one > 0, 0, 3)),
             case("one object split", one, np.where(one > 0, np.arange(16)[None] // 10, 3)),
             case("two merged", true, np.where(ideal == 1, 0, ideal)),
             case("background inside an object", true, np.where((true == 2) & (np.arange(16)[None] < 10), 3, ideal)),
             case("shifted", true, np.roll(ideal, 2, 1)), case("random", true, rng.integers(0, 4, true.shape))]
    json.dump(cases, open(sys.argv[1], "w"))
    for c in cases:
        print(c["name"], c["ari_fg"], c["iou"], c["iou_objects"])


if __name__ == "__main__":
    main()
