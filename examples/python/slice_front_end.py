"""A front end of ten lines: a slice of each scan, .8 to 1.2 m above ground, cut where it is open.

    python3 slice_front_end.py demo.rawlog demo.truth.csv
"""
import sys

import numpy as np

import perception


@perception.front_end("slice")
def parts_of_slice(frame: perception.Frame) -> np.ndarray:
    """Centers (n, 2) [m] of the parts, in the frame of the sensor."""
    xyz, mount, (a, b, c) = frame.data["xyz"], frame.sensor_pose, frame.ground
    x, y, z = (xyz @ mount[:3, :3].T + mount[:3, 3]).T  # in the frame of the vehicle
    points = xyz[np.abs(z - (a * x + b * y + c) - 1) < 0.2, :2]
    points = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]))]
    gaps = np.linalg.norm(np.diff(points, axis=0), axis=1) > 0.7
    parts = np.split(points, 1 + np.flatnonzero(gaps))
    return np.array([p.mean(axis=0) for p in parts if len(p) >= 3]).reshape(-1, 2)


INI = """
include = classes.ini
[sensor.LIDAR_TOP]
kind = slice
modality = L
range_max = 40
fov_deg = 360
clutter_per_scan = 1
"""  # a path or a name of an INI would do
run = perception.track(sys.argv[1], INI, sensors="L")
report = perception.evaluate(run, sys.argv[2], range=20)["runs"][0]["closest"]["all"]
print(f"{100 * report['object_tracked_a']:.0f} % of the objects within 20 m tracked, "
      f"{report['position_rms_m']:.2f} m off")
