#!/usr/bin/python3
"""Reads the figures of one row of unseen_streets.sh, prints its line, ends with 1 where what is wanted is not met.

    unseen_streets.py ROW FILE...           reports of perception-evaluate, or what the row's function says
    unseen_streets.py absent ROW WHAT | head
"""
import csv
import json
import math
import os
import re
import sys

import numpy as np

from unseen_runs import by_frame, is_user, rows_of
from unseen_snow import wads

NEAR = 2.0  # [m] from the center of a true object to its output, as in perception-evaluate


class Figures:
    """Figures of some reports (seeds), each as the lowest and the highest."""

    def __init__(self, paths):
        self.runs = []
        for path in paths:
            with open(path) as file:
                self.runs += json.load(file)["runs"]

    def values(self, key):
        if key.startswith("false"):
            name = "per_instant" if key == "false" else "classified_per_instant"
            return [r["false_objects"]["all"][name] or 0.0 for r in self.runs]
        pairing = "one_to_one" if key == "id_switches" else "closest"
        return [r[pairing]["all"][key] or 0.0 for r in self.runs]

    def worst(self, key, largest=True):
        return (max if largest else min)(self.values(key))

    def text(self, key):
        low, high = min(self.values(key)), max(self.values(key))
        pattern = "{:.0f}" if key == "id_switches" else "{:.3f}"
        return pattern.format(low) + ("" if low == high else " to " + pattern.format(high))

    def line(self):
        return (f"tracked {self.text('object_tracked_a')}, right {self.text('correct')}, wrong {self.text('mis')}, false "
                f"{self.text('false')} ({self.text('false_certain')} certain), {self.text('id_switches')} switches")


def groups(paths):
    """The reports by recording, model and range: OUT/runs/TAG-SEED.RANGE/report.json."""
    found = {}
    for path in paths:
        tag, _, rest = os.path.basename(os.path.dirname(path)).rpartition("-")
        found.setdefault((tag, rest.split(".")[1] + " m"), []).append(path)
    return {key: Figures(value) for key, value in found.items()}


def table(paths):
    found = groups(paths)
    text = []
    for (tag, reach), figures in found.items():
        sensors = tag.split("-")[1].replace(".", " ").replace("LR", "L+R").replace("CL", "C+L")
        text.append(f"{sensors}, {reach}: {figures.line()}")
    return found, "; ".join(text)


def kitti_0000(paths):
    found, text = table(paths)
    near, far = found["kitti0000-L.blind", "20 m"], found["kitti0000-L.blind", "40 m"]
    met = (near.worst("correct", False) >= 0.9 and near.worst("mis") <= 0.02 and near.worst("id_switches") <= 1 and
           far.worst("correct", False) >= 0.8 and far.worst("mis") <= 0.04)
    return text, "blind: 20 m right .9, wrong .02, one switch; 40 m .8, .04", met


def kitti_0000_camera(paths):
    found, text = table(paths)
    near = found["kitti0000-CL.blind", "20 m"]
    met = near.worst("correct", False) >= 0.97 and near.worst("false_certain") <= 0.05
    return text, "blind: 20 m right .97, certain false .05 an instant", met


def aimotive(paths):
    """A second track: two outputs that are road users within a labeled vehicle (its box and .3 m) for more than .3 s."""
    found, text = table(paths)
    longest, errors = 0.0, []
    for path in [p for p in paths if "aimotive-LR-" in p]:
        run = os.path.dirname(path).rsplit(".", 1)[0]
        logs = os.path.join(os.path.dirname(os.path.dirname(run)), "logs")
        longest = max(longest, second_tracks(run, os.path.join(logs, "aimotive.truth.csv")))
        errors += velocity_errors(run, os.path.join(logs, "aimotive.truth.csv"))
    velocity = math.sqrt(np.mean(np.square(errors)))
    text += f"; L+R: longest second track {longest:.1f} s, velocity {velocity:.2f} m/s rms from 1 s on"
    return text, "L+R: no second track longer than .3 s, velocity .3 m/s", longest <= 0.3 and velocity <= 0.3


def inside(output, box, margin=0.3):
    dx, dy = float(output["x"]) - float(box["x"]), float(output["y"]) - float(box["y"])
    c, s = math.cos(float(box["yaw"])), math.sin(float(box["yaw"]))
    return (abs(c * dx + s * dy) <= float(box["length"]) / 2 + margin and
            abs(c * dy - s * dx) <= float(box["width"]) / 2 + margin)


def second_tracks(run, truth):
    outputs = by_frame(rows_of(os.path.join(run, "tracks.csv")))
    times = {}
    for box in rows_of(truth):
        if box["class"] not in ("Car", "Van", "Truck", "Bus") or int(box["lidar_points"]) < 20:
            continue
        on = [o for o in outputs.get(box["frame"], []) if is_user(o) and inside(o, box)]
        for o in on if len(on) > 1 else []:
            times.setdefault((box["id"], o["id"]), []).append(float(o["t"]))
    seconds = {}
    for (box, _), at in times.items():
        seconds.setdefault(box, []).append(max(at) - min(at) + 0.1)
    # Of the tracks on one vehicle the one that is there longest is the first.
    return max((sorted(s)[-2] for s in seconds.values() if len(s) > 1), default=0.0)


def matched(run, truth, reach):
    """Pairs of true objects and the outputs nearest to them, one to one, nearest first."""
    outputs, ego = by_frame(rows_of(os.path.join(run, "tracks.csv"))), {}
    for row in rows_of(os.path.join(run, "scenes.csv")):
        ego[row["frame"]] = (float(row["x"]), float(row["y"]))
    for frame, boxes in by_frame(rows_of(truth)).items():
        if frame not in ego:
            continue
        pairs = []
        for i, box in enumerate(boxes):
            if not box["x"]:  # an area of the image
                continue
            place = (float(box["x"]), float(box["y"]))
            if int(box["ignore"]) or int(box["occluded"]) > 2 or math.dist(place, ego[frame]) > reach:
                continue
            for k, output in enumerate(outputs.get(frame, [])):
                away = math.dist(place, (float(output["x"]), float(output["y"])))
                if away <= NEAR:
                    pairs.append((away, i, k))
        used_boxes, used_outputs = set(), set()
        for _, i, k in sorted(pairs):
            if i not in used_boxes and k not in used_outputs:
                used_boxes.add(i)
                used_outputs.add(k)
                yield boxes[i], outputs[frame][k]


def velocity_errors(run, truth, since=1.0):
    first = {}
    for row in rows_of(os.path.join(run, "tracks.csv")):
        first.setdefault(row["id"], float(row["t"]))
    for box, output in matched(run, truth, 80):
        if box["class"] in ("Car", "Van", "Truck", "Bus") and int(box["lidar_points"]) >= 20 and float(output["t"]) - first[output["id"]] >= since:
            yield math.hypot(float(box["vx"]) - float(output["vx"]), float(box["vy"]) - float(output["vy"]))


def drive_0052(paths):
    found, text = table(paths)
    figures = found["drive_0052-L.blind", "40 m"]
    return text, "blind: right .75", figures.worst("correct", False) >= 0.75


def drive_0052_camera(paths):
    found, text = table(paths)
    figures = found["drive_0052-CL.blind", "40 m"]
    return text, "blind: right .85", figures.worst("correct", False) >= 0.85


def argoverse(paths):
    return table(paths)[1], "", None


kitti_object = delft = argoverse


def left_out(folders):
    """Folder of perception-calibrate lidar-classes."""
    text, met = [], True
    sure = {r["log"]: r for r in rows_of(os.path.join(folders[0], "left_out.csv"))}
    with open(os.path.join(folders[0], "boxes.csv"), newline="") as file:
        lines = list(csv.reader(file))[1:]
    for name, *cells in lines:
        parts = []
        for kind, wanted, number, right in zip(("pedestrians", "riders", "vehicles"), (0.75, 0.6, 0.85), cells[::2], cells[1::2]):
            if number not in ("", "0"):
                parts.append(f"{kind} {right} of {number}")
                met = met and float(right) >= wanted
        row = sure[name]
        met = met and float(row["sure wrong"]) <= 0.02
        text.append(f"{name}: {', '.join(parts)}, {100 * float(row['sure wrong']):.1f} % of the sure ones wrong, log loss {row['log loss']}")
    return "; ".join(text), "vehicles .85, pedestrians .75, riders .6; sure and wrong 2 %", met


def headings(paths):
    stated, right, moving = [], [], []
    for path in paths:
        reach = float(re.search(r"\.(\d+)$", os.path.dirname(path)).group(1))
        run = os.path.dirname(path).rsplit(".", 1)[0]
        if not run.endswith("-1"):  # other seeds show the same headings
            continue
        log = os.path.basename(run).split("-")[0]
        truth = os.path.join(os.path.dirname(os.path.dirname(run)), "logs", log + ".truth.csv")
        for box, output in matched(run, truth, reach):
            if output["has_yaw"] != "1" or not is_user(output) or output["class"] == "pedestrian" or box["class"] in ("Pedestrian", "Person_sitting"):
                continue
            off = math.remainder(float(output["yaw"]) - float(box["yaw"]), 2 * math.pi)
            stated.append(float(output["p_front"]))
            right.append(abs(off) < math.pi / 2)
            moving.append(float(output["speed"]) > 1.0)
    stated, right, moving = np.array(stated), np.array(right), np.array(moving)
    known = stated >= 0.9
    reversed_ = (~right[known]).mean()
    text = (f"{len(stated)} headings; of {known.sum()} with p_front of .9 and more {int((~right[known]).sum())} reversed; calibration error "
            f"{ece(stated, right):.3f}, moving {ece(stated[moving], right[moving]):.3f}, standing {ece(stated[~moving], right[~moving]):.3f}")
    return text, "reversed .05 of the known, calibration error .05", reversed_ <= 0.05 and ece(stated, right) <= 0.05


def ece(stated, right, bins=10):
    cell = np.minimum((stated * bins).astype(int), bins - 1)
    return sum(abs(stated[cell == k].sum() - right[cell == k].sum()) for k in range(bins)) / max(1, len(stated))


ROWS = {f.__name__: f for f in (left_out, kitti_0000, kitti_0000_camera, aimotive, drive_0052, drive_0052_camera, wads, argoverse, headings)}
ROWS.update(kitti_object=argoverse, delft=argoverse)


def line(row, figure, wanted, verdict):
    print(f"| {row} | {figure} | {wanted} | {verdict} |", flush=True)


def main(args):
    if args == ["head"]:
        print("| row | figures | wanted | |\n|---|---|---|---|", flush=True)
        return 0
    if args[0] == "absent":
        line(args[1], "not there: " + args[2], "", "not measured")
        return 1
    figure, wanted, met = ROWS[args[0]](args[1:])
    line(args[0], figure, wanted, "shown" if met is None else "met" if met else "MISSED")
    return 1 if met is False else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
