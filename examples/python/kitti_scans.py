"""Tracks a folder of KITTI's .bin scans, without poses: python3 kitti_scans.py velodyne/0000"""
import pathlib
import sys
from typing import Optional

import numpy as np

import perception



def show(scene: Optional[perception.Scene]) -> None:
    if scene is not None:  # None: no scene is due yet
        print(scene.stamp, scene.objects["class"], scene.free_distance)


tracker = perception.Tracker("kitti.ini", sensors="L", overrides={"ego.source": "lidar"})
mount = np.eye(4)
mount[2, 3] = 1.73  # [m] KITTI's lidar above the road
for k, file in enumerate(sorted(pathlib.Path(sys.argv[1]).glob("*.bin"))):
    points = np.fromfile(file, np.float32).reshape(-1, 4)
    show(tracker.scan("LIDAR_TOP", 1e9 + k / 10, points[:, :3], points[:, 3], sensor_pose=mount))
for last in tracker.finish():
    show(last)
