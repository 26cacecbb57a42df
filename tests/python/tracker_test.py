"""perception.Tracker: arrays in, scenes out, and what happens to arrays that do not fit."""
import os
import signal
import tempfile
import threading
import unittest

import numpy as np

import perception

SOURCE = os.environ["PERCEPTION_SOURCE_DIR"]
LOG = os.path.join(SOURCE, "rawlogs", "demo.rawlog")
INI = "demo.ini"


def feed(tracker, observations, scenes):
    """Hands a log's arrays to the tracker, as a program would that has them from elsewhere."""
    for o in observations:
        data, scene = o.data, None
        if o.kind == "pose":
            tracker.pose(o.stamp_ns, data["pose"])
        elif o.kind == "frame":
            tracker.frame(o.stamp_ns, data["number"])
        elif o.kind == "lidar":
            scene = tracker.scan(o.sensor, o.stamp_ns, data["xyz"], data["intensity"], data["ring"],
                                 data["time"], sensor_pose=o.sensor_pose,
                                 max_range=data["max_range"], echo=data["echo"],
                                 pulse_width=data["pulse_width"], label=data["label"])
        elif o.kind == "boxes":
            scene = tracker.image_boxes(o.sensor, o.stamp_ns, data["image_boxes"], data["scores"],
                                        data["labels"], data["camera"], headings=data["headings"],
                                        sensor_pose=o.sensor_pose)
        elif o.kind == "radar":
            r, b, rate, amplitude, elevation = data["targets"].T
            scene = tracker.radar(o.sensor, o.stamp_ns, r, b, rate, amplitude=amplitude,
                                  elevation=elevation, sensor_pose=o.sensor_pose,
                                  max_range=data["max_range"])
        if scene is not None:
            scenes.append(scene)
    scenes += tracker.finish()
    return scenes


def read(*path):
    with open(os.path.join(*path), "rb") as file:
        return file.read()


def cloud(n=2000, seed=0):
    """Points [m] around a lidar, for tests of what arrays are taken."""
    return np.random.default_rng(seed).uniform(-20, 20, (n, 3)).astype(np.float32)


class Rows(unittest.TestCase):
    def test_arrays_give_the_rows_of_the_program(self):
        for log, ini, sensors, overrides in (
                ("demo", INI, "", {}),
                ("demo", INI, "L", {"run.seed": 2, "run.association": "sampled"}),
                ("radar", "skynet.ini", "R", {})):
            with self.subTest(log=log, sensors=sensors), tempfile.TemporaryDirectory() as folder:
                path = os.path.join(SOURCE, "rawlogs", log + ".rawlog")
                run = perception.track(path, ini, sensors=sensors, overrides=overrides)
                out = os.path.join(folder, "arrays")
                tracker = perception.Tracker(ini, sensors, overrides, out)
                scenes = feed(tracker, perception.open(path), [])
                self.assertEqual(len(scenes), len(run.scenes))
                self.assertGreater(len(run.tracks), 20)
                for name in ("tracks.csv", "scenes.csv"):
                    self.assertEqual(read(out, name), read(run.folder, name), name)

    def test_observations_of_a_log_are_taken_as_they_are(self):
        run = perception.track(LOG, INI)
        with tempfile.TemporaryDirectory() as folder:
            tracker = perception.Tracker(INI, output=folder)
            for observation in perception.open(LOG):
                tracker.add(observation)
            tracker.finish()
            self.assertEqual(read(folder, "tracks.csv"), read(run.folder, "tracks.csv"))

    def test_records_hold_the_columns_of_the_table(self):
        run = perception.track(LOG, INI)
        tracker = perception.Tracker(INI)
        scenes = feed(tracker, perception.open(LOG), [])
        objects = np.concatenate([s.objects for s in scenes])
        columns = np.array([list(run.tracks[c]) for c in ("id", "x", "y", "z", "vx", "length")])
        records = np.array([objects["id"], *objects["position"].T, objects["velocity"][:, 0],
                            objects["size"][:, 0]])
        np.testing.assert_allclose(records, columns, atol=6e-4)
        self.assertEqual(list(objects["class"]), list(run.tracks["class"]))
        self.assertEqual(tracker.classes, run.classes)
        np.testing.assert_allclose(objects["class_probability"].sum(axis=1), 1, atol=1e-9)
        distance = [np.nan if s.free_distance is None else s.free_distance for s in scenes]
        np.testing.assert_allclose(distance, run.scenes["free_distance"], atol=6e-3)
        self.assertEqual([s.frame for s in scenes], list(run.scenes["frame"]))

    def test_covariances_are_those_of_the_standard_deviations_and_no_less(self):
        tracker = perception.Tracker(INI)
        objects = np.concatenate([s.objects for s in feed(tracker, perception.open(LOG), [])])
        C = objects["covariance"]
        self.assertEqual(C.shape, (len(objects), 4, 4))
        np.testing.assert_array_equal(C, C.transpose(0, 2, 1))
        self.assertGreaterEqual(np.linalg.eigvalsh(C).min(), -1e-9)
        np.testing.assert_array_equal(np.sqrt(C[:, [0, 1], [0, 1]]), objects["position_sd"])
        np.testing.assert_allclose(objects["yaw_variance"], objects["yaw_sd"]**2)
        # Of objects without a heading the speed is along the velocity.
        plain = objects[(objects["p_front"] == 0.5) & (objects["speed"] > 0.01)]
        along = plain["velocity"] / plain["speed"][:, None]
        variance = np.einsum("ni,nij,nj->n", along, plain["covariance"][:, 2:, 2:], along)
        self.assertGreater(len(plain), 20)
        self.assertGreater(np.mean(np.isclose(np.sqrt(variance), plain["speed_sd"])), 0.5)


class Boxes(unittest.TestCase):
    def scenes_of(self, boxes, z):
        tracker = perception.Tracker("kitti-detections.ini")
        scenes = []
        for k in range(8):
            tracker.pose(1000 + k / 10, np.eye(4))
            scene = tracker.boxes("pointrcnn", 1000 + k / 10, boxes, [9.0] * len(boxes),
                                  ["Car"] * len(boxes), z=z)
            scenes += [] if scene is None else [scene]
        return scenes + tracker.finish()

    def test_boxes_of_a_detector_are_tracked(self):
        objects = self.scenes_of([[15, 3, 0, 4.2, 1.8, 1.5, 0.1]], "bottom")[-1].objects
        self.assertEqual(list(objects["class"]), ["car"])
        np.testing.assert_allclose(objects["position"][0, :2], [15, 3], atol=0.3)

    def test_heights_are_of_the_bottom_or_the_center(self):
        bottom = self.scenes_of([[15, 3, 0, 4.2, 1.8, 1.5, 0.1]], "bottom")[-1].objects
        center = self.scenes_of([[15, 3, 0.75, 4.2, 1.8, 1.5, 0.1]], "center")[-1].objects
        self.assertEqual(bottom.tobytes(), center.tobytes())

    def test_a_frame_without_boxes_is_one(self):
        self.assertEqual([len(s) for s in self.scenes_of([], "bottom")], [0] * 8)

    def test_boxes_that_are_not_finite_are_dropped(self):
        car = [15, 3, 0, 4.2, 1.8, 1.5, 0.1]
        wanted = self.scenes_of([car], "bottom")
        for column in range(7):
            hole = list(car)
            hole[column] = np.nan
            with self.subTest(column=column):
                self.assertEqual([s.objects.tobytes() for s in self.scenes_of([car, hole], "bottom")],
                                 [s.objects.tobytes() for s in wanted])

    def test_labels_are_one_a_box(self):
        tracker = perception.Tracker("kitti-detections.ini")
        with self.assertRaisesRegex(perception.Error, "labels: 0, expected 1"):
            tracker.boxes("pointrcnn", 1.0, np.zeros((1, 7)), [1.0], [], z="bottom")


class Threads(unittest.TestCase):
    def test_two_trackers_in_two_threads_give_what_each_gives_alone(self):
        observations = list(perception.open(LOG))
        results = {}

        def work(name):
            scenes = feed(perception.Tracker(INI), observations, [])
            results[name] = [s.objects.tobytes() for s in scenes]

        work("alone")
        threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results[0], results["alone"])
        self.assertEqual(results[1], results["alone"])

    def test_two_threads_may_feed_one_tracker(self):
        clouds = [cloud(seed=seed) for seed in range(2)]
        tracker = perception.Tracker(INI, sensors="L", overrides={"run.reorder_window": 10})
        failures = []

        def work(odd):
            try:
                for k in range(odd, 40, 2):
                    tracker.scan("LIDAR_TOP", 1000 + k / 10, clouds[odd])
            except BaseException as failure:
                failures.append(failure)

        threads = [threading.Thread(target=work, args=(odd,)) for odd in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        alone = perception.Tracker(INI, sensors="L", overrides={"run.reorder_window": 10})
        for k in range(40):
            alone.scan("LIDAR_TOP", 1000 + k / 10, clouds[k % 2])
        self.assertEqual([s.objects.tobytes() for s in tracker.finish()],
                         [s.objects.tobytes() for s in alone.finish()])

    def test_others_run_while_a_tracker_computes(self):
        stopped, turns = threading.Event(), [0]

        def count():
            while not stopped.is_set():
                turns[0] += 1

        counter = threading.Thread(target=count)
        tracker = perception.Tracker(INI, sensors="L")
        observations = [o for o in perception.open(LOG) if o.kind in ("lidar", "pose")]
        scans = [(o, o.data["xyz"]) for o in observations if o.kind == "lidar"][:20]
        counter.start()
        most = 0
        for o, xyz in scans:
            before = turns[0]
            tracker.scan(o.sensor, o.stamp, xyz)
            most = max(most, turns[0] - before)
        stopped.set()
        counter.join()
        self.assertGreater(most, 0)

    def test_ctrl_c_ends_a_program_as_it_ends_python(self):
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        with self.assertRaises(KeyboardInterrupt):
            timer.start()
            for seed in range(1000):
                perception.track(LOG, INI, overrides={"run.seed": seed})
        timer.join()
        self.assertGreater(len(perception.track(LOG, INI).scenes), 100)  # the next one runs

    def test_ctrl_c_ends_a_loop_over_scans_and_the_tracker_goes_on(self):
        tracker = perception.Tracker(INI, sensors="L")
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        k = 0
        with self.assertRaises(KeyboardInterrupt):
            timer.start()
            while True:
                tracker.scan("LIDAR_TOP", 1000 + k / 10, cloud())
                k += 1
        timer.join()
        tracker.scan("LIDAR_TOP", 1000 + (k + 1) / 10, cloud())
        self.assertEqual(tracker.finish()[-1].stamp_ns, 1000 * 10**9 + (k + 1) * 10**8)


if __name__ == "__main__":
    unittest.main()
