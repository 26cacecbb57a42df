#!/usr/bin/env python3
"""AMOTA and AMOTP of nuScenes' tracking benchmark, written from its definition alone, for comparison.

usage: tracking_benchmark.py FILE...    prints a line for each: AMOTA AMOTP recall switches false
FILE: CSV without names, a line a box: frame,kind (0 truth, 1 track),id,x,y,score. Needs python3-numpy, python3-scipy.
"""
import sys
import numpy as np
from scipy.optimize import linear_sum_assignment

LIMIT = 2.0  # [m]


def accumulate(frames, mean, threshold):
    """CLEAR MOT counts: truth, matched, switches, false, errors of the matched, their scores."""
    partner, n, matched, switches, false, errors, scores = {}, 0, 0, 0, 0, [], []
    for truth, tracks in frames:
        tracks = tracks[[mean[i] >= threshold for i in tracks[:, 0]]] if len(tracks) else tracks
        n += len(truth)
        pairs, free = [], list(range(len(tracks)))
        distance = np.linalg.norm(truth[:, None, 1:3] - tracks[None, :, 1:3], axis=2)
        left = []
        for i, row in enumerate(truth):
            kept = [j for j in free if tracks[j, 0] == partner.get(row[0]) and distance[i, j] < LIMIT]
            if kept:
                pairs.append((i, kept[0]))
                free.remove(kept[0])
            else:
                left.append(i)
        if left and free:
            d = distance[np.ix_(left, free)]
            rows, columns = linear_sum_assignment(np.where(d < LIMIT, d, 1e6))
            pairs += [(left[r], free[c]) for r, c in zip(rows, columns) if d[r, c] < LIMIT]
        for i, j in pairs:
            who, track = truth[i, 0], tracks[j, 0]
            switches += who in partner and partner[who] != track
            partner[who] = track
            errors.append(distance[i, j])
            scores.append(mean[track])
        matched += len(pairs)
        false += len(tracks) - len(pairs)
    return n, matched, switches, false, errors, scores


def evaluate(path):
    table = np.loadtxt(path, delimiter=",", ndmin=2)
    mean = {i: table[(table[:, 1] == 1) & (table[:, 2] == i), 5].mean() for i in np.unique(table[table[:, 1] == 1, 2])}
    frames = []
    for frame in np.unique(table[:, 0]):
        here = table[table[:, 0] == frame]
        frames.append((here[here[:, 1] == 0][:, 2:], here[here[:, 1] == 1][:, 2:]))
    n, matched, switches, false, _, scores = accumulate(frames, mean, -np.inf)
    best = np.sort(scores)[::-1]
    reached = np.arange(1, len(best) + 1) / n
    motar, motp = [], []
    for recall in np.linspace(0.1, 1, 40):
        if not len(best) or recall > reached[-1]:
            motar.append(0.0)
            motp.append(LIMIT)
            continue
        _, hit, ids, fp, errors, _ = accumulate(frames, mean, np.interp(recall, reached, best))
        r = hit / n
        motar.append(max(0.0, 1 - (ids + fp + (n - hit) - (1 - r) * n) / (r * n)) if hit else 0.0)
        motp.append(np.mean(errors) if errors else LIMIT)
    return np.mean(motar), np.mean(motp), matched / n, switches, false


if __name__ == "__main__":
    for path in sys.argv[1:]:
        print("%.12g %.12g %.12g %d %d" % evaluate(path))
