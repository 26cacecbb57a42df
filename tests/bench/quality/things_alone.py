#!/usr/bin/python3
"""Which things become certain road users? Streets, yards, parks and corridors without any road user, cast as lidars of
several kinds and mountings would see them (simulated: boxes on a plane). Each log gets the INI that perception-doctor writes
for it. A line a scene and lidar, then their sum: outputs that are certain road users, and unsure ones, of all scans.

    tests/bench/quality/things_alone.py [-o OUT] [-s SEED] [-m MODEL.json] [SCENE ...]
      SCENE  street yard park corridor; without one, all     -s  draws other scenes [1]
      -m     shape model in place of that of the INI
Scans and logs stay in OUT [out/things_alone] and are not made again. PERCEPTION_BIN: programs [build/bin]. Needs numpy.
"""
import argparse
import csv
import os
import subprocess
import sys
from collections import Counter

import numpy as np

SCANS, NOISE = 12, 0.015  # number, [m]
LIDARS = {  # beams, columns, lowest and highest beam [deg], mounting height [m], speed [m/s]
    "16 beams, 0.6 m": (16, 1800, -15, 15, 0.6, 1.5),
    "16 beams, 1.8 m": (16, 1800, -15, 15, 1.8, 6),
    "32 beams, 1.8 m": (32, 1200, -30.7, 10.7, 1.8, 6),
    "64 beams, 1.7 m": (64, 1800, -24.8, 2, 1.73, 6),
    "128 beams, 1.9 m": (128, 1024, -22.5, 22.5, 1.9, 6),
}


def box(x, y, length, width, bottom, top, yaw=0.0):
    """Middle x, y; size; heights of bottom and top [m]; yaw [rad]."""
    return x, y, length, width, bottom, top, yaw


def street(rng):
    """Houses with gaps, and what stands at curbs."""
    things = []
    for side in (-1, 1):
        x = -20.0
        while x < 110:
            length, depth = rng.uniform(6, 25), rng.uniform(9.5, 14)
            things.append(box(x + length / 2, side * depth, length, 6, 0, rng.uniform(3, 9)))
            x += length + rng.uniform(0, 5)
        for x in np.arange(0, 100, rng.uniform(6, 9)):
            y = side * rng.uniform(3.5, 6.2)
            things += [
                [box(x, y, 0.25, 0.25, 0, 4)],                                              # post
                [box(x, y, 0.15, 0.15, 0, 1)],                                              # bollard
                [box(x, y, 1.2, 0.8, 0, 1.2, rng.uniform(0, 3))],                           # bin
                [box(x, y, 2, 1.1, 0, 1.5)],                                                # dumpster
                [box(x, y, rng.uniform(3, 9), 0.6, 0, 1.1)],                                # low wall
                [box(x, y, 0.35, 0.35, 0, 2.4), box(x, y, 2.5, 2.5, 2.4, 4.8)],             # tree
                [box(x, y, 3, 0.15, 0, 2.5)],                                               # billboard
                [box(x, y, 1.6, 0.5, 0.4, 0.5), box(x, y + 0.2 * side, 1.6, 0.06, 0.5, 0.9)],  # bench
            ][rng.integers(8)]
    return things


def yard(rng):
    """Containers, pallets, stacks, barriers, cabinets."""
    things = [box(50, 15, 200, 0.3, 0, 4), box(50, -15, 200, 0.3, 0, 4)]
    for x in np.arange(-5, 100, 7):
        for side in (-1, 1):
            y = side * rng.uniform(4, 9)
            things += [
                [box(x, y, 6.06, 2.44, 0, 2.6, rng.choice([0, np.pi / 2]))],
                [box(x, y, 1.2, 1, 0, 1.2, rng.uniform(0, 3))],
                [box(x, y, 1.2, 0.8, 0, 1), box(x + 0.2, y + 0.3, 0.9, 0.7, 1, 1.5)],
                [box(x, y, 3, 0.6, 0, 0.8, rng.uniform(-0.3, 0.3))],
                [box(x, y, 0.8, 0.8, 0, 2.2)],
            ][rng.integers(5)]
    return things


def park(rng):
    """Trunks, bushes and hedges of many boxes."""
    things = []
    for x in np.arange(-5, 100, 3):
        for side in (-1, 1):
            y, kind = side * rng.uniform(3.6, 9), rng.integers(4)
            if kind == 0:
                width = rng.uniform(0.2, 0.6)
                things.append(box(x, y, width, width, 0, 3, rng.uniform(0, 1)))
            elif kind == 1:
                for _ in range(8):
                    low = rng.uniform(0, 0.9)
                    things.append(box(x + rng.normal(0, 0.5), y + rng.normal(0, 0.4), *rng.uniform(0.2, 0.6, 2), low,
                                      low + 0.4, rng.uniform(0, 3)))
            elif kind == 2:
                things += [box(x + 0.25 * i, y + rng.normal(0, 0.12), 0.35, 0.6, 0, 1.2 + rng.normal(0, 0.1),
                               rng.uniform(-0.3, 0.3)) for i in range(10)]
    return things


def corridor(rng):
    """Walls 6 m apart, cupboards, tables, chairs, pillars."""
    things = [box(30, 3.1, 80, 0.2, 0, 3), box(30, -3.1, 80, 0.2, 0, 3), box(70, 0, 0.2, 6, 0, 3)]
    for x in np.arange(4, 66, 4.5):
        side = rng.choice([-1, 1])
        things += [
            [box(x, side * 2.5, 0.5, 0.5, 0, 3)],
            [box(x, side * 2.6, 1.2, 0.5, 0, 1.8)],
            [box(x, side * 2.2, 1.6, 0.8, 0.7, 0.75)] +
            [box(x + 0.75 * i, side * 2.2 + 0.35 * j, 0.05, 0.05, 0, 0.7) for i in (-1, 1) for j in (-1, 1)],
            [box(x, side * 2.3, 0.5, 0.5, 0, 0.9)],
        ][rng.integers(4)]
    return things


SCENES = {f.__name__: f for f in (street, yard, park, corridor)}


def ranges(directions, sensor, things, reach=90.0):
    """[m] along unit vectors from `sensor` to the nearest surface of the boxes or the plane z = 0; inf: none within reach."""
    with np.errstate(divide="ignore", invalid="ignore"):
        best = np.where(directions[:, 2] < 0, -sensor[2] / directions[:, 2], np.inf)
        for x, y, length, width, bottom, top, yaw in things:
            if abs(x - sensor[0]) > reach + length:
                continue
            c, s = np.cos(yaw), np.sin(yaw)
            turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            origin, ray = turn @ (sensor - [x, y, (bottom + top) / 2]), directions @ turn.T
            half = np.array([length, width, top - bottom]) / 2
            one, other = (-half - origin) / ray, (half - origin) / ray
            near, far = np.minimum(one, other).max(1), np.maximum(one, other).min(1)
            best = np.where((near <= far) & (near > 0.5) & (near < best), near, best)
    return np.where(best < reach, best, np.inf)


def cast(folder, things, lidar, seed):
    beams, columns, low, high, height, speed = lidar
    elevation, azimuth = np.meshgrid(np.radians(np.linspace(low, high, beams)),
                                     np.radians(np.linspace(-180, 180, columns, endpoint=False)), indexing="ij")
    level = np.cos(elevation)
    directions = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], -1).reshape(-1, 3)
    os.makedirs(folder + "/scans", exist_ok=True)
    rng = np.random.default_rng(seed)
    with open(folder + "/poses.txt", "w") as poses:
        for k in range(SCANS):
            x = 0.1 * speed * k
            found = ranges(directions, np.array([x, 0, height]), things)
            seen = np.isfinite(found)
            points = directions[seen] * (found[seen] + rng.normal(0, NOISE, seen.sum()))[:, None]
            np.c_[points, np.full(len(points), 0.3)].astype("<f4").tofile(f"{folder}/scans/{k:06d}.bin")
            poses.write(f"1 0 0 {x:.6f} 0 1 0 0 0 0 1 0\n")


def run(program, *args):
    """Exit code 3 is a warning, as of a lidar without intensities."""
    done = subprocess.run([os.path.join(os.environ.get("PERCEPTION_BIN", "build/bin"), program), *args],
                          capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"{program} {' '.join(args)}: exit code {done.returncode}\n{done.stderr}")


def count(folder, name, lidar, options, things, seed):
    if not os.path.isfile(folder + "/log.rawlog"):
        cast(folder, things, lidar, seed)
        run("perception-import", "clouds", "--clouds", folder + "/scans", "--poses", folder + "/poses.txt", "--poses-frame",
            "ego", "--lidar-pose", "0", "0", str(lidar[4]), "0", "0", "0", "-o", folder + "/log.rawlog")
    run("perception-doctor", "-i", folder + "/log.rawlog", "-o", folder + "/doctor")
    run("perception-track", "-c", folder + "/doctor/site.ini", "-i", folder + "/log.rawlog", "-o", folder + "/run",
        "--overwrite", *options)
    certain, unsure = Counter(), 0
    with open(folder + "/run/tracks.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["class"] != "static-other":
                certain[row["class"]] += row["classified"] == "1"
                unsure += row["classified"] != "1"
    kinds = ", ".join(f"{n} {kind}" for kind, n in sorted(certain.items()) if n)
    print(f"| {name} | {sum(certain.values())}{' (' + kinds + ')' if kinds else ''} | {unsure} | {SCANS} |", flush=True)
    return np.array([sum(certain.values()), unsure, SCANS])


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("-o", default="out/things_alone")
    parser.add_argument("-s", type=int, default=1)
    parser.add_argument("-m")
    parser.add_argument("scenes", nargs="*")
    args = parser.parse_args()
    unknown = [s for s in args.scenes if s not in SCENES]
    if unknown:
        print(f"things_alone.py: no scene {unknown[0]}; there are: {' '.join(SCENES)}", file=sys.stderr)
        return 64
    options = ["--set", "sensor.LIDAR_TOP.classifier.file=" + os.path.abspath(args.m)] if args.m else []
    print("| scene, lidar (simulated) | certain road users | unsure | scans |\n|---|---|---|---|", flush=True)
    total = np.zeros(3, int)
    for number, (scene, draw) in enumerate(SCENES.items()):
        if args.scenes and scene not in args.scenes:
            continue
        things = draw(np.random.default_rng([args.s, number]))
        for lidar, figures in LIDARS.items():
            folder = os.path.join(args.o, f"{scene}_{args.s}", lidar.replace(",", "").replace(" ", "_"))
            total += count(folder, f"{scene}, {lidar}", figures, options, things, args.s)
    print(f"| all | {total[0]} | {total[1]} | {total[2]} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
