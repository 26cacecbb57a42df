"""What the module perception costs beside the tracker: PYTHONPATH=build/python python3 tests/bench/speed/python_layer.py

Hands scans of 123,000 returns to a tracker that does not use their sensor: what is left is reading the
arrays and making the observation. CPU time of the calling thread, so that the load of the machine counts little.
"""
import time

import numpy as np

import perception

RETURNS, SCANS = 123_000, 300


def cost_us(**arrays):
    """Median and least CPU time of one scan() [us]."""
    tracker = perception.Tracker("kitti.ini", sensors="C")
    costs = []
    for k in range(SCANS):
        begin = time.thread_time_ns()
        tracker.scan("LIDAR_TOP", 1e9 + k / 10, **arrays)
        costs.append((time.thread_time_ns() - begin) / 1e3)
    return np.median(costs), min(costs)


rng = np.random.default_rng(1)
xyz = rng.uniform(-60, 60, (RETURNS, 3)).astype(np.float32)
intensity = rng.uniform(0, 1, RETURNS).astype(np.float32)
kitti = np.column_stack([xyz, intensity])
ring, offset = np.arange(RETURNS, dtype=np.uint16) % 64, np.linspace(0, 0.1, RETURNS, dtype=np.float32)
for name, arrays in (
        ("xyz, intensity", {"xyz": xyz, "intensity": intensity}),
        ("columns of KITTI's (n, 4)", {"xyz": kitti[:, :3], "intensity": kitti[:, 3]}),
        ("xyz float64", {"xyz": xyz.astype(np.float64)}),
        ("xyz, intensity, ring, time", {"xyz": xyz, "intensity": intensity, "ring": ring, "time": offset})):
    median, least = cost_us(**arrays)
    print(f"{name:30s} {median:6.0f} us a scan, least {least:6.0f} us")
