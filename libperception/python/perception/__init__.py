"""Tracks and classifies the objects around a vehicle, from numpy arrays or rawlogs.

    import perception
    tracker = perception.Tracker("kitti.ini", sensors="L")
    tracker.pose(stamp, T)                                    # 4x4, vehicle to world
    scene = tracker.scan("LIDAR_TOP", stamp, xyz, intensity)  # None until a scene is due
    if scene is not None:
        print(scene.objects["class"], scene.objects["position"], scene.free_distance)

Frames: world: z up, fixed; vehicle: x forward, y left, z up, origin on the ground; sensor: as the
vehicle's axes, for cameras x right, y down, z forward. SI units, angles in radians. Stamps: float
[s] since 1970, int [ns] or numpy.datetime64; a float holds instants of today to 0.2 us. 0 is no stamp:
where time starts at 0, add an offset to all stamps.
Variants in Python: front_end(), motion_model(); a class is data: a section [class.NAME] of the INI.
Errors: perception.Error with the text and, as `code`, the exit code of the programs.
"""
import json as _json

from . import _core
from ._core import Error, Frame, Observation, Scene, __version__
from ._extensions import front_end, motion_model
from ._programs import Run, Simulation, evaluate, ini_file, settings_of, simulate, track

__all__ = ["Error", "Frame", "Observation", "Run", "Scene", "Simulation", "Tracker", "evaluate",
           "front_end", "motion_model", "open", "simulate", "track"]


class Tracker(_core.Tracker):
    """Takes the data of sensors as arrays, gives scenes: those of perception-track for the same data.

    ini: an INI of yours, one of those installed by its name, or the text of one, of several lines, which
    may include others: "include = demo.ini\\n[class.scooter]\\nmotion = wheeled\\n". sensors: modalities in
    use, "C+L+R". overrides: {"section.key": value}, keys of sections that the INI has. output: a folder
    for tracks.csv and scenes.csv.

    Poses, frames, scans, boxes and targets are given in the order in which they come. Stamps of a
    sensor may be out of order by [run] reorder_window (0.2 s); what is later is dropped and an event
    says so. A clock that goes back by [run] clock_jump (5 s) starts the tracks anew. Points,
    boxes and targets with values that are not finite are dropped. All arrays are read
    before a call returns. Several threads may use one tracker, a call at a time.

    scan(), boxes(), image_boxes(), radar() and add() return the oldest scene that is due, or None;
    pending() returns what is due beside it, finish() the rest at the end of the data.

    pose(stamp, T): T (4, 4), vehicle to world [m]; its standard deviations sigma_xy [m], sigma_yaw and
        sigma_pitch [rad] are at least those of [ego]. Without poses: {"ego.source": "lidar"}.
    pose(stamp, latitude=, longitude=, height=, yaw=, pitch=, roll=): WGS84 [deg], height [m] above the
        ellipsoid (of all poses or of none), yaw [rad] counter-clockwise from east, pitch and roll of
        Rz Ry Rx; antenna: its place in the vehicle [m]. World: east, north, up about the first pose,
        or [ego] origin. Without yaw the heading is found on the way (method.md 1.4): until then,
        after some ten metres, the world is the vehicle's frame at its first position.
    frame(stamp, number): the number of the frame that begins, for scene.frame.
    scan(sensor, stamp, xyz, intensity, ring, time): xyz (n, 3) float32 [m] in the sensor frame; of
        shape (n,) or None: intensity ([0, 1], or of one or two bytes), ring (0 lowest), time [s]
        after the stamp (of absolute times: time - stamp), echo (0 first), pulse_width [m], label; max_range [m] of the instrument.
    boxes(sensor, stamp, boxes, scores, labels, z): boxes (n, 7): x, y, z, length, width, height [m],
        yaw [rad], in the sensor frame; z is that of the "bottom" or the "center" of a box.
    image_boxes(sensor, stamp, boxes, scores, labels, camera): boxes (n, 4): left, top, right, bottom
        [px]; camera: width, height, fx, fy, cx, cy [px] of an image without distortion; headings
        (n,) [rad]: KITTI's alpha, NaN where there is none.
    radar(sensor, stamp, range, bearing, range_rate): (n,) [m], [rad] counter-clockwise off the
        forward axis, [m/s] against the moving sensor (positive: away; NaN: none); amplitude [dB],
        elevation [rad].
    sensor_pose of these: (4, 4), sensor to vehicle [m]; [sensor.LABEL] pose of the INI comes first.
    add(observation): one of open().
    events(), learned(): as events.jsonl, and what was learned of detectors as lines of an INI.
    """

    def __init__(self, ini, sensors="", overrides=None, output=""):
        chosen = [f"run.sensors={sensors}"] if sensors else []
        with ini_file(ini) as file:
            super().__init__(file, chosen + settings_of(overrides), str(output or ""))

    def events(self):
        """What happened: dicts with t, stamp, kind, severity, message, fields, as in events.jsonl."""
        return [_json.loads(line) for line in self.event_lines().splitlines()]


def open(log):
    """Iterates the observations of a rawlog: kind, sensor, stamp, sensor_pose, data (arrays).

    Of a torn or damaged log all that is whole comes first, then Error.
    """
    return _core.LogReader(str(log))
