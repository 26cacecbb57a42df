"""Row wads of unseen_streets.py: which certain road users of a run stand on returns that are labeled as one."""
import gzip
import math
import os

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from unseen_runs import by_frame, is_user, rows_of


def wads(args):
    """A certain road user stands on one if five returns labeled as car, other vehicle or person lie within 1 m or half its length."""
    folder, runs = args[0], args[1:]
    poses = [np.array(line.split(), float).reshape(3, 4) for line in open(os.path.join(folder, "poses.txt"))]
    names = sorted(n.split(".")[0] for n in os.listdir(os.path.join(folder, "velodyne")))
    returns = {}
    for name, pose in zip(names, poses):
        points = np.frombuffer(gzip.open(f"{folder}/velodyne/{name}.bin.gz").read(), "<f4").reshape(-1, 4)[:, :3]
        labels = np.frombuffer(gzip.open(f"{folder}/labels/{name}.label.gz").read(), "<u4") & 0xFFFF
        returns[int(name)] = (points, labels, pose)
    found = {}
    for run in runs:
        outputs = by_frame(rows_of(os.path.join(run, "tracks.csv")))
        on, of, people, groups_ = 0, 0, 0, 0
        for scene in rows_of(os.path.join(run, "scenes.csv")):
            points, labels, _ = returns[int(scene["frame"])]
            c, s = math.cos(float(scene["yaw"])), math.sin(float(scene["yaw"]))
            turned = points[:, :2] @ np.array([[c, s], [-s, c]]) + np.array([float(scene["x"]), float(scene["y"])])
            users = cKDTree(turned[np.isin(labels, (10, 20, 30))])
            here = outputs.get(scene["frame"], [])
            for o in here:
                place = (float(o["x"]), float(o["y"]))
                if not is_user(o) or math.dist(place, (float(scene["x"]), float(scene["y"]))) > 40:
                    continue
                of += 1
                on += len(users.query_ball_point(place, max(1.0, float(o["length"]) / 2))) >= 5
            walkers = [(float(o["x"]), float(o["y"])) for o in here if o["class"] == "pedestrian" and o["classified"] == "1"]
            for group in linked(turned[labels == 30], 0.8):
                if len(group) < 20 or np.hypot(*(group.mean(0) - [float(scene["x"]), float(scene["y"])])) > 40:
                    continue
                groups_ += 1
                people += bool(walkers) and min(np.hypot(*(group - w).T).min() for w in walkers) <= 1.0
        found.setdefault(os.path.basename(run).rpartition("-")[0], []).append((on, of, people, groups_))
    text = "; ".join(f"{tag.split('-')[1].replace('.', ' ')}: {', '.join(f'{a} of {b}' for a, b, _, _ in v)} certain road users stand on one, "
                     f"{', '.join(f'{c} of {d}' for _, _, c, d in v)} groups of persons certain" for tag, v in found.items())
    met = all(a >= 0.95 * b and c > 0 for a, b, c, _ in found["wads-L"])
    return text, "shipped: .95 on a road user, people found", met


def linked(points, distance):
    """Groups of points linked by at most distance."""
    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray") if len(points) else np.zeros((0, 2), int)
    count, of = connected_components(coo_matrix((np.ones(len(pairs)), pairs.T), (len(points), len(points))), False)
    return [points[of == k] for k in range(count)]
