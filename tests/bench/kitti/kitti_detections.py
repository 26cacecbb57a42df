#!/usr/bin/python3
"""Scores what kitti_detections.sh tracked, by the evaluation harness mot_eval.py: prints and writes the tables."""
import argparse
import concurrent.futures
import json
import os
import sys

CLASSES = ('Car', 'Pedestrian', 'Cyclist')
STAGES = ('positions', 'boxes', 'filter', 'scene')  # of timing.json: what a frame costs, without file handling
COLUMNS = ('class', 'sAMOTA', 'AMOTA', 'MOTA', 'MOTP', 'IDS', 'FRAG', 'FP', 'FN', 'HOTA', 'DetA', 'AssA', 'score from')
MIN_IOU = {'3d': 0.25, '2d': 0.5}


def score_best(tools, labels, res, sequences, cls, mode):
    """The customary figures: tracks above the mean score that gives the best MOTA; sAMOTA over all scores."""
    sys.path.insert(0, tools)
    import mot_eval
    r = mot_eval.evaluate(labels, res, sequences, cls, mode, MIN_IOU[mode], mode)
    return row(cls, r, r['best'], '%.2f' % r['best']['threshold'])


def score_all(tools, labels, res, sequences, cls, mode, threshold):
    """All lines of the folder count: nothing is chosen by looking at the truth."""
    sys.path.insert(0, tools)
    import mot_eval as me
    prepared = []
    for s in sequences:
        n, name = me.KITTI_FRAMES[s], '%04d.txt' % s
        types = [cls.lower()] + me.NEIGHBOURS_CLEAR.get(cls.lower(), [])
        truth = me.load(os.path.join(labels, name), types, n)
        areas = me.load(os.path.join(labels, name), ['dontcare'], n)
        tracks = me.load(os.path.join(res, name), [cls.lower()], n)
        prepared.append(me.ClearSequence(truth, tracks, areas, cls.lower(), mode, MIN_IOU[mode]))
    r = me.evaluate(labels, res, sequences, cls, mode, MIN_IOU[mode], mode, hota_at=-1e9)
    return row(cls, r, me.clear(prepared, -1e9), '%g' % threshold, integral=False)


def row(cls, r, at, threshold, integral=True):
    def percent(x):
        return '%.2f' % (100 * x)
    return (cls, percent(r['sAMOTA']) if integral else '', percent(r['AMOTA']) if integral else '', percent(at['MOTA']),
            percent(at['MOTP']), '%d' % at['ids'], '%d' % at['frag'], '%d' % at['fp'], '%d' % at['fn'],
            percent(r['HOTA']), percent(r['DetA']), percent(r['AssA']), threshold)


def keep_above(source, target, threshold):
    """Copies results without the lines of a lower score."""
    os.makedirs(target, exist_ok=True)
    for name in os.listdir(source):
        with open(os.path.join(source, name)) as lines, open(os.path.join(target, name), 'w') as kept:
            kept.writelines(line for line in lines if float(line.split()[17]) >= threshold)


def cost(out, sequences):
    """CPU milliseconds a frame of each stage: the run's CPU time by the stages' share of its wall time (one thread)."""
    frames, seconds = 0, dict.fromkeys(STAGES, 0.0)
    for s in sequences:
        with open(os.path.join(out, 'run', '%04d' % s, 'timing.json')) as file:
            timing = json.load(file)
        busy = timing['cpu_seconds'] / max(timing['wall_seconds'], 1e-9)
        for stage in timing['stages']:
            if stage['name'] in seconds:
                seconds[stage['name']] += busy * stage['seconds']
            if stage['name'] == 'scene':
                frames += stage['calls']
    return frames, {k: 1e3 * v / max(frames, 1) for k, v in seconds.items() if v > 0}


def markdown(title, rows):
    lines = ['**%s**' % title, '', '| ' + ' | '.join(COLUMNS) + ' |', '|' + '---|' * len(COLUMNS)]
    return '\n'.join(lines + ['| ' + ' | '.join(r) + ' |' for r in rows]) + '\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ('tools', 'data', 'out', 'config', 'options'):
        parser.add_argument('--' + name, required=name in ('tools', 'data', 'out'), default='')
    parser.add_argument('--mode', choices=MIN_IOU, default='3d')
    parser.add_argument('--threshold', type=float, default=0.0)
    parser.add_argument('sequences', nargs='+', type=int)
    a = parser.parse_args()
    labels, res = os.path.join(a.data, 'label_02'), os.path.join(a.out, 'res')
    kept = os.path.join(a.out, 'res_from_%g' % a.threshold)
    keep_above(res, kept, a.threshold)
    with concurrent.futures.ProcessPoolExecutor() as pool:
        best = [pool.submit(score_best, a.tools, labels, res, a.sequences, c, a.mode) for c in CLASSES]
        fixed = [pool.submit(score_all, a.tools, labels, kept, a.sequences, c, a.mode, a.threshold) for c in CLASSES]
        best, fixed = [f.result() for f in best], [f.result() for f in fixed]
    frames, milliseconds = cost(a.out, a.sequences)

    text = '# Boxes of detectors, tracked on KITTI\n\nSequences %s, %d frames; %s%s; %s overlap of %g.\n\n' % (
        ' '.join('%04d' % s for s in a.sequences), frames, os.path.basename(a.config),
        ' ' + a.options if a.options else '', a.mode.upper(), MIN_IOU[a.mode])
    text += markdown('At the score of the best MOTA (per class, by looking at the truth)', best) + '\n'
    text += markdown('All that is output with a score of %g or more' % a.threshold, fixed) + '\n'
    text += 'CPU a frame, one thread: %.2f ms (%s).\n' % (
        sum(milliseconds.values()), ', '.join('%s %.2f' % kv for kv in milliseconds.items()))
    print(text)
    with open(os.path.join(a.out, 'report.md'), 'w') as file:
        file.write(text)


if __name__ == '__main__':
    main()
