#!/usr/bin/python3
"""The classical baseline on the same boxes: one constant-velocity Kalman filter a track, one tracker a class, scored like ours.

Written from the description of AB3DMOT (Weng et al., IROS 2020, and its KITTI settings for PointRCNN); it stands beside our
table for what its papers do not print: fragmentations and identity switches on these sequences. That it is the same method
shows in MOTA and HOTA, which are published for these boxes (85.8 / 70.2, 75.6 / 52.3, 82.0 / 67.0 on `dev`).

  tests/bench/kitti/kitti_reference.py [--shared ../shared] [--out out/kitti_reference] [--in-image SHARE] [dev | train | SEQUENCE ...]

--in-image .5 leaves out boxes that lie in the image with less than half of their area, as our own output does
([scene] in_image): what that rule gives, and what the tracker.
"""
import argparse
import os
import sys

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import ConvexHull

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import kitti_detections  # noqa: E402

SPLITS = {'dev': [1, 6, 10, 12, 13, 14, 19], 'train': [0, 2, 3, 4, 5, 7, 9, 11, 17, 20]}
# class: solver, measure, its bound, hits before a track is output, scans without a box that end it
SETTINGS = {'Car': ('optimal', 'giou', -0.2, 3, 2), 'Pedestrian': ('greedy', 'giou', -0.4, 1, 4),
            'Cyclist': ('optimal', 'distance', -2.0, 3, 4)}
# A box is x y z yaw l w h in the world, z up, (x, y, z) its center [m, rad]; a state adds vx vy vz [m a scan].


class Track:
    """A constant-velocity Kalman filter over box and velocity."""
    F = np.eye(10) + np.eye(10, k=7) * (np.arange(10) < 3)[:, None]
    H = np.eye(7, 10)
    Q = np.diag([1.0] * 7 + [0.01] * 3)

    def __init__(self, number, detection):
        self.id, self.hits, self.misses, self.detection = number, 1, 0, detection
        self.x = np.r_[detection['box'], 0, 0, 0]
        self.P = np.diag([10.0] * 7 + [10000.0] * 3)

    def predict(self):
        self.x, self.P = self.F @ self.x, self.F @ self.P @ self.F.T + self.Q
        self.misses += 1

    def update(self, detection):
        self.detection, self.hits, self.misses = detection, self.hits + 1, 0
        z = detection['box'].copy()
        turn = (z[3] - self.x[3] + np.pi) % (2 * np.pi) - np.pi
        if abs(turn) > np.pi / 2:  # front and back confused: the state follows the detector
            self.x[3] += np.pi
            turn = (z[3] - self.x[3] + np.pi) % (2 * np.pi) - np.pi
        z[3] = self.x[3] + turn
        K = self.P @ self.H.T @ np.linalg.inv(self.H @ self.P @ self.H.T + np.eye(7))
        self.x = self.x + K @ (z - self.H @ self.x)
        self.P = (np.eye(10) - K @ self.H) @ self.P


def camera_box(b):
    """h w l x y z ry as the evaluation wants it, for a frame with x = -y, y = -z, z = x."""
    return np.array([b[6], b[5], b[4], -b[1], -(b[2] - b[6] / 2), b[0], -b[3] - np.pi / 2])


def similarity(tools, a, b, measure):
    """[tracks x detections]: generalized 3D overlap (Rezatofighi et al., CVPR 2019), or minus the distance of the centers."""
    import mot_eval
    out = np.full((len(a), len(b)), -1.0)  # the least that generalized overlap can be
    for i, p in enumerate(a):
        for j, q in enumerate(b):
            distance = np.linalg.norm(p[:3] - q[:3])
            if measure == 'distance':
                out[i, j] = -distance
            elif distance < 10:
                c = np.array([camera_box(p), camera_box(q)])
                corners = mot_eval.footprint(c).reshape(-1, 2)
                bottom, top = min(p[2] - p[6] / 2, q[2] - q[6] / 2), max(p[2] + p[6] / 2, q[2] + q[6] / 2)
                hull = ConvexHull(corners).volume * (top - bottom)
                iou = mot_eval.iou3d_pairs(c[:1], c[1:])[0]
                union = (np.prod(p[4:7]) + np.prod(q[4:7])) / (1 + iou)
                out[i, j] = iou - (hull - union) / hull
    return out


def pairs(similar, solver, bound):
    if solver == 'optimal':
        found = zip(*linear_sum_assignment(-similar))
    else:
        found, rows, columns = [], set(), set()
        for k in np.argsort(-similar, axis=None):
            i, j = np.unravel_index(k, similar.shape)
            if i not in rows and j not in columns:
                found.append((i, j))
                rows.add(i)
                columns.add(j)
    return [(i, j) for i, j in found if similar[i, j] >= bound]


def matrix(values):
    return np.vstack([np.reshape(values, (3, -1)), [0, 0, 0, 1]])


def velodyne_from_camera(path):
    rows = {line.split()[0].rstrip(':'): [float(x) for x in line.split()[1:]] for line in open(path) if line.strip()}
    rectify = np.eye(4)
    rectify[:3, :3] = np.reshape(rows.get('R0_rect') or rows['R_rect'], (3, 3))
    return np.linalg.inv(rectify @ matrix(rows.get('Tr_velo_to_cam') or rows['Tr_velo_cam']))


def share_in_image(values, projection, size=(1242, 375), near=0.1):
    """Of a box (h w l x y z rotation_y, KITTI's frame): the share of the area of its image box that lies in the image."""
    height, width, length, x, y, z, yaw = values
    along, across = np.array([np.cos(yaw), 0, -np.sin(yaw)]), np.array([np.sin(yaw), 0, np.cos(yaw)])
    corners = np.array([[x, y, z] + a * length / 2 * along + b * width / 2 * across - [0, c * height, 0]
                        for a in (-1, 1) for b in (-1, 1) for c in (0, 1)])
    corners[:, 2] = np.maximum(corners[:, 2], near)
    u, v, w = projection @ np.c_[corners, np.ones(8)].T
    low, high = np.array([(u / w).min(), (v / w).min()]), np.array([(u / w).max(), (v / w).max()])
    inside = np.maximum(np.minimum(high, np.array(size) - 1) - np.maximum(low, 0), 0)
    return inside.prod() / (high - low).prod()


def moved(T, center, yaw):
    direction = T[:3, :3] @ [np.cos(yaw), np.sin(yaw), 0]
    return T[:3, :3] @ center + T[:3, 3], np.arctan2(direction[1], direction[0])


def projection(path):
    row = next(line.split() for line in open(path) if line.startswith('P2'))
    return np.array(row[1:], float).reshape(3, 4)


def run(tools, data, number, cls, lines, in_image):
    solver, measure, bound, min_hits, max_age = SETTINGS[cls]
    name = '%04d.txt' % number
    table = np.loadtxt(os.path.join(data, 'det_pointrcnn', cls, name), delimiter=',', ndmin=2).reshape(-1, 15)
    poses = [matrix(row) for row in np.loadtxt(os.path.join(data, 'velo_poses', name), ndmin=2)]
    calibration = os.path.join(data, 'calib', name)
    T_velo_cam, P = velodyne_from_camera(calibration), projection(calibration)
    tracks, count = [], 0
    for frame, pose in enumerate(poses):
        detections = []
        for r in table[table[:, 0] == frame]:
            center = (T_velo_cam @ [r[10], r[11] - r[7] / 2, r[12], 1])[:3]
            ahead = T_velo_cam[:3, :3] @ [np.cos(r[13]), 0, -np.sin(r[13])]
            center, yaw = moved(pose, center, np.arctan2(ahead[1], ahead[0]))
            detections.append(dict(box=np.r_[center, yaw, r[9], r[8], r[7]], image=r[2:6], score=r[6]))
        for t in tracks:
            t.predict()
        similar = similarity(tools, [t.x for t in tracks], [d['box'] for d in detections], measure)
        taken = set()
        for i, j in pairs(similar, solver, bound) if similar.size else []:
            tracks[i].update(detections[j])
            taken.add(j)
        for j, d in enumerate(detections):
            if j not in taken:
                count += 1
                tracks.append(Track(count, d))
        tracks = [t for t in tracks if t.misses < max_age]
        back = np.linalg.inv(T_velo_cam) @ np.linalg.inv(pose)
        for t in tracks:
            if t.hits < min_hits and frame + 1 > min_hits:
                continue
            length, width, height = t.x[4:7]
            center = back[:3, :3] @ t.x[:3] + back[:3, 3]
            ahead = back[:3, :3] @ [np.cos(t.x[3]), np.sin(t.x[3]), 0]
            values = [*t.detection['image'], height, width, length, center[0], center[1] + height / 2, center[2],
                      np.arctan2(-ahead[2], ahead[0]), t.detection['score']]
            if in_image > 0 and share_in_image(values[4:11], P) < in_image:
                continue
            lines.append('%d %d %s 0 0 0 %s\n' % (frame, 100000 * list(SETTINGS).index(cls) + t.id, cls,
                                                  ' '.join('%.4f' % v for v in values)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--shared', default='../shared', help='folder with data/kitti_tracking and tools/mot_eval.py')
    parser.add_argument('--out', default='out/kitti_reference')
    parser.add_argument('--in-image', type=float, default=0)
    parser.add_argument('sequences', nargs='*', default=['dev'])
    a = parser.parse_args()
    data, tools = os.path.join(a.shared, 'data', 'kitti_tracking'), os.path.join(a.shared, 'tools')
    if not (os.path.isdir(os.path.join(data, 'label_02')) and os.path.exists(os.path.join(tools, 'mot_eval.py'))):
        print('skipped: %s with mot_eval.py is not there (--shared)' % data)
        return
    sys.path.insert(0, tools)
    sequences = SPLITS.get(a.sequences[0]) or [int(s) for s in a.sequences]
    res = os.path.join(a.out, 'res')
    os.makedirs(res, exist_ok=True)
    for name in os.listdir(res):
        os.remove(os.path.join(res, name))
    for s in sequences:
        lines = []
        for cls in SETTINGS:
            run(tools, data, s, cls, lines, a.in_image)
        with open(os.path.join(res, '%04d.txt' % s), 'w') as file:
            file.writelines(lines)
    rows = [kitti_detections.score_best(tools, os.path.join(data, 'label_02'), res, sequences, c, '3d') for c in SETTINGS]
    print(kitti_detections.markdown('Constant-velocity Kalman filters, a tracker per class, at the score of the best MOTA', rows))


if __name__ == '__main__':
    main()
