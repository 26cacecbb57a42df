#!/usr/bin/python3
"""INI and truth of KITTI raw 0052 for unseen_streets.sh.

    unseen_drive.py ini KITTI.INI OUT
    unseen_drive.py truth LABELS CALIBRATION SCENES.CSV OUT
"""
import math
import os
import sys

import numpy as np

from unseen_runs import rows_of


def drive_ini(kitti, out):
    """ini/kitti.ini with the boxes of YOLOX, which calls people on bicycles persons, and whose scores are log odds already."""
    with open(out, "w") as file:
        file.write(f"""include = {kitti}
[sensor.yolox]
kind = boxes
modality = C
clutter_per_scan = 0.5
births_per_scan = 0.05
range_max = 70
fov_deg = 80
[sensor.yolox.detector]
score_slope = 1
score_offset = 0
score_by_class = true
memory_lasting = 0.3
memory_kept = 0.5
memory_time = 1
names = Car=car, Pedestrian=person, Cyclist=person
""")


def drive_truth(labels, calibration, scenes, out):
    """The labels of single frames in the world of a run, and those of the scans between: what stands keeps its place, what moves is
    interpolated. KITTI's boxes keep their size in a drive, so equal sizes are one object. The frame of scenes.csv is the vehicle's."""
    matrices = {}
    for line in open(calibration):
        name, *numbers = line.replace(":", " ").split()
        matrices[name] = np.array(numbers, float)
    to_camera = np.eye(4)
    to_camera[:3] = next(v for k, v in matrices.items() if k.startswith("Tr_velo")).reshape(3, 4)
    rectify = np.eye(4)
    rectify[:3, :3] = next(v for k, v in matrices.items() if k.startswith("R_rect") or k.startswith("R0")).reshape(3, 3)
    to_lidar = np.linalg.inv(rectify @ to_camera)
    ego = {int(r["frame"]): [float(r[k]) for k in ("t", "x", "y", "yaw")] for r in rows_of(scenes)}
    frames = sorted(ego)

    def pose(frame):  # between scans: interpolated
        return [np.interp(frame, frames, [ego[f][k] for f in frames]) for k in range(4)]

    seen = {}  # size -> {frame: (x, y, z, yaw)}
    for name in sorted(os.listdir(labels)):
        frame = int(name.split(".")[0])
        _, ex, ey, eyaw = pose(frame)
        for line in open(os.path.join(labels, name)):
            cells = line.split()
            if cells[0] in ("DontCare", "Misc"):
                continue
            h, w, l, x, y, z, ry = map(float, cells[8:15])
            p = to_lidar @ [x, y, z, 1]
            yaw = -ry - math.pi / 2 + eyaw
            place = (ex + math.cos(eyaw) * p[0] - math.sin(eyaw) * p[1], ey + math.sin(eyaw) * p[0] + math.cos(eyaw) * p[1], p[2] + 1.73, yaw)
            seen.setdefault((cells[0], h, w, l), {})[frame] = place
    lines = []
    for number, ((kind, h, w, l), at) in enumerate(sorted(seen.items()), 1):
        known = sorted(at)
        for frame in [f for f in frames if known[0] <= f <= known[-1]]:
            x, y, z = (np.interp(frame, known, [at[f][k] for f in known]) for k in range(3))
            yaw = at[min(known, key=lambda f: abs(f - frame))][3]
            span = ego[frames[-1]][0] - ego[frames[0]][0]
            rate = (frames[-1] - frames[0]) / span
            time = (known[-1] - known[0]) / rate
            vx, vy = ((at[known[-1]][k] - at[known[0]][k]) / time if time else 0.0 for k in (0, 1))
            lines.append((frame, f"{frame},{ego[frame][0]:.9f},{number},{kind},{x:.4f},{y:.4f},{z:.4f},{math.remainder(yaw, 2 * math.pi):.6f},"
                                 f"{l},{w},{h},{vx:.4f},{vy:.4f},0,0,100,0"))
    with open(out, "w") as file:
        file.write("frame,t,id,class,x,y,z,yaw,length,width,height,vx,vy,truncated,occluded,lidar_points,ignore\n")
        file.writelines(text + "\n" for _, text in sorted(lines))


if __name__ == "__main__":
    {"ini": drive_ini, "truth": drive_truth}[sys.argv[1]](*sys.argv[2:])
