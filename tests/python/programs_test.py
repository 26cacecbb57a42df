"""perception.track, evaluate, simulate and open: what the programs write, as tables."""
import os
import subprocess
import tempfile
import unittest

import numpy as np

import perception

SOURCE = os.environ["PERCEPTION_SOURCE_DIR"]
LOG = os.path.join(SOURCE, "rawlogs", "demo.rawlog")
TRUTH = os.path.join(SOURCE, "rawlogs", "demo.truth.csv")


class Programs(unittest.TestCase):
    def test_track_gives_the_tables_that_the_run_holds(self):
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "run")
            run = perception.track(LOG, "demo.ini", out, overrides={"run.seed": 3}, threads=1)
            with open(os.path.join(out, "tracks.csv"), encoding="utf-8") as file:
                self.assertEqual(len(run.tracks), len(file.readlines()) - 1)
            self.assertEqual(run.record["seed"], 3)
            self.assertEqual(len(run.scenes), 111)
            again = perception.Run(out)
            self.assertEqual(list(again.tracks["id"]), list(run.tracks["id"]))

    def test_evaluate_finds_the_objects_of_the_demo(self):
        report = perception.evaluate(perception.track(LOG, "demo.ini"), TRUTH, range=20)
        self.assertIn("runs", report)
        self.assertEqual(len(report["runs"]), 1)

    def test_simulate_gives_a_log_with_its_truth(self):
        made = perception.simulate(os.path.join(SOURCE, "ini", "scenarios", "demo.ini"), seed=4,
                                   overrides={"scenario.duration": 1})
        kinds = [o.kind for o in perception.open(made.log)]
        self.assertGreater(kinds.count("lidar"), 8)
        self.assertIn("Pedestrian", list(made.truth["class"]))

    def test_errors_have_text_and_code_of_the_program(self):
        for arguments, code, text in (
                (("nowhere.rawlog", "demo.ini"), 66, "nowhere.rawlog"),
                ((LOG, "demo.ini", None, "X"), 78, "sensors")):
            with self.assertRaises(perception.Error) as caught:
                perception.track(*arguments)
            self.assertEqual(caught.exception.code, code)
            self.assertIn(text, str(caught.exception))
        with self.assertRaises(perception.Error) as caught:
            perception.track(LOG, "demo.ini", no_such_option=1)
        self.assertEqual(caught.exception.code, 64)

    def test_options_that_end_a_program_early_are_refused(self):
        for name in ("help", "info", "print_config", "version"):
            with self.assertRaisesRegex(perception.Error, f"{name} ends the program before") as caught:
                perception.track(LOG, "demo.ini", **{name: True})
            self.assertEqual(caught.exception.code, 64)
        scenario = os.path.join(SOURCE, "ini", "scenarios", "demo.ini")
        with self.assertRaisesRegex(perception.Error, "run perception-simulate --contact-sheet"):
            perception.simulate(scenario, contact_sheet="a.png")
        with self.assertRaisesRegex(perception.Error, "input is said by an argument"):
            perception.track(LOG, "demo.ini", input=LOG)


class Logs(unittest.TestCase):
    def test_observations_come_as_arrays(self):
        observations = list(perception.open(LOG))
        lidar = next(o for o in observations if o.kind == "lidar")
        self.assertEqual((lidar.sensor, lidar.data["xyz"].dtype), ("LIDAR_TOP", np.float32))
        self.assertEqual(lidar.data["xyz"].shape, (len(lidar.data["intensity"]), 3))
        pose = next(o for o in observations if o.kind == "pose").data["pose"]
        np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
        boxes = next(o for o in observations if o.kind == "boxes" and o.data["labels"])
        self.assertEqual(boxes.data["image_boxes"].shape, (len(boxes.data["labels"]), 4))

    def test_images_come_as_pixels(self):
        path = os.path.join(SOURCE, "rawlogs", "camera.rawlog")
        image = next(o for o in perception.open(path) if o.kind == "image")
        self.assertEqual(image.data["pixels"].shape, (768, 1536, 3))

    def test_a_torn_log_gives_what_is_whole_and_then_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            torn = os.path.join(folder, "torn.rawlog")
            with open(LOG, "rb") as whole, open(torn, "wb") as file:
                file.write(whole.read()[:200000])
            count = 0
            with self.assertRaises(perception.Error) as caught:
                for _ in perception.open(torn):
                    count += 1
            self.assertGreater(count, 5)
            self.assertEqual(caught.exception.code, 65)

    def test_a_missing_log_is_an_error(self):
        with self.assertRaises(perception.Error) as caught:
            perception.open("nowhere.rawlog")
        self.assertEqual(caught.exception.code, 66)


class Hints(unittest.TestCase):
    def test_hints_name_what_there_is(self):
        path = os.path.join(os.path.dirname(perception.__file__), "__init__.pyi")
        with open(path, encoding="utf-8") as file:
            hints = file.read()
        for owner in (perception.Tracker, perception.Scene, perception.Observation):
            for name in vars(owner) | vars(owner.__mro__[1]):
                if not name.startswith("_") and name != "event_lines":
                    self.assertIn(f"def {name}(", hints, owner)
        for name in perception.__all__:
            self.assertRegex(hints, rf"(class|def) {name}\b")

    @unittest.skipUnless(os.path.exists("/usr/bin/mypy"), "mypy is not installed")
    def test_hints_are_sound_and_fit_the_examples(self):
        examples = os.path.join(SOURCE, "examples", "python")
        files = [os.path.join(examples, f) for f in sorted(os.listdir(examples)) if f[-3:] == ".py"]
        self.assertTrue(files)
        with tempfile.TemporaryDirectory() as cache:
            said = subprocess.run(["/usr/bin/mypy", "--cache-dir", cache, "-p", "perception"],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
            said = subprocess.run(["/usr/bin/mypy", "--cache-dir", cache, *files],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(said.returncode, 0, said.stdout + said.stderr)


if __name__ == "__main__":
    unittest.main()
