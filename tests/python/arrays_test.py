"""Arrays and stamps of perception.Tracker: what is taken, and what happens to those that do not fit."""
import os
import unittest

import numpy as np

import perception
from tracker_test import INI, cloud


class Arrays(unittest.TestCase):
    def setUp(self):
        self.tracker = perception.Tracker(INI, sensors="L")

    def fails(self, text, code, call, *arguments, **options):
        with self.assertRaises(perception.Error) as caught:
            call(*arguments, **options)
        self.assertIn(text, str(caught.exception))
        self.assertEqual(caught.exception.code, code)

    def test_wrong_shapes_are_errors_that_say_what_was_expected(self):
        scan = self.tracker.scan
        self.fails("xyz: shape (3, 2000), expected (n, 3)", 65, scan, "LIDAR_TOP", 1.0, cloud().T)
        self.fails("give xyz[:, :3]", 65, scan, "LIDAR_TOP", 1.0, np.zeros((5, 4), np.float32))
        self.fails("intensity: shape (1999,), expected (2000,)", 65, scan, "LIDAR_TOP", 1.0,
                   cloud(), np.zeros(1999))
        self.fails("T: shape (3, 3), expected (4, 4)", 65, self.tracker.pose, 1.0, np.eye(3))

    def test_wrong_dtypes_are_errors(self):
        scan = self.tracker.scan
        self.fails("xyz: dtype int64", 65, scan, "LIDAR_TOP", 1.0, np.ones((5, 3), np.int64))
        self.fails("intensity: dtype <U1, expected numbers", 65, scan, "LIDAR_TOP", 1.0, cloud(2),
                   np.array(["a", "b"]))
        self.fails("ring: dtype float64, expected whole numbers", 65, scan, "LIDAR_TOP", 1.0,
                   cloud(2), None, np.zeros(2))
        self.fails("ring[1]: 70000, expected 0 to 65535", 65, scan, "LIDAR_TOP", 1.0, cloud(2),
                   None, [0, 70000])
        self.fails("xyz: dtype >f4, expected float32", 65, scan, "LIDAR_TOP", 1.0,
                   cloud(2).astype(">f4"))

    def test_small_stamps_are_as_good_as_those_of_today(self):
        results = []
        for start in (0.1, 1.7e9):
            tracker, scenes = perception.Tracker(INI, sensors="L"), []
            for k in range(8):
                tracker.pose(start + k / 10, np.eye(4))
                scene = tracker.scan("LIDAR_TOP", start + k / 10, cloud())
                scenes += [] if scene is None else [scene]
            results.append([s.objects["position"].tolist() for s in scenes + tracker.finish()])
        self.assertEqual(len(results[0]), 8)
        self.assertEqual([len(x) for x in results[0]], [len(x) for x in results[1]])
        for small, today in zip(*results):
            np.testing.assert_allclose(small, today, atol=1e-3)

    def test_absolute_times_of_returns_are_errors_that_say_what_to_give(self):
        scan = self.tracker.scan
        for times in (1.7e9 + np.linspace(0, 0.1, 2000), np.arange(2000) * 50_000,
                      1.7e9 + np.linspace(0, 0.1, 2000).astype(np.float32)):
            self.fails("(time - stamp)", 65, scan, "LIDAR_TOP", 1.7e9, cloud(), time=times)
        scan("LIDAR_TOP", 1.7e9, cloud(), time=np.linspace(-0.1, 0, 2000))

    def test_poses_that_are_none_are_errors(self):
        self.fails("is no rotation", 65, self.tracker.pose, 1.0, 2 * np.eye(4))
        self.fails("not finite", 65, self.tracker.pose, 1.0, np.full((4, 4), np.nan))

    def test_sensors_that_the_ini_has_not_are_errors(self):
        self.fails("no [sensor.TOP]; it has LIDAR_TOP, CAMERA", 64, self.tracker.scan, "TOP", 1.0,
                   cloud())
        self.fails("[sensor.CAMERA] has kind = boxes", 64, self.tracker.scan, "CAMERA", 1.0,
                   cloud())

    def test_errors_of_the_ini_come_with_the_code_of_the_programs(self):
        self.fails("nowhere.ini", 78, perception.Tracker, "nowhere.ini")
        self.fails("no_such_key", 78, perception.Tracker, INI, overrides={"run.no_such_key": 1})
        for name in ("help", "info", "print-config"):  # of command lines
            self.fails(name, 78, perception.Tracker, INI, overrides={name: True})

    def test_stamps_are_seconds_nanoseconds_or_datetime64(self):
        stamps = []
        for stamp in (1700000000.0, 1700000000 * 10**9, np.datetime64("2023-11-14T22:13:20"),
                      np.float64(1.7e9), np.int64(1700000000 * 10**9)):
            tracker = perception.Tracker(INI, sensors="L")
            tracker.pose(stamp, np.eye(4))
            tracker.scan("LIDAR_TOP", stamp, cloud())
            stamps += [s.stamp_ns for s in tracker.finish()]
        self.assertEqual(stamps, [1700000000 * 10**9] * 5)

    def test_stamps_that_are_none_are_errors(self):
        pose = self.tracker.pose
        self.fails("whole numbers are nanoseconds", 65, pose, 5, np.eye(4))
        self.fails("no time since 1970", 65, pose, float("nan"), np.eye(4))
        self.fails("expected seconds", 65, pose, "now", np.eye(4))
        self.fails("1970 to 2106", 65, pose, -1.0, np.eye(4))
        for zero in (0.0, 0, np.datetime64(0, "s"), -0.0):
            self.fails("where time starts at 0, add an offset", 65, pose, zero, np.eye(4))
        self.fails("less than 64 bits", 65, pose, np.float32(1.7e9), np.eye(4))
        self.fails("expected one number", 65, pose, np.array([1.7e9, 1.8e9]), np.eye(4))

    def test_without_an_output_no_folder_is_made(self):
        before = set(os.listdir("."))
        perception.Tracker(INI, sensors="L", output=None).finish()
        self.assertEqual(set(os.listdir(".")), before)

    def scenes_of(self, points, intensity=None):
        tracker = perception.Tracker(INI, sensors="L")
        scenes = []
        for k in range(10):
            tracker.pose(1000 + k / 10, np.eye(4))
            scene = tracker.scan("LIDAR_TOP", 1000 + k / 10, points, intensity)
            scenes += [] if scene is None else [scene]
        return scenes + tracker.finish(), tracker

    def test_layout_does_not_matter(self):
        points = cloud()
        wide = np.zeros((len(points), 6), np.float32)
        wide[:, ::2] = points
        wanted = [s.objects.tobytes() for s in self.scenes_of(points)[0]]
        self.assertEqual(len(wanted), 10)
        for same in (wide[:, ::2], np.asfortranarray(points), points.astype(np.float64),
                     points[::-1].copy()[::-1]):
            self.assertEqual([s.objects.tobytes() for s in self.scenes_of(same)[0]], wanted)

    def test_fields_of_a_record_of_any_address_are_taken(self):
        points = cloud()
        record = np.zeros(len(points), np.dtype([("tag", "u1"), ("xyz", "f4", 3), ("intensity", "f4")]))
        record["xyz"], record["intensity"] = points, np.linspace(0, 1, len(points))
        self.assertFalse(record["xyz"].flags.aligned)
        same = self.scenes_of(record["xyz"], record["intensity"])[0]
        wanted = self.scenes_of(points, np.linspace(0, 1, len(points)).astype(np.float32))[0]
        self.assertEqual([s.objects.tobytes() for s in same], [s.objects.tobytes() for s in wanted])

    def test_a_scan_has_nothing_of_the_one_before(self):
        seen = []
        perception.front_end("frames_of_a_tracker", lambda frame: seen.append(
            (frame.sensor_pose.copy(), {k: v for k, v in frame.data.items() if v is not None})))
        tracker = perception.Tracker(
            "include = classes.ini\n[sensor.LIDAR_TOP]\nkind = frames_of_a_tracker\nmodality = L\n"
            "range_max = 40\nfov_deg = 360\n", sensors="L")
        mount = np.eye(4)
        mount[:3, 3] = 1, 2, 3
        n = 2000
        tracker.scan("LIDAR_TOP", 1000.0, cloud(), np.ones(n), np.ones(n, np.uint16), np.zeros(n),
                     sensor_pose=mount, max_range=50, echo=np.zeros(n, np.uint8), pulse_width=np.ones(n),
                     label=np.zeros(n, np.uint8))
        tracker.scan("LIDAR_TOP", 1000.1, cloud(300, 1))
        tracker.finish()
        pose, data = seen[-1]
        self.assertEqual(len(seen), 2)
        np.testing.assert_array_equal(data["xyz"], cloud(300, 1))
        self.assertEqual(data["max_range"], 0)
        self.assertFalse({"intensity", "ring", "time", "echo", "pulse_width", "label"} & set(data))
        np.testing.assert_array_equal(pose, np.eye(4))

    def test_a_scan_that_fails_leaves_the_tracker_as_it_was(self):
        points, results = cloud(), []
        for wrong in (False, True):
            tracker = perception.Tracker(INI, sensors="L")
            for k in range(5):
                if wrong:
                    self.fails("time: 99", 65, tracker.scan, "LIDAR_TOP", 1000 + k / 10, 2 * points,
                               time=np.full(len(points), 99))
                tracker.scan("LIDAR_TOP", 1000 + k / 10, points)
            results.append([s.objects.tobytes() for s in tracker.finish()])
        self.assertEqual(results[0], results[1])

    def test_stamps_out_of_order_within_the_window_are_sorted(self):
        results = []
        for order in ((0, 1, 2, 3, 4, 5), (0, 2, 1, 3, 5, 4)):
            tracker = perception.Tracker(INI, sensors="L", overrides={"run.output_lag": 0})
            scenes = [tracker.scan("LIDAR_TOP", 1000 + k / 10, cloud(seed=k)) for k in order]
            scenes = [s for s in scenes + tracker.finish() if s is not None]
            results.append([(s.stamp_ns, s.objects.tobytes()) for s in scenes])
        self.assertEqual(results[0], results[1])
        self.assertEqual([stamp for stamp, _ in results[0]],
                         [1000 * 10**9 + k * 10**8 for k in range(6)])

    def test_a_clock_that_goes_back_starts_anew_with_an_event(self):
        for stamp in (100.0, 100.1, 50.0, 50.1):
            self.tracker.scan("LIDAR_TOP", stamp, cloud())
        self.tracker.finish()
        self.assertIn("the clock went back by 50.1",
                      "".join(e["message"] for e in self.tracker.events()))

    def test_returns_that_are_not_finite_are_dropped(self):
        points = cloud()
        hole = np.vstack([points, np.full((7, 3), np.nan, np.float32)])
        self.assertEqual([s.objects.tobytes() for s in self.scenes_of(hole)[0]],
                         [s.objects.tobytes() for s in self.scenes_of(points)[0]])

    def test_a_scan_without_returns_is_one(self):
        scenes, _ = self.scenes_of(np.zeros((0, 3), np.float32))
        self.assertEqual([len(s.objects) for s in scenes], [0] * 10)
        self.assertEqual(scenes[0].objects.shape, (0,))

    def test_what_is_later_than_the_window_is_dropped_with_an_event(self):
        tracker = self.tracker
        for stamp in (100.0, 100.1, 100.5, 100.9, 100.2):
            tracker.scan("LIDAR_TOP", stamp, cloud())
        tracker.finish()
        self.assertEqual([e["kind"] for e in tracker.events()].count("out_of_order"), 1)

    def test_nothing_is_taken_after_the_end(self):
        self.tracker.finish()
        self.assertEqual(self.tracker.finish(), [])
        self.fails("has finished", 64, self.tracker.scan, "LIDAR_TOP", 1.0, cloud())

    def test_results_outlive_arrays_and_tracker(self):
        points = cloud()
        tracker = perception.Tracker(INI, sensors="L")
        tracker.scan("LIDAR_TOP", 100.0, points)
        points[:] = np.nan
        del points
        scene, = tracker.finish()
        before = scene.objects
        del tracker
        self.assertEqual(scene.objects.tobytes(), before.tobytes())


if __name__ == "__main__":
    unittest.main()
