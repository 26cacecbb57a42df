"""Tracks the boxes of a 3D detector. A stub stands for the network: it "sees" one car drive by."""
from typing import Optional

import numpy as np

import perception


def network(frame: int) -> tuple[np.ndarray, list[float], list[str]]:
    """A stub in place of a network: boxes (n, 7), scores and labels of one frame."""
    return np.array([[10 + frame, 3, 0.8, 4.2, 1.8, 1.6, 0.0]]), [9.0], ["Car"]


def show(scene: Optional[perception.Scene]) -> None:
    if scene is None:  # none is due yet
        return
    for o in scene.objects:
        print(f"{o['id']} {o['class']} {scene.stamp:.1f} {o['position']} {o['velocity']}")


tracker = perception.Tracker("kitti-detections.ini")
for frame in range(20):
    stamp = 1e9 + frame / 10
    tracker.pose(stamp, np.eye(4))
    show(tracker.boxes("pointrcnn", stamp, *network(frame), z="center"))
for last in tracker.finish():
    show(last)
