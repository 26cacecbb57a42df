"""The examples in Python, as a stranger would run them."""
import contextlib
import importlib.util
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import perception

SOURCE = os.environ["PERCEPTION_SOURCE_DIR"]
LOG = os.path.join(SOURCE, "rawlogs", "demo.rawlog")
TRUTH = os.path.join(SOURCE, "rawlogs", "demo.truth.csv")


def installed(*names):
    return all(importlib.util.find_spec(name) for name in names)


def write_scans(folder, count):
    """Scans of the demo as KITTI has them; their stamps."""
    os.makedirs(folder)
    scans = [o for o in perception.open(LOG) if o.kind == "lidar"][:count]
    for k, scan in enumerate(scans):
        points = np.column_stack([scan.data["xyz"], scan.data["intensity"]]).astype(np.float32)
        points.tofile(os.path.join(folder, f"{k:06}.bin"))
    return [scan.stamp_ns for scan in scans]


def write_sequence(folder):
    """The demo as a sequence of KITTI's; its world begins at the first pose."""
    stamps = write_scans(os.path.join(folder, "velodyne"), 1000)
    at = {o.stamp_ns: o.data["pose"] for o in perception.open(LOG) if o.kind == "pose"}
    mount = np.eye(4)
    mount[2, 3] = 1.73
    start = at[stamps[0]]
    rows = [np.linalg.inv(start @ mount) @ at[stamp] @ mount for stamp in stamps]
    np.savetxt(os.path.join(folder, "poses.txt"), [T[:3].ravel() for T in rows])
    np.testing.assert_array_equal(start[:3, :3], np.eye(3))  # so that headings stay
    with open(TRUTH, encoding="utf-8") as file:
        lines = file.read().splitlines()
    with open(os.path.join(folder, "truth.csv"), "w", encoding="utf-8") as file:
        file.write(lines[0] + "\n")
        for line in lines[1:]:
            cells = line.split(",")
            for column, shift in zip((4, 5, 6), start[:3, 3]):
                cells[column] = str(float(cells[column]) - shift)
            file.write(",".join(cells) + "\n")


def run(name, *arguments):
    path = os.path.join(SOURCE, "examples", "python", name)
    said = subprocess.run([sys.executable, path, *arguments], capture_output=True, text=True,
                          check=False)
    return said.returncode, said.stdout, said.stderr


class Examples(unittest.TestCase):
    def test_a_car_of_a_detector_keeps_its_id_and_is_as_fast_as_it_drives(self):
        code, out, err = run("detector_boxes.py")
        self.assertEqual(code, 0, err)
        lines = out.splitlines()
        self.assertGreater(len(lines), 15)
        self.assertEqual({line.split()[0] for line in lines}, {"1"})
        speed = float(lines[-1].rsplit("[", 1)[1].split()[0])
        self.assertAlmostEqual(speed, 10, delta=1)  # [m/s] a meter each tenth of a second

    def test_a_folder_of_scans_is_tracked_without_poses(self):
        with tempfile.TemporaryDirectory() as folder:
            scans = os.path.join(folder, "scans")
            write_scans(scans, 12)
            code, out, err = run("kitti_scans.py", scans)
        self.assertEqual(code, 0, err)
        self.assertEqual(out.count("["), 12)

    def test_a_front_end_of_ten_lines_finds_the_objects_near_by(self):
        code, out, err = run("slice_front_end.py", LOG, TRUTH)
        self.assertEqual(code, 0, err)
        said = re.search(r"(\d+) % of the objects within 20 m tracked, (\d\.\d+) m off", out)
        self.assertGreater(int(said[1]), 80)
        self.assertLess(float(said[2]), 1)

    @unittest.skipUnless(installed("matplotlib"), "python3-matplotlib is not installed")
    def test_a_loop_over_seeds_draws_a_curve(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, "seeds.png")
            code, out, err = run("seeds.py", picture, LOG, TRUTH, "2")
            self.assertEqual(code, 0, err)
            self.assertIn("GOSPA", out.splitlines()[-1])
            import matplotlib.image
            pixels = matplotlib.image.imread(picture)
        self.assertEqual(pixels.shape[:2], (576, 768))
        self.assertGreater(len(np.unique(pixels.reshape(-1, pixels.shape[2]), axis=0)), 50)


class Notebook(unittest.TestCase):
    @unittest.skipUnless(installed("nbclient", "nbformat", "ipykernel", "matplotlib"),
                         "python3-nbclient, python3-ipykernel, python3-matplotlib are not installed")
    def test_the_notebook_runs_to_its_picture_and_its_score(self):
        import nbclient
        import nbformat
        notebook = nbformat.read(os.path.join(SOURCE, "examples", "python", "kitti_notebook.ipynb"), 4)
        self.assertFalse(any(cell.get("outputs") for cell in notebook.cells))  # none is committed
        with tempfile.TemporaryDirectory() as folder:
            write_sequence(os.path.join(folder, "kitti"))
            os.environ["RATE"] = "10"
            try:
                nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3",
                                        resources={"metadata": {"path": folder}}).execute()
            finally:
                del os.environ["RATE"]
            self.assertTrue(os.path.exists(os.path.join(folder, "tracks.png")))
        outputs = [out for cell in notebook.cells for out in cell.get("outputs", [])]
        self.assertTrue(any("image/png" in out.get("data", {}) for out in outputs))
        text = "".join(out.get("text", "") for out in outputs)
        self.assertIn("111 scans, 111 poses", text)
        tracked = re.search(r"within 20 m: (\d+)% tracked, (\d+)% of the right class", text)
        self.assertGreater(int(tracked[1]), 90)
        self.assertGreater(int(tracked[2]), 80)


class FirstHour(unittest.TestCase):
    """The five programs of examples/python/README.md, by what they say."""

    @classmethod
    def setUpClass(cls):
        with open(os.path.join(SOURCE, "examples", "python", "README.md"), encoding="utf-8") as file:
            cls.programs = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        cls.folder = tempfile.TemporaryDirectory()
        write_scans(os.path.join(cls.folder.name, "scans"), 20)
        for file in (LOG, TRUTH):
            shutil.copy(file, cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def said(self, number):
        said = subprocess.run([sys.executable, "-c", self.programs[number]], capture_output=True,
                              text=True, check=False, cwd=self.folder.name)
        self.assertEqual(said.returncode, 0, said.stderr)
        return said.stdout

    def test_there_are_five(self):
        self.assertEqual(len(self.programs), 5)

    def test_the_way_of_the_vehicle(self):
        self.assertRegex(self.said(0), r"^20 poses, the last at \[")
        poses = np.loadtxt(os.path.join(self.folder.name, "poses.txt"))
        self.assertEqual(poses.shape, (20, 12))
        # Against the poses of the log, once the odometry has found the speed of the vehicle.
        observations = list(perception.open(LOG))
        logged = {o.stamp_ns: o.data["pose"][:2, 3] for o in observations if o.kind == "pose"}
        true = [logged[o.stamp_ns] for o in observations if o.kind == "lidar"]
        driven = np.linalg.norm(poses[19, [3, 7]] - poses[4, [3, 7]])
        self.assertAlmostEqual(driven, np.linalg.norm(true[19] - true[4]), delta=0.2)

    def test_boxes_hold_returns(self):
        counts = re.findall(r"(\d+) returns inside", self.said(1))
        self.assertGreater(len(counts), 2)
        self.assertGreater(sum(int(count) > 0 for count in counts), len(counts) / 2)

    def test_a_prediction_with_its_covariance(self):
        out = self.said(2)
        self.assertRegex(out, r"in a second \[.*\] \+- \[.*\] m\nseen in \d+ of 111 scenes")

    def test_ids_of_boxes(self):
        ids = [line.split()[:2] for line in self.said(3).splitlines()]
        self.assertEqual(ids, [["1", "car"], ["2", "car"]])

    def test_a_parameter_changes_the_score(self):
        scores = re.findall(r"association \w+: .*GOSPA ([\d.]+) m", self.said(4))
        self.assertEqual(len(scores), 3)
        self.assertGreater(len(set(scores)), 1)


class Readme(unittest.TestCase):
    """The lines in Python of README.md, with the scans of the demo."""

    def test_scans_become_scenes(self):
        with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        self.assertEqual(len(blocks), 1)
        begin, each = blocks[0].split("tracker.pose", 1)
        names, scenes = {}, 0
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(begin, names)
            for observation in perception.open(LOG):
                if observation.kind == "pose":
                    names["T"] = observation.data["pose"]
                if observation.kind != "lidar" or "T" not in names:
                    continue
                names.update(stamp=observation.stamp_ns * 1e-9, xyz=observation.data["xyz"],
                             intensity=observation.data["intensity"], mount=observation.sensor_pose)
                exec("tracker.pose" + each, names)
                scenes += names["scene"] is not None
        self.assertGreater(scenes, 100)
        self.assertIn("'car'", said.getvalue())


if __name__ == "__main__":
    unittest.main()
