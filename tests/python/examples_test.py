"""The examples in Python, as a stranger would run them."""
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import perception

SOURCE = os.environ["PERCEPTION_SOURCE_DIR"]


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
        scans = [o for o in perception.open(os.path.join(SOURCE, "rawlogs", "demo.rawlog"))
                 if o.kind == "lidar"][:12]
        with tempfile.TemporaryDirectory() as folder:
            for k, scan in enumerate(scans):
                data = scan.data
                points = np.column_stack([data["xyz"], data["intensity"]]).astype(np.float32)
                points.tofile(os.path.join(folder, f"{k:06}.bin"))
            code, out, err = run("kitti_scans.py", folder)
        self.assertEqual(code, 0, err)
        self.assertEqual(out.count("["), 12)


if __name__ == "__main__":
    unittest.main()
