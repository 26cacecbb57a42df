"""tracker.pose(): matrices, positions on Earth with a heading, and without."""
import unittest

import numpy as np

import perception

EARTH, FLATTENING = 6378137.0, 1 / 298.257223563  # WGS 84
ORIGIN = (48.1, 11.5, 520.0)


def place(east, north, up=0.0):
    """[deg, deg, m] of a point near ORIGIN [m]: by the radii of curvature there."""
    lat = np.radians(ORIGIN[0])
    e2 = FLATTENING * (2 - FLATTENING)
    w = np.sqrt(1 - e2 * np.sin(lat)**2)
    meridian, normal = EARTH * (1 - e2) / w**3 + ORIGIN[2], EARTH / w + ORIGIN[2]
    return (ORIGIN[0] + np.degrees(north / meridian),
            ORIGIN[1] + np.degrees(east / (normal * np.cos(lat))), ORIGIN[2] + up)


def matrix(x, y, z, yaw, pitch=0.0, roll=0.0):
    c, s = np.cos, np.sin
    Rz = np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
    Ry = np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]])
    Rx = np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rz @ Ry @ Rx, (x, y, z)
    return T


def poses_of(give, count=12, ini="demo.ini", overrides=None):
    """The poses of the scenes of a tracker whose poses are given by give(tracker, stamp, k)."""
    tracker = perception.Tracker(ini, "L", overrides)
    scenes = []
    for k in range(count):
        give(tracker, 1e9 + k / 10, k)
        scene = tracker.scan("LIDAR_TOP", 1e9 + k / 10, np.zeros((0, 3), np.float32))
        scenes += [] if scene is None else [scene]
    return np.array([s.pose for s in scenes + tracker.finish()])


class OnEarth(unittest.TestCase):
    def fails(self, text, code, *arguments, **options):
        tracker = perception.Tracker("demo.ini", "L", options.pop("overrides", None))
        with self.assertRaises(perception.Error) as caught:
            tracker.pose(1e9, *arguments, **options)
        self.assertIn(text, str(caught.exception))
        self.assertEqual(caught.exception.code, code)

    def test_a_position_with_its_heading_is_the_pose_in_east_north_up(self):
        def give(tracker, stamp, k):
            latitude, longitude, height = place(1.2 * k, 0.5 * k, 0.1 * k)
            tracker.pose(stamp, latitude=latitude, longitude=longitude, height=height,
                         yaw=0.1 * k, pitch=0.02, roll=-0.01)
        wanted = [matrix(1.2 * k, 0.5 * k, 0.1 * k, 0.1 * k, 0.02, -0.01) for k in range(12)]
        np.testing.assert_allclose(poses_of(give), wanted, atol=2e-3)

    def test_the_antenna_is_off_the_origin_of_the_vehicle(self):
        def give(tracker, stamp, k):
            latitude, longitude, height = place(1.2 * k, 0)
            tracker.pose(stamp, latitude=latitude, longitude=longitude, height=height,
                         yaw=np.pi / 2, antenna=(-1, 0.5, 1.8))
        wanted = [matrix(1.2 * k + 0.5, 1, -1.8, np.pi / 2) for k in range(12)]
        np.testing.assert_allclose(poses_of(give), wanted, atol=2e-3)

    def test_the_origin_may_be_given_and_heights_left_out(self):
        def give(tracker, stamp, k):
            latitude, longitude, _ = place(100 + 1.2 * k, 50)
            tracker.pose(stamp, latitude=latitude, longitude=longitude, yaw=0)
        origin = {"ego.origin": ", ".join(str(x) for x in ORIGIN)}
        wanted = [matrix(100 + 1.2 * k, 50, 0, 0) for k in range(12)]
        np.testing.assert_allclose(poses_of(give, overrides=origin), wanted, atol=5e-3)

    def test_without_a_heading_it_is_found_on_the_way(self):
        noise = np.random.default_rng(3).normal(0, 0.02, (200, 2))

        def give(tracker, stamp, k):
            latitude, longitude, height = place(0.6 * k + noise[k, 0], 0.8 * k + noise[k, 1])
            tracker.pose(stamp, latitude=latitude, longitude=longitude, height=height, sigma_xy=0.02)
        last = poses_of(give, 120)[-1]
        np.testing.assert_allclose(last[:2, 3], [0.6 * 119, 0.8 * 119], atol=0.3)
        self.assertAlmostEqual(np.arctan2(last[1, 0], last[0, 0]), np.arctan2(0.8, 0.6), delta=0.05)

    def test_half_a_position_and_two_poses_are_errors(self):
        self.fails("expected T, or latitude and longitude", 64)
        self.fails("expected T, or latitude and longitude", 64, latitude=48.0)
        self.fails("expected T, or latitude and longitude", 64, np.eye(4), latitude=48.0,
                   longitude=11.0)
        self.fails("expected T, or latitude and longitude", 64, np.eye(4), yaw=1.0)
        self.fails("are of a pose with yaw", 64, latitude=48.0, longitude=11.0, pitch=0.1)

    def test_places_that_are_none_are_errors(self):
        self.fails("latitude: 98", 65, latitude=98.0, longitude=11.0)
        self.fails("longitude: nan", 65, latitude=48.0, longitude=float("nan"))
        self.fails("that have no position", 65, latitude=0.0, longitude=0.0, yaw=0.0)
        self.fails("height: not finite", 65, latitude=48.0, longitude=11.0, height=float("inf"))
        self.fails("negative or NaN", 65, latitude=48.0, longitude=11.0, sigma_xy=-1.0)

    def test_heights_are_of_all_poses_or_of_none(self):
        tracker = perception.Tracker("demo.ini", "L")
        tracker.pose(1e9, latitude=48.0, longitude=11.0, height=500.0, yaw=0.0)
        with self.assertRaisesRegex(perception.Error, "of all poses of a tracker or of none"):
            tracker.pose(1e9 + 0.1, latitude=48.0, longitude=11.0, yaw=0.0)

    def test_fixes_that_the_source_of_poses_leaves_unread_are_errors(self):
        self.fails("are read by [ego] source = auto or fusion", 64, latitude=48.0, longitude=11.0,
                   overrides={"ego.source": "lidar"})


if __name__ == "__main__":
    unittest.main()
