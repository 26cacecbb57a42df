#!/usr/bin/python3
"""Says what the errors are that kitti_detections.sh leaves: misses of the detector, clutter, coasting, places, decisions.

    tests/bench/kitti/kitti_errors.py OUT [-t SCORE] [--worst N] [SEQUENCE ...]

OUT is the folder of a run of kitti_detections.sh. Matching as mot_eval.py does (3D overlap of .25, KITTI's rules for what is
ignored), of all lines with a score of SCORE or more. Prints and writes OUT/errors.md, and draws the N worst from above as
OUT/worst.png: half of them the tracks with the most false frames, half the objects with the most missed ones. Needs python3-numpy, python3-scipy, gnuplot-nox; PERCEPTION_SHARED as there.
"""
import argparse
import collections
import csv
import glob
import os
import subprocess
import sys

import numpy as np
from scipy.optimize import linear_sum_assignment

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
CLASSES = ('Car', 'Pedestrian', 'Cyclist')
EVERY_TYPE = ['car', 'van', 'truck', 'pedestrian', 'person', 'person_sitting', 'cyclist', 'tram', 'misc']
MIN_IOU = 0.25
SAME_PLACE = 2.0     # [m] between centers: a track or label that is about an object without overlapping it enough
ON_TRACK = 1.0       # [m] between centers: a box that the track may have taken
CLOSE_BY = 6.0       # [m] around a track's life: boxes and labels drawn in its picture

# Each error: whose it is, and what it is.
MISSED = {
    'none': ('detector', 'no box overlaps the object'),
    'foreign': ('detector', 'only a box of another class overlaps it'),
    'weak': ('detector', 'only a box with a score below 0 overlaps it, no track'),
    'no track': ('tracker', 'a box with a score of 0 or more overlaps it, no track'),
    'low': ('decision', 'a track of its class overlaps it, score too low'),
    'thing': ('decision', 'a track that is called a thing overlaps it'),
    'class': ('decision', 'a track of another class overlaps it'),
    'taken': ('association', 'the track that overlaps it is matched to a neighbor'),
    'place': ('localization', 'a track within 2 m overlaps it too little, as a box would not'),
    'place, box': ('localization', 'a track within 2 m overlaps it too little, no box overlaps it either'),
}
FALSE = {
    'clutter': ('clutter', 'on nothing labeled, with a box; a track that never was right'),
    'clutter without box': ('coasting', 'on nothing labeled, no box; a track that never was right'),
    'before': ('labels', 'before the first right frame of the track, with a box'),
    'between': ('labels', 'between right frames, nothing labeled near, with a box'),
    'after': ('labels', 'after the last right frame, with a box'),
    'coasting': ('coasting', 'a track that was right in other frames, nothing labeled near, no box'),
    'place': ('localization', 'within 2 m of a missed object, too little overlap, with a box'),
    'place, coasting': ('coasting', 'within 2 m of a missed object, too little overlap, no box'),
    'second': ('association', 'on an object that has its track already'),
    'sitting person': ('labels', 'on a sitting person (KITTI: Person), which the 3D rules do not excuse'),
    'another type': ('decision', 'on an object of another type'),
}


def overlaps(me, a, b):
    """3D IoU of every pair of boxes."""
    out = np.zeros((len(a), len(b)))
    if out.size:
        reach = (np.hypot(a[:, 1], a[:, 2])[:, None] + np.hypot(b[:, 1], b[:, 2])[None, :]) / 2
        i, j = np.nonzero(distances(a, b) < reach)
        if len(i):
            out[i, j] = me.iou3d_pairs(a[i], b[j])
    return out


def distances(a, b):
    return np.hypot(a[:, None, 3] - b[None, :, 3], a[:, None, 5] - b[None, :, 5])


class Detections:
    """The boxes of a sequence, all classes."""

    def __init__(self, data, sequence):
        rows = []
        for c in CLASSES:
            for line in open(os.path.join(data, 'det_pointrcnn', c, '%04d.txt' % sequence)):
                v = [float(x) for x in line.split(',')]
                rows.append([v[0], CLASSES.index(c), v[6]] + v[7:14])
        rows = np.array(rows).reshape(-1, 10)
        self.by_frame = collections.defaultdict(lambda: np.zeros((0, 10)))
        for f in np.unique(rows[:, 0]):
            self.by_frame[int(f)] = rows[rows[:, 0] == f]

    def at(self, frame):
        """Class, score, h w l x y z ry."""
        return self.by_frame[frame][:, 1:]


class Track:
    """What a track did, or what became of a labeled object (`lost`), frame by frame."""

    def __init__(self, sequence, cls, number, lost=False):
        self.sequence, self.cls, self.number, self.lost = sequence, cls, number, lost
        self.right, self.wrong, self.boxes = [], {}, {}   # frames; frame -> reason; frame -> image box
        self.scores = []


def missed_reason(k, truth, tracks, types, scores, cls, threshold, iou_tracks, boxes, iou_boxes):
    over = iou_tracks[k] >= MIN_IOU
    own_box = over_box = None
    if len(boxes):
        hit = iou_boxes[k] >= MIN_IOU
        own = hit & (boxes[:, 0] == CLASSES.index(cls))
        own_box = boxes[own, 1].max() if own.any() else None
        over_box = hit.any()
    mine = types == cls.lower()
    if (over & mine & (scores >= threshold)).any():
        return 'taken'
    if (over & ~mine & (types != 'misc') & (scores >= threshold)).any():
        return 'class'
    if (over & mine).any():
        return 'low'
    if over.any():
        return 'thing'
    near = distances(truth[k:k + 1], tracks)[0] < SAME_PLACE
    if (near & mine & (scores >= threshold)).any():
        return 'place' if own_box is not None else 'place, box'
    if own_box is not None:
        return 'no track' if own_box >= 0 else 'weak'
    return 'foreign' if over_box else 'none'


def count_class(me, a, sequence, cls, missed, false, totals, worst):
    low, name = cls.lower(), '%04d.txt' % sequence
    n = me.KITTI_FRAMES[sequence]
    labels = os.path.join(a.data, 'label_02', name)
    truth = me.load(labels, [low] + me.NEIGHBOURS_CLEAR.get(low, []), n)
    every = me.load(labels, EVERY_TYPE, n)
    areas = me.load(labels, ['dontcare'], n)
    tracks = me.load(os.path.join(a.out, 'res', name), ['car', 'pedestrian', 'cyclist', 'truck', 'misc'], n)
    detections = Detections(a.data, sequence)
    ignored = (truth.occ > me.MAX_OCCLUSION) | (truth.trunc > me.MAX_TRUNCATION) | (truth.type != low)
    small = np.abs(tracks.box2[:, 3] - tracks.box2[:, 1]) <= me.MIN_HEIGHT
    history, objects, waiting = {}, {}, []
    for f in range(n):
        g, t = truth.at(f), tracks.at(f)
        gb, tb, types, scores = truth.box3[g], tracks.box3[t], tracks.type[t], tracks.score[t]
        boxes = detections.at(f)
        iou, iou_boxes = overlaps(me, gb, tb), overlaps(me, gb, boxes[:, 2:])
        kept = np.nonzero((types == low) & (scores >= a.threshold))[0]
        cost = np.where(iou[:, kept] >= MIN_IOU, 1 - iou[:, kept], 1e9)
        rows, cols = linear_sum_assignment(cost)
        pairs = {int(r): int(kept[c]) for r, c in zip(rows, cols) if cost[r, c] < 1e9}
        matched = set(pairs.values())
        for k in range(len(gb)):
            if ignored[g][k]:
                continue
            totals['objects', cls] += 1
            number = int(truth.id[g][k])
            thing = objects.setdefault(number, Track(sequence, cls, number, lost=True))
            if k in pairs:
                totals['right', cls] += 1
                thing.right.append(f)
                continue
            thing.wrong[f] = missed_reason(k, gb, tb, types, scores, cls, a.threshold, iou, boxes, iou_boxes)
            missed[thing.wrong[f], cls] += 1
        cover = me.iou2d(tracks.box2[t], areas.box2[areas.at(f)], over_a=True)
        other = every.box3[every.at(f)]
        other_iou = overlaps(me, tb, other)
        box_near = distances(tb, boxes[:, 2:]) if len(boxes) else np.full((len(tb), 1), 99.0)
        free = np.array([k not in pairs for k in range(len(gb))], bool)
        truth_near = distances(tb, gb) < SAME_PLACE
        for j in kept:
            i = t.start + j
            track = history.setdefault(int(tracks.id[i]), Track(sequence, cls, int(tracks.id[i])))
            track.boxes[f] = tracks.box2[i]
            track.scores.append(tracks.score[i])
            if j in matched:
                track.right.append(f)
                continue
            if small[i] or (cover[j] > 0.5).any():
                continue
            box = box_near[j].min() < ON_TRACK
            if (iou[:, j] >= MIN_IOU).any():
                track.wrong[f] = 'second'
            elif (other_iou[j] >= MIN_IOU).any():
                on = every.type[every.at(f)][other_iou[j].argmax()]
                track.wrong[f] = 'sitting person' if low == 'pedestrian' and on.startswith('person') else 'another type'
            elif (truth_near[j] & free).any():
                track.wrong[f] = 'place' if box else 'place, coasting'
            else:
                track.wrong[f] = None
                waiting.append((track, f, box))
    for track, f, box in waiting:     # what they are depends on the track's other frames
        if not track.right:
            track.wrong[f] = 'clutter' if box else 'clutter without box'
        elif not box:
            track.wrong[f] = 'coasting'
        else:
            track.wrong[f] = ('before' if f < track.right[0] else 'after' if f > track.right[-1] else 'between')
    for track in history.values():
        for reason in track.wrong.values():
            false[reason, cls] += 1
        worst.append(track)
    worst.extend(objects.values())


def markdown(a, missed, false, totals):
    def table(title, reasons, counts):
        lines = ['**%s**' % title, '', '| whose | what | ' + ' | '.join(CLASSES) + ' |', '|---|---|' + '---|' * len(CLASSES)]
        for key, (whose, what) in reasons.items():
            lines.append('| %s | %s | %s |' % (whose, what, ' | '.join('%d' % counts[key, c] for c in CLASSES)))
        lines.append('| | all | %s |' % ' | '.join('%d' % sum(counts[k, c] for k in reasons) for c in CLASSES))
        return '\n'.join(lines) + '\n'
    both = collections.Counter()
    for reasons, counts in ((MISSED, missed), (FALSE, false)):
        for key, (whose, _) in reasons.items():
            for c in CLASSES:
                both[whose, c] += counts[key, c]
    lines = ['**Both together, per 100 labeled objects**', '', '| whose | ' + ' | '.join(CLASSES) + ' |',
             '|---|' + '---|' * len(CLASSES)]
    for whose in dict.fromkeys(w for w, _ in list(MISSED.values()) + list(FALSE.values())):
        lines.append('| %s | %s |' % (whose, ' | '.join(
            '%.1f' % (100 * both[whose, c] / max(totals['objects', c], 1)) for c in CLASSES)))
    return ('# What the errors are\n\nSequences %s; all output with a score of %g or more; labeled and counted: %s; found: '
            '%s.\n\n' % (' '.join('%04d' % s for s in a.sequences), a.threshold,
                         ', '.join('%d %s' % (totals['objects', c], c) for c in CLASSES),
                         ', '.join('%d %s' % (totals['right', c], c) for c in CLASSES)) +
            table('Missed', MISSED, missed) + '\n' + table('False', FALSE, false) + '\n' + '\n'.join(lines) + '\n')


# ---------------------------------------------------------------- the worst tracks from above

def read_csv(path):
    with open(path) as file:
        return list(csv.DictReader(file))


class World:
    """A sequence in the world frame: vehicle, labels, tracks by frame, and boxes brought there."""

    def __init__(self, a, sequence):
        folder = os.path.join(a.out, 'run', '%04d' % sequence)
        self.ego = {int(r['frame']): (float(r['x']), float(r['y']), float(r['yaw']))
                    for r in read_csv(os.path.join(folder, 'scenes.csv'))}
        self.tracks = {(int(r['frame']), int(r['id'])): (float(r['x']), float(r['y']))
                       for r in read_csv(os.path.join(folder, 'tracks.csv'))}
        self.truth = collections.defaultdict(list)
        for r in read_csv(os.path.join(a.out, 'logs', '%04d.truth.csv' % sequence)):
            if r['x']:
                self.truth[int(r['id'])].append((int(r['frame']), float(r['x']), float(r['y']), r['class']))
        calibration = {}
        for line in open(os.path.join(a.data, 'calib', '%04d.txt' % sequence)):
            parts = line.replace(':', ' ').split()
            if parts:
                calibration[parts[0]] = np.array(parts[1:], float)
        camera_velodyne, rectified = np.eye(4), np.eye(4)
        rectified[:3, :3] = calibration.get('R0_rect', calibration.get('R_rect')).reshape(3, 3)
        camera_velodyne[:3] = calibration.get('Tr_velo_to_cam', calibration.get('Tr_velo_cam')).reshape(3, 4)
        self.velodyne_camera = np.linalg.inv(rectified @ camera_velodyne)

    def place(self, frame, box):
        """Box h w l x y z ry of the camera's frame -> x, y [m], world."""
        p = self.velodyne_camera @ np.array([box[3], box[4], box[5], 1.0])
        x, y, yaw = self.ego[frame]
        return x + np.cos(yaw) * p[0] - np.sin(yaw) * p[1], y + np.sin(yaw) * p[0] + np.cos(yaw) * p[1]


# What a panel's title says of its reasons, in words that stand alone.
PLAIN = {
    'clutter': 'the detector marks a thing as this class', 'clutter without box': 'kept without boxes, never right',
    'before': 'not labeled yet', 'between': 'not labeled meanwhile', 'after': 'not labeled any more',
    'coasting': 'kept after its object was gone', 'second': 'second track of one object',
    'sitting person': 'a person that sits: KITTI has another class for it', 'another type': 'a road user of another class',
    'none': 'the detector has no box on it', 'foreign': 'the detector has only boxes of another class',
    'weak': 'the detector has only doubtful boxes', 'no track': 'no track in spite of boxes', 'low': 'tracked, too little sure',
    'thing': 'tracked, called a thing', 'class': 'tracked as another class', 'taken': 'its track stands for a neighbor',
    'place, box': 'tracked too far off, no box on it',
}


def title(track, number, frames, away):
    reason, n = collections.Counter(track.wrong.values()).most_common(1)[0]
    plain = PLAIN.get(reason, 'too little overlap' + (', no box' if 'coasting' in reason else ''))
    what = ('%s missed' if track.lost else 'false %s') % track.cls.lower()
    return '%d. %s, %d of %d frames\\n%d x %s\\nsequence %04d, %s %d, %.0f m away' % (
        number, what, len(track.wrong), len(frames), n, plain, track.sequence, 'label' if track.lost else 'track',
        track.number, away)


def panel(a, world, track, folder, number):
    """Data files and gnuplot commands of one track's, or one lost object's, picture."""
    frames = sorted(set(track.right) | set(track.wrong) | set(track.boxes))
    if track.lost:
        path = {f: (x, y) for f, x, y, _ in world.truth[track.number] if f in frames and f in world.ego}
    else:
        path = {f: world.tracks[f, track.number] for f in frames if (f, track.number) in world.tracks}
    points = np.array(list(path.values()))
    detections = Detections(a.data, track.sequence)
    near, files = [], {}
    for f in path:
        for b in detections.at(f):
            x, y = world.place(f, b[2:])
            if np.hypot(x - path[f][0], y - path[f][1]) < CLOSE_BY:
                near.append((x, y, CLASSES.index(track.cls) == int(b[0]), b[1]))
    files['ego'] = ['%.3f %.3f' % world.ego[f][:2] for f in path if f in world.ego]
    files['right'] = ['%.3f %.3f' % path[f] for f in path if f in track.right]
    files['wrong'] = ['%.3f %.3f' % path[f] for f in path if f in track.wrong]
    files['box'] = ['%.3f %.3f' % p[:2] for p in near if p[2] and p[3] >= 0]
    files['foreign'] = ['%.3f %.3f' % p[:2] for p in near if not p[2] or p[3] < 0]
    files['truth'] = []
    for rows in world.truth.values():
        close = [(f, x, y) for f, x, y, _ in rows
                 if f in path and np.hypot(x - path[f][0], y - path[f][1]) < CLOSE_BY]
        files['truth'] += ['%.3f %.3f' % r[1:] for r in close] + ['', '']
    names = {}
    for key, lines in files.items():
        names[key] = '%02d_%s.dat' % (number, key)
        with open(os.path.join(folder, names[key]), 'w') as file:
            file.write('\n'.join(lines) + '\n' if any(lines) else '')
    half = max(max(points.max(0) - points.min(0)) / 2, 2.5) + 2.5
    middle = (points.max(0) + points.min(0)) / 2
    away = np.mean([np.hypot(path[f][0] - world.ego[f][0], path[f][1] - world.ego[f][1]) for f in path])
    text = 'set title "%s" noenhanced font ",9"\nset xrange [%.2f:%.2f]\nset yrange [%.2f:%.2f]\n' % (
        title(track, number, frames, away), middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half)
    # Every panel draws every kind, so that one key serves all; what is not there is drawn out of sight.
    drawn = []
    for k, style in STYLES:
        drawn.append(('"%s" %s notitle' if any(files[k]) else '1/0 %.0s%s notitle') % (names[k], style))
    return text + 'plot ' + ', '.join(drawn) + '\n'


STYLES = (('foreign', 'with points pt 6 ps 0.5 lc rgb "#BBBBBB"'), ('box', 'with points pt 6 ps 1.0 lc rgb "#56B4E9"'),
          ('truth', 'with lines lw 3 lc rgb "black"'), ('right', 'with points pt 7 ps 0.6 lc rgb "#009E73"'),
          ('wrong', 'with points pt 7 ps 0.6 lc rgb "#C00000"'), ('ego', 'with lines lw 2 dt 2 lc rgb "#E69F00"'))
KEY = {'foreign': 'doubtful box, or one of another class', 'box': 'box of the detector, same class',
       'truth': 'ways of labeled objects', 'right': 'output and label agree', 'wrong': 'false output, or label that was missed',
       'ego': 'the vehicle'}


def key_panel():
    """A panel that holds the key alone."""
    text = ('set title "Boxes, tracks and labels from above, meters\\n(the vehicle is mostly out of the picture)" font ",9"\n'
            'unset border\nunset tics\nunset grid\nset key center center vertical spacing 1.6 font ",10"\n'
            'set xrange [0:1]\nset yrange [0:1]\nplot ')
    return text + ', '.join('1/0 %s title "%s"' % (style, KEY[k]) for k, style in STYLES) + '\n'


def crop(a, track, folder, number):
    """The track's box in the first picture that the data hold of one of its frames."""
    for f in sorted(track.wrong):
        source = os.path.join(a.data, 'image_02', '%04d' % track.sequence, '%06d.png' % f)
        if not os.path.exists(source) or f not in track.boxes:
            continue
        with open(source, 'rb') as file:
            size = file.read(24)
        height = int.from_bytes(size[20:24], 'big')
        x1, y1, x2, y2 = track.boxes[f]
        m = 0.4 * max(x2 - x1, y2 - y1, 40)
        corners = [(x1, y1), (x2, y1), (x2, y2), (x1, y2), (x1, y1)]
        name = '%02d_crop.dat' % number
        with open(os.path.join(folder, name), 'w') as out:
            out.writelines('%.1f %.1f\n' % (x, height - y) for x, y in corners)
        return ('set title "%04d %s %d, frame %d" noenhanced font ",9"\nset xrange [%.1f:%.1f]\nset yrange [%.1f:%.1f]\n'
                'plot "%s" binary filetype=png with rgbimage notitle, "%s" with lines lw 2 lc rgb "#C00000" notitle\n' % (
                    track.sequence, track.cls, track.number, f, x1 - m, x2 + m, height - y2 - m, height - y1 + m,
                    os.path.abspath(source), name))
    return None


def draw(a, tracks):
    folder = os.path.join(a.out, 'worst')
    os.makedirs(folder, exist_ok=True)
    for old in glob.glob(os.path.join(folder, '*')):
        os.remove(old)
    worlds = {}
    panels, crops = [], []
    for number, track in enumerate(tracks, 1):
        world = worlds.setdefault(track.sequence, None) or World(a, track.sequence)
        worlds[track.sequence] = world
        panels.append(panel(a, world, track, folder, number))
        picture = None if track.lost else crop(a, track, folder, number)
        if picture:
            crops.append(picture)
    columns = 4
    rows = -(-(len(panels) + len(crops) + 1) // columns)
    script = ('set terminal pngcairo size %d,%d font "Sans,9"\nset output "../worst.png"\n'
              'set multiplot layout %d,%d\nset size ratio -1\nset grid\nunset key\n' % (
                  columns * 400, rows * 450, rows, columns))
    with open(os.path.join(folder, 'worst.gp'), 'w') as file:
        file.write(script + ''.join(panels) + ''.join(crops) + key_panel() + 'unset multiplot\n')
    subprocess.run(['gnuplot', 'worst.gp'], cwd=folder, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('out')
    parser.add_argument('-t', '--threshold', type=float, default=0.0)
    parser.add_argument('--worst', type=int, default=10)
    parser.add_argument('sequences', nargs='*', type=int)
    a = parser.parse_intermixed_args()
    shared = os.environ.get('PERCEPTION_SHARED', os.path.join(ROOT, '..', 'shared'))
    a.data = os.path.join(shared, 'data', 'kitti_tracking')
    if not os.path.exists(os.path.join(shared, 'tools', 'mot_eval.py')) or not os.path.isdir(a.data):
        print('skipped: no tools/mot_eval.py and data/kitti_tracking in %s (PERCEPTION_SHARED)' % shared)
        return
    sys.path.insert(0, os.path.join(shared, 'tools'))
    import mot_eval as me
    if not a.sequences:
        a.sequences = sorted(int(os.path.basename(p)[:4]) for p in glob.glob(os.path.join(a.out, 'res', '????.txt')))
    missed, false, totals, tracks = collections.Counter(), collections.Counter(), collections.Counter(), []
    for sequence in a.sequences:
        for cls in CLASSES:
            count_class(me, a, sequence, cls, missed, false, totals, tracks)
    text = markdown(a, missed, false, totals)
    print(text)
    with open(os.path.join(a.out, 'errors.md'), 'w') as file:
        file.write(text)
    tracks = [t for t in tracks if t.wrong]
    tracks.sort(key=lambda t: (-len(t.wrong), t.sequence, t.number))
    false_most = [t for t in tracks if not t.lost][:(a.worst + 1) // 2]
    draw(a, false_most + [t for t in tracks if t.lost][:a.worst // 2])
    print('Worst tracks and objects: %s' % os.path.join(a.out, 'worst.png'))


if __name__ == '__main__':
    main()
