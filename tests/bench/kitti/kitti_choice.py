#!/usr/bin/python3
"""How much of MOTA a better score of the tracks could still give, on results of kitti_detections.sh.

MOTA (3D overlap of .25) when whole tracks are kept or dropped
  by the score that the tracker gives them (its mean over the track, as the benchmark does),
  by a logistic function of what is known of the whole track at its end, fitted on TRAINING: its score (mean, greatest),
     the detector's (mean, greatest, spread), the share of frames with a box, length, range, size, and their products,
  by the truth: those that are right more often than wrong.
No causal tracker knows a track's end, so the second line is an upper bound for what its score could be fitted to.

  tests/bench/kitti/kitti_choice.py --train out/train/res --test out/dev/res [--shared ../shared]
"""
import argparse
import os
import sys

import numpy as np
from scipy.optimize import minimize

SPLITS = {'train': [0, 2, 3, 4, 5, 7, 9, 11, 17, 20], 'test': [1, 6, 10, 12, 13, 14, 19]}


class Sequence:
    """One sequence: its tracks' features, and how often each is right and wrong."""

    def __init__(self, me, data, res, number, cls):
        name, n = '%04d.txt' % number, me.KITTI_FRAMES[number]
        labels = os.path.join(data, 'label_02', name)
        truth = me.load(labels, [cls] + me.NEIGHBOURS_CLEAR.get(cls, []), n)
        tracks = me.load(os.path.join(res, name), [cls], n)
        boxes = np.loadtxt(os.path.join(data, 'det_pointrcnn', cls.capitalize(), name), delimiter=',', ndmin=2)
        self.clear = me.ClearSequence(truth, tracks, me.load(labels, ['dontcare'], n), cls, '3d', 0.25)
        self.rows = [self.row(tracks, boxes.reshape(-1, 15), k) for k in range(len(self.clear.length))]

    def row(self, tracks, boxes, track):
        right = wrong = 0
        scores, places = [], np.nonzero(self.clear.track == track)[0]
        for i in places:
            frame, box = tracks.frame[i], tracks.box3[i]
            overlaps = self.clear.sim[frame][:, i - tracks.start[frame]]
            if overlaps.size and overlaps.max() >= 0.25:
                right += 1
            elif not self.clear.small[i]:
                wrong += 1
            now = boxes[boxes[:, 0] == frame]
            distance = np.hypot(now[:, 10] - box[3], now[:, 12] - box[5])
            if distance.size and distance.min() < 1:
                scores.append(now[distance.argmin(), 6])
        scores = np.array(scores or [-1.0])
        b, s = tracks.box3[places], tracks.score[places]
        distance = np.hypot(b[:, 3], b[:, 5])
        return right, wrong, [s.mean(), s.max(), scores.mean(), scores.max(), scores.std(), len(scores) / len(places),
                              np.log(len(places)), distance.mean(), distance.min(), *b[:, :3].mean(0), b[:, 4].mean()]


def fitted(sequences):
    """Weights of the logistic function (quadratic in the standardized features), and the function."""
    rows = [r for s in sequences for r in s.rows if r[0] + r[1]]
    right, both = np.array([r[0] for r in rows], float), np.array([r[0] + r[1] for r in rows], float)
    features = np.array([r[2] for r in rows])
    mean, spread = features.mean(0), features.std(0)

    def expand(x):
        z = (np.atleast_2d(x) - mean) / spread
        products = [z[:, i] * z[:, j] for i in range(z.shape[1]) for j in range(i + 1)]
        return np.column_stack([np.ones(len(z)), z] + products)
    X, scale = expand(features), both.mean()

    def loss(w):
        a = X @ w
        nll = right * np.logaddexp(0, -a) + (both - right) * np.logaddexp(0, a)
        return nll.sum() / scale + 1.5 * w @ w, X.T @ (both / (1 + np.exp(-a)) - right) / scale + 3 * w
    w = minimize(loss, np.zeros(X.shape[1]), jac=True, method='L-BFGS-B').x
    return lambda x: (expand(x) @ w)


def best_mota(me, sequences, score_of):
    """Greatest MOTA [%] over thresholds of a score of whole tracks."""
    values = []
    for s in sequences:
        s.clear.mean = np.array([score_of(r) for r in s.rows]) if s.rows else np.zeros(0)
        values.extend(s.clear.mean)
    steps = np.unique(np.quantile(values, np.linspace(0, 0.99, 60)))
    return 100 * max(me.clear([s.clear for s in sequences], t)['MOTA'] for t in steps)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--train', required=True, help='results of the sequences to fit on')
    parser.add_argument('--test', required=True, help='results of the sequences to judge on')
    parser.add_argument('--shared', default='../shared', help='folder with data/kitti_tracking and tools/mot_eval.py')
    a = parser.parse_args()
    data, tools = os.path.join(a.shared, 'data', 'kitti_tracking'), os.path.join(a.shared, 'tools')
    if not (os.path.isdir(os.path.join(data, 'label_02')) and os.path.exists(os.path.join(tools, 'mot_eval.py'))):
        print('skipped: %s with mot_eval.py is not there (--shared)' % data)
        return
    sys.path.insert(0, tools)
    import mot_eval as me
    print('| class | by the score | by what was fitted | by the truth |\n|---|---|---|---|')
    for cls in ('car', 'pedestrian', 'cyclist'):
        train = [Sequence(me, data, a.train, s, cls) for s in SPLITS['train']]
        test = [Sequence(me, data, a.test, s, cls) for s in SPLITS['test']]
        choose = fitted(train)
        scores = (lambda r: r[2][0], lambda r: float(choose(r[2])[0]), lambda r: float(r[0] > r[1]))
        print('| %s | %s |' % (cls, ' | '.join('%.1f' % best_mota(me, test, f) for f in scores)), flush=True)


if __name__ == '__main__':
    main()
