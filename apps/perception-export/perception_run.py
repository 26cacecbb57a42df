"""Reads the folder of a run of perception-track; needs numpy alone.

    from perception_run import Run
    run = Run("out/demo")
    car = run.track(3)                                # rows of one object, in order of time
    fast = run.tracks[run.tracks["speed"] > 10]
    print(run.probability("car")[:5], car["t"], car["x"])

run.tracks and run.scenes are structured arrays with the columns of tracks.csv and scenes.csv: world
frame, SI units; numbers are float64 (NaN where a field is empty), "class", "obstacle" and "cause" are text,
"stamp_ns" is the stamp as int64 [ns] since 1970, which float64 cannot hold.
By hand: python3 perception_run.py DIR prints the road users and how long each was seen.
"""
import csv
import os
import sys

import numpy as np

TEXT = ("class", "obstacle", "cause")
WHOLE = ("frame", "id", "objects")


def _nanoseconds(text):
    seconds, _, fraction = text.partition(".")
    return int(seconds) * 10**9 + int(fraction.ljust(9, "0"))


def read_table(path):
    """One CSV file as a structured array. Raises ValueError with file and line."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows:
        raise ValueError(f"{path}: empty, expected a header")
    names = rows[0]
    kinds = [(n, "U32" if n in TEXT else "i8" if n in WHOLE else "f8") for n in names]
    table = np.empty(len(rows) - 1, dtype=kinds + [("stamp_ns", "i8")])
    stamp = names.index("stamp")
    for k, row in enumerate(rows[1:]):
        if len(row) != len(names):
            raise ValueError(f"{path}:{k + 2}: {len(row)} fields, expected {len(names)}")
        try:
            values = [v if n in TEXT else int(v) if n in WHOLE else float(v or "nan")
                      for n, v in zip(names, row)]
            table[k] = tuple(values) + (_nanoseconds(row[stamp]),)
        except ValueError as error:
            raise ValueError(f"{path}:{k + 2}: {error}") from None
    return table


class Run:
    def __init__(self, folder):
        self.tracks = read_table(os.path.join(folder, "tracks.csv"))
        self.scenes = read_table(os.path.join(folder, "scenes.csv"))
        self.classes = [
            n[2:] for n in self.tracks.dtype.names if n.startswith("p_") and n != "p_front"
        ]

    def ids(self):
        return np.unique(self.tracks["id"])

    def track(self, number):
        """Rows of one object."""
        return self.tracks[self.tracks["id"] == number]

    def probability(self, name):
        """Probability of a class in every row of tracks."""
        return self.tracks["p_" + name]


if __name__ == "__main__":
    run = Run(sys.argv[1])
    print("id class seen_s mean_speed")
    for number in run.ids():
        track = run.track(number)
        name = track["class"][-1]
        if name.startswith("static"):
            continue
        print(number, name, f"{track['t'][-1] - track['t'][0]:.1f} {np.mean(track['speed']):.1f}")
