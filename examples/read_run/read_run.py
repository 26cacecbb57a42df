"""read_run.py DIR: the fastest road users of a run of perception-track; needs numpy alone.

perception_run is installed with the programs (share/perception/python).
"""
import sys

from perception_run import Run

run = Run(sys.argv[1])
print(f"{len(run.scenes)} scenes, {len(run.ids())} objects, classes {', '.join(run.classes)}")
sure = run.tracks[(run.tracks["classified"] == 1) & (run.tracks["class"] != "static-other")]
for number in sorted(set(sure["id"]), key=lambda i: -run.track(i)["speed"].max())[:5]:
    rows = run.track(number)
    print(f"object {number}: {rows['class'][-1]}, seen {rows['t'][-1] - rows['t'][0]:.1f} s, "
          f"up to {rows['speed'].max():.1f} m/s")
