"""Tracks and classifies the objects around a vehicle, from numpy arrays or rawlogs.

    import perception
    tracker = perception.Tracker("kitti.ini", sensors="L")
    tracker.pose(stamp, T)                                    # 4x4, vehicle to world
    scene = tracker.scan("LIDAR_TOP", stamp, xyz, intensity)  # None until a scene is due
    if scene is not None:
        print(scene.objects["class"], scene.objects["position"], scene.free_distance)

Frames: world: z up, fixed; vehicle: x forward, y left, z up, origin on the ground; sensor: as the
vehicle's axes, for cameras x right, y down, z forward. SI units, angles in radians. Stamps: float
[s] since 1970, int [ns] or numpy.datetime64; a float holds instants of today to 0.2 us.
Errors: perception.Error with the text and, as `code`, the exit code of the programs.
"""
import json as _json

from . import _core
from ._core import Error, Observation, Scene, __version__
from ._programs import Run, Simulation, evaluate, settings_of, simulate, track

__all__ = ["Error", "Observation", "Run", "Scene", "Simulation", "Tracker", "evaluate", "open",
           "simulate", "track"]


class Tracker(_core.Tracker):
    """Takes the data of sensors as arrays, gives scenes: those of perception-track for the same data.

    ini: an INI of yours, or one of those installed by its name. sensors: modalities in use, "C+L+R".
    overrides: {"section.key": value} over the INI. output: a folder for tracks.csv and scenes.csv.

    Poses, frames, scans, boxes and targets are given in the order in which they come. Stamps of a
    sensor may be out of order by [run] reorder_window (0.2 s); what is later is dropped and an event
    says so. A clock that goes back by [run] clock_jump (5 s) starts the tracks anew. Points,
    boxes and targets with values that are not finite are dropped. All arrays are read
    before a call returns. Several threads may use one tracker, a call at a time.

    scan(), boxes(), image_boxes(), radar() and add() return the oldest scene that is due, or None;
    pending() returns what is due beside it, finish() the rest at the end of the data.
    """

    def __init__(self, ini, sensors="", overrides=None, output=""):
        chosen = [f"run.sensors={sensors}"] if sensors else []
        super().__init__(str(ini), chosen + settings_of(overrides), str(output))

    def events(self):
        """What happened: dicts with t, stamp, kind, severity, message, fields, as in events.jsonl."""
        return [_json.loads(line) for line in self.event_lines().splitlines()]


def open(log):
    """Iterates the observations of a rawlog: kind, sensor, stamp, sensor_pose, data (arrays).

    Of a torn or damaged log all that is whole comes first, then Error.
    """
    return _core.LogReader(str(log))
