"""Rows of the library's tables (docs/extending.md) that are written in Python."""
from . import _core


def front_end(kind, function=None):
    """Adds a front end of your own: [sensor.LABEL] kind = KIND of an INI then calls `function`.

        @perception.front_end("mine")
        def mine(frame):                    # perception.Frame: data, pose, sensor_pose, ground, ...
            return boxes, scores, labels    # or boxes alone, or None

    function(frame) returns boxes (n, 7): x, y, z of the bottom's centre, length, width, height [m], yaw
    [rad] in the sensor frame, or points (n, 2) or (n, 3) [m]. Scores (n,) are 1 and labels "object" if
    they are left out. They are measured as boxes of `kind = positions`, whose keys of
    [sensor.LABEL.positions] apply (labels, names, sigma, min_score, ...), but not confidence = learnt.
    The result depends on the frame alone and not on earlier ones: frames may come from any thread. An
    exception ends the call of the tracker that gave the frame. A kind that is given again replaces the
    function for later trackers and programs. Kinds of the library cannot be replaced.
    """
    if function is None:
        return lambda decorated: front_end(kind, decorated)
    _core.add_front_end(kind, function)
    return function


def motion_model(name, function=None, has_heading=False):
    """Adds a motion model of your own: [class.NAME] motion = NAME of an INI then calls `function`.

        @perception.motion_model("drifting")
        def drifting(x, dt, psd):           # (4,), [s], [m^2/s^3] accel_psd of the class
            return F @ x, F, Q              # (4,), (4, 4), (4, 4)

    It predicts a state by dt > 0: F is the slope of the prediction by the state, Q the covariance of
    what it leaves out. State: x, y, vx, vy [m, m/s] in the world; with has_heading x, y, v, theta: the
    speed along theta [rad], and constant velocity predicts until theta is known. It is called for every
    Gaussian of every object, thousands of times a scan, from any thread: its result depends on its
    arguments alone. A name that is given again replaces the function, also of trackers that run. Names
    of the library cannot be replaced.
    """
    if function is None:
        return lambda decorated: motion_model(name, decorated, has_heading)
    _core.add_motion_model(name, function, has_heading)
    return function
