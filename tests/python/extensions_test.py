"""Front ends, motion models and classes written in Python, and what happens where they fail."""
import os
import threading
import unittest

import numpy as np

import perception

SOURCE = os.environ["PERCEPTION_SOURCE_DIR"]
LOG = os.path.join(SOURCE, "rawlogs", "demo.rawlog")
TRUTH = os.path.join(SOURCE, "rawlogs", "demo.truth.csv")


def ini_of(kind, **positions):
    """An INI with one lidar and a front end of this kind."""
    lines = ["include = classes.ini", "[sensor.LIDAR_TOP]", f"kind = {kind}", "modality = L",
             "range_max = 40", "fov_deg = 360", "[sensor.LIDAR_TOP.positions]"]
    return "\n".join(lines + [f"{key} = {value}" for key, value in positions.items()])


def tracker_of(kind, **positions):
    return perception.Tracker(ini_of(kind, **positions), "L")


def scenes_of(tracker, points=None, count=8):
    points = np.ones((5, 3), np.float32) if points is None else points
    scenes = []
    for k in range(count):
        tracker.pose(1000 + k / 10, np.eye(4))
        scene = tracker.scan("LIDAR_TOP", 1000 + k / 10, points)
        scenes += [] if scene is None else [scene]
    return scenes + tracker.finish()


class FrontEnds(unittest.TestCase):
    def fails(self, text, code, call, *arguments):
        with self.assertRaises(perception.Error) as caught:
            call(*arguments)
        self.assertIn(text, str(caught.exception))
        self.assertEqual(caught.exception.code, code)

    def test_points_of_a_function_are_tracked(self):
        perception.front_end("one_point", lambda frame: [[10.0, 2.0]])
        objects = scenes_of(tracker_of("one_point"))[-1].objects
        np.testing.assert_allclose(objects["position"][:, :2], [[10, 2]], atol=0.2)

    def test_boxes_with_scores_and_labels_are_those_of_the_same_positions(self):
        boxes = [[15, 3, 0, 4.2, 1.8, 1.5, 0.1], [20, -4, 0, 4.2, 1.8, 1.5, 0.2]]
        labels = {"labels": "car", "names": "Car=car"}
        perception.front_end("two_boxes", lambda frame: (boxes, [2.0, 3.0], ["Car", "Car"]))
        tracker = tracker_of("two_boxes", **labels)
        mine = scenes_of(tracker)
        tracker = tracker_of("positions", **labels)
        theirs = []
        for k in range(8):
            tracker.pose(1000 + k / 10, np.eye(4))
            scene = tracker.boxes("LIDAR_TOP", 1000 + k / 10, boxes, [2.0, 3.0], ["Car", "Car"],
                                  z="bottom")
            theirs += [] if scene is None else [scene]
        theirs += tracker.finish()
        self.assertEqual(len(mine[-1].objects), 2)
        self.assertEqual([s.objects.tobytes() for s in mine], [s.objects.tobytes() for s in theirs])

    def test_a_frame_holds_the_arrays_of_the_scan(self):
        seen = []

        @perception.front_end("looks")
        def looks(frame):
            seen.append(frame)

        points = np.arange(12, dtype=np.float32).reshape(4, 3)
        scenes_of(tracker_of("looks"), points, 1)
        frame, = seen
        self.assertEqual((frame.kind, frame.sensor, frame.stamp_ns),
                         ("lidar", "LIDAR_TOP", 1000 * 10**9))
        np.testing.assert_array_equal(frame.data["xyz"], points)
        np.testing.assert_array_equal(frame.pose, np.eye(4))
        np.testing.assert_array_equal(frame.sensor_pose, np.eye(4))
        self.assertEqual(len(frame.ground), 3)
        self.assertEqual(looks(frame), None)  # still the function

    def test_a_run_of_the_program_calls_it_with_any_number_of_threads(self):
        perception.front_end("nearest", lambda f: f.data["xyz"][
            [np.argmin(np.linalg.norm(f.data["xyz"], axis=1))], :2])
        runs = [perception.track(LOG, ini_of("nearest"), sensors="L", threads=threads) for threads in (1, 2)]
        self.assertGreater(len(runs[0].tracks), 50)
        tracks = []
        for run in runs:
            with open(os.path.join(run.folder, "tracks.csv"), "rb") as file:
                tracks.append(file.read())
        self.assertEqual(tracks[0], tracks[1])

    def test_an_exception_of_the_function_is_raised_by_the_call(self):
        def broken(frame):
            raise ZeroDivisionError("mine")
        perception.front_end("broken", broken)
        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            scenes_of(tracker_of("broken"))
        with self.assertRaisesRegex(ZeroDivisionError, "mine"):
            perception.track(LOG, ini_of("broken"), sensors="L")

    def test_what_it_returns_is_checked(self):
        for returned, text in (
                (np.zeros((2, 5)), "front end 'returns': boxes: shape (2, 5), expected (n, 7)"),
                ((np.zeros((2, 7)), [1]), "front end 'returns': scores: shape (1,), expected (2,)"),
                ((np.zeros((1, 7)), [1], []), "front end 'returns': labels: 0, expected 1"),
                ("boxes", "front end 'returns': boxes: "),
                ((1, 2, 3, 4), "front end 'returns': expected boxes")):
            perception.front_end("returns", lambda frame, r=returned: r)
            self.fails(text, 65, scenes_of, tracker_of("returns"))

    def test_boxes_that_are_not_finite_are_dropped(self):
        perception.front_end("partly", lambda frame: [[10.0, 2.0], [np.nan, 3.0]])
        self.assertEqual([len(s) for s in scenes_of(tracker_of("partly"))][-1], 1)

    def test_a_second_function_replaces_the_first_for_later_trackers(self):
        perception.front_end("again", lambda frame: [[10.0, 2.0]])
        first = tracker_of("again")
        perception.front_end("again", lambda frame: [[20.0, 2.0]])
        second = tracker_of("again")
        for tracker, x in ((first, 10), (second, 20)):
            place, = scenes_of(tracker)[-1].objects["position"]
            self.assertAlmostEqual(place[0], x, delta=0.2)

    def test_names_of_the_library_stay_and_only_functions_are_taken(self):
        self.fails("there is one of this name", 64, perception.front_end, "lidar", len)
        self.fails("expected a function", 64, perception.front_end, "mine", 3)
        self.fails("known are: lidar, boxes, radar, positions", 78, tracker_of, "no_such_kind")

    def test_confidence_cannot_be_learnt_of_a_function(self):
        perception.front_end("unsure", lambda frame: None)
        with self.assertRaisesRegex(perception.Error, "of kind = positions alone"):
            tracker_of("unsure", confidence="learnt")

    def test_a_front_end_that_calls_its_tracker_is_told_so(self):
        perception.front_end("returns_to_it", lambda frame: tracker.pending())
        tracker = tracker_of("returns_to_it")
        self.fails("it runs within one", 64, scenes_of, tracker)

    def test_trackers_of_two_threads_call_one_function(self):
        perception.front_end("shared", lambda frame: [[10.0, 2.0]])
        lengths = []
        threads = [threading.Thread(
            target=lambda: lengths.append(len(scenes_of(tracker_of("shared"))[-1])))
            for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(lengths, [1, 1])


def constant_velocity(x, dt, psd):
    """As the library's: white acceleration."""
    F = np.eye(4)
    F[0, 2] = F[1, 3] = dt
    Q = psd * np.kron(np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]]), np.eye(2))
    return F @ x, F, Q


class MotionModels(unittest.TestCase):
    def scenes_of(self, motion, path, name="pedestrian"):
        tracker = perception.Tracker(ini_of("positions"), "L", {
            f"class.{name}.motion": motion, f"class.{name}.position_psd": 0})
        scenes = []
        for k, place in enumerate(path):
            tracker.pose(1000 + k / 10, np.eye(4))
            box = [[*place, 0, 1, 1, 1.8, 0]]
            scene = tracker.boxes("LIDAR_TOP", 1000 + k / 10, box, [1.0], ["object"], z="bottom")
            scenes += [] if scene is None else [scene]
        return scenes + tracker.finish()

    def test_constant_velocity_written_in_python_is_that_of_the_library(self):
        perception.motion_model("by_hand", constant_velocity)
        path = [(5 + 0.15 * k, 3) for k in range(15)]
        mine, theirs = (self.scenes_of(m, path) for m in ("by_hand", "constant-velocity"))
        self.assertEqual(len(mine), 15)
        for a, b in zip(mine, theirs):
            np.testing.assert_allclose(a.objects["velocity"], b.objects["velocity"], atol=1e-6)
            np.testing.assert_allclose(a.objects["covariance"], b.objects["covariance"], atol=1e-6)

    def test_another_prediction_gives_another_result(self):
        @perception.motion_model("stops")
        def stops(x, dt, psd):
            F = np.diag([1.0, 1, 0, 0])
            return F @ x, F, np.diag([0.1, 0.1, 0.01, 0.01])

        path = [(5 + 0.15 * k, 3) for k in range(15)]
        class_of = [self.scenes_of(m, path)[-1].objects["class_probability"][0]
                    for m in ("stops", "constant-velocity")]
        self.assertGreater(np.abs(class_of[0] - class_of[1]).max(), 1e-3)

    def test_a_model_with_a_heading_gets_the_speed_along_it(self):
        states = []

        @perception.motion_model("along", has_heading=True)
        def along(x, dt, psd):
            states.append(x.copy())
            c, s = np.cos(x[3]), np.sin(x[3])
            F = np.eye(4)
            F[:2, 2:] = [[dt * c, -dt * x[2] * s], [dt * s, dt * x[2] * c]]
            return x + [dt * x[2] * c, dt * x[2] * s, 0, 0], F, np.diag([0.01, 0.01, 0.5, 0.05]) * dt

        scenes = self.scenes_of("along", [(5, -8 + 0.8 * k) for k in range(20)], "car")
        self.assertTrue(states)
        self.assertAlmostEqual(np.mean([abs(np.sin(x[3])) for x in states[-5:]]), 1, delta=0.1)
        self.assertEqual(len(scenes), 20)

    def test_what_it_returns_is_checked(self):
        path = [(5, 3)] * 5
        for returned, text in ((np.zeros(4), "motion model 'bad': expected (x, F, Q)"),
                               ((np.zeros(3), np.eye(4), np.eye(4)), "motion model 'bad': x: shape (3,)"),
                               ((np.zeros(4), np.eye(3), np.eye(4)), "motion model 'bad': F: shape (3, 3)"),
                               ((np.zeros(4), np.eye(4), np.full((4, 4), np.nan)), "Q: values that are")):
            perception.motion_model("bad", lambda x, dt, psd, r=returned: r)
            with self.assertRaises(perception.Error) as caught:
                self.scenes_of("bad", path)
            self.assertIn(text, str(caught.exception))

    def test_an_exception_is_raised_by_the_call(self):
        def broken(x, dt, psd):
            raise KeyError("mine")
        perception.motion_model("broken", broken)
        with self.assertRaisesRegex(KeyError, "mine"):
            self.scenes_of("broken", [(5, 3)] * 5)

    def test_names_of_the_library_stay(self):
        with self.assertRaisesRegex(perception.Error, "there is one of this name"):
            perception.motion_model("wheeled", constant_velocity)
        perception.motion_model("plain", constant_velocity)
        with self.assertRaisesRegex(perception.Error, "has_heading is not that of the first"):
            perception.motion_model("plain", constant_velocity, has_heading=True)


class Classes(unittest.TestCase):
    def test_a_class_is_data_of_the_configuration(self):
        scooter = {"motion": "wheeled", "length": 1.2, "width": 0.6, "height": 1.7, "prior": 0.2}
        tracker = perception.Tracker("\n".join(
            ["include = demo.ini", "[class.scooter]"] + [f"{k} = {v}" for k, v in scooter.items()]), "L")
        self.assertIn("scooter", tracker.classes)
        tracker.scan("LIDAR_TOP", 1000.0, np.random.default_rng(1).uniform(-9, 9, (500, 3)))
        for scene in tracker.finish():
            self.assertEqual(scene.objects["class_probability"].shape[1], len(tracker.classes))


if __name__ == "__main__":
    unittest.main()
