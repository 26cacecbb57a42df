#!/usr/bin/python3
"""Headings of tracks beside those of a detector that tells the viewpoint (DPM), on KITTI's sequences 0010 and 0011: imports,
tracks with the camera alone and prints a table; errors at the same objects and instants, matched by image boxes.
    tests/bench/kitti/kitti_heading.py [-o OUT] [SEQUENCE ...] [-- perception-track options]
PERCEPTION_SHARED, PERCEPTION_BIN as in kitti_detections.sh. Counted on 0011; 0010 judges."""
import argparse
import os
import subprocess
import sys

import numpy as np

MIN_IOU = 0.5        # of image boxes
CUSTOMARY_SCORE = 0  # from which the detector's own boxes count (README of the data)


def wrap(a):
    return (a + np.pi) % (2 * np.pi) - np.pi


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: done, with warnings
        sys.exit('%s\n%s' % (' '.join(command), done.stderr))


def track(binaries, data, out, sequence, options):
    name = '%04d' % sequence
    log, result = os.path.join(out, name + '.rawlog'), os.path.join(out, name + '.txt')
    run([binaries + '/perception-import', 'kitti', '--calib', f'{data}/calib/{name}.txt', '--poses', f'{data}/velo_poses/{name}.txt',
         '--rate', '9.66', '--labels', f'{data}/label_02/{name}.txt', '--detections', f'dpm:Car={data}/det_dpm/Car/{name}.txt',
         '-o', log])
    run([binaries + '/perception-track', '-c', 'ini/kitti-detections-viewpoint.ini', '-i', log, '-o', os.path.join(out, name), '--overwrite',
         '--export', 'kitti:' + result] + options)
    return result


def detections(path):
    """frame, alpha, image box of the detector's boxes."""
    rows = [line.split() for line in open(path)]
    values = np.array([[float(r[0]), *map(float, r[5:10]), float(r[17])] for r in rows])
    return values[values[:, 6] > CUSTOMARY_SCORE, :6]


def tracks(path):
    rows = [line.split() for line in open(path)]
    return np.array([[float(r[0]), *map(float, r[5:10])] for r in rows if r[2] == 'Car'])


def errors(truth, found, me):
    """By truth index: the heading error of the box that is matched to it."""
    result = {}
    for frame in range(truth.start.size - 1):
        g, f = truth.at(frame), np.nonzero(found[:, 0] == frame)[0]
        if g.stop <= g.start or not len(f):
            continue
        overlap = me.iou2d(truth.box2[g], found[f, 2:6])
        for k, i in enumerate(range(g.start, g.stop)):
            j = overlap[k].argmax()
            if truth.type[i] == 'car' and overlap[k, j] > MIN_IOU:
                box = truth.box3[i]
                result[i] = wrap(found[f[j], 1] - wrap(box[6] - np.arctan2(box[3], box[5])))
    return result


def row(sequence, who, e):
    e = np.degrees(np.array(e))
    axis = np.degrees(wrap(2 * np.radians(e))) / 2
    return '| %s | %s | %d | %d (%.2f %%) | %.1f | %.1f | %.1f |' % (
        sequence, who, len(e), (np.abs(e) > 90).sum(), 100 * (np.abs(e) > 90).mean(), np.median(np.abs(e)),
        np.sqrt((axis ** 2).mean()), np.sqrt((e ** 2).mean()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('-o', default='out/kitti_heading')
    parser.add_argument('sequences', nargs='*', type=int)
    arguments = sys.argv[1:]
    split = arguments.index('--') if '--' in arguments else len(arguments)
    a, options = parser.parse_args(arguments[:split]), arguments[split + 1:]
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', '..'))
    shared, binaries = os.environ.get('PERCEPTION_SHARED', '../shared'), os.environ.get('PERCEPTION_BIN', 'build/bin')
    data = shared + '/data/kitti_tracking'
    if not os.path.exists(data + '/det_dpm') or not os.path.exists(shared + '/tools/mot_eval.py'):
        print('skipped: %s/det_dpm or mot_eval.py is not there (PERCEPTION_SHARED)' % data)
        return
    sys.path.insert(0, shared + '/tools')
    import mot_eval as me
    os.makedirs(a.o, exist_ok=True)
    lines = ['| sequence | heading of | instants | reversed | median (deg) | axis, rms (deg) | rms (deg) |', '|' + '---|' * 7]
    for s in a.sequences or [10, 11]:
        result = track(binaries, data, a.o, s, options)
        truth = me.load('%s/label_02/%04d.txt' % (data, s), ['car', 'van'], me.KITTI_FRAMES[s])
        seen = errors(truth, detections('%s/det_dpm/Car/%04d.txt' % (data, s)), me)
        followed = errors(truth, tracks(result), me)
        both = sorted(seen.keys() & followed.keys())
        lines.append(row('%04d' % s, 'detector', [seen[i] for i in both]))
        lines.append(row('%04d' % s, 'track', [followed[i] for i in both]))
        lines.append(row('%04d' % s, 'track, detector or not', [followed[i] for i in sorted(followed)]))
    print('\n'.join(lines))
    with open(os.path.join(a.o, 'report.md'), 'w') as file:
        file.write('\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
