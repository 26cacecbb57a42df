#!/usr/bin/env python3
"""Writes ini/scenarios/urban_drive.ini: an urban drive of seven minutes (simulated).

    tests/bench/paper/urban_drive.py > ini/scenarios/urban_drive.ini

A route of straight streets with two right-angled turns; traffic lights with crosswalks; paths of vehicles by Treiber's
intelligent driver model as in busy_street. A function of the constants below: no random numbers from outside.
"""
import math
import random

DURATION = 420.0
STEP = 0.05
RADIUS = 12.0                                   # [m] of the turns
START = (-962.0, 250.0)
# [m] length, [deg] heading; the ego drives the second to fourth, oncoming traffic comes from the last and leaves by the
# first, where it queues.
LEGS = [(726.0, -90), (1000.0, 0), (900.0, 90), (900.0, 0), (480.0, 90), (1700.0, 180)]
EGO = 760.0                                     # [m] where it starts
ACCEL, BRAKE, GAP, HEADWAY = 1.4, 2.0, 2.0, 1.2  # [m/s^2, m/s^2, m, s] as in busy_street
LANE = 3.6                                      # [m] from our lane to the oncoming one
rng = random.Random(17)


class Route:
    """The ego's lane by arc length, with lateral offsets to its left."""

    def __init__(self):
        self.pieces, (x, y), heading, s = [], START, math.radians(LEGS[0][1]), 0.0
        for i, (length, direction) in enumerate(LEGS):
            self.pieces.append((s, length, x, y, heading, 0))
            x, y, s = x + length * math.cos(heading), y + length * math.sin(heading), s + length
            if i + 1 < len(LEGS):
                turn = math.radians(LEGS[i + 1][1]) - heading
                arc = abs(turn) * RADIUS
                sign = 1 if turn > 0 else -1
                self.pieces.append((s, arc, x, y, heading, sign))
                cx, cy = x - sign * RADIUS * math.sin(heading), y + sign * RADIUS * math.cos(heading)
                heading += turn
                x, y, s = cx + sign * RADIUS * math.sin(heading), cy - sign * RADIUS * math.cos(heading), s + arc
        self.length = s

    def at(self, s, d=0.0):
        """x, y [m], heading [rad]."""
        piece = [p for p in self.pieces if p[0] <= s] or self.pieces[:1]
        s0, _, x, y, heading, sign = piece[-1]
        along = s - s0
        if sign == 0:
            px, py, h = x + along * math.cos(heading), y + along * math.sin(heading), heading
        else:
            cx, cy = x - sign * RADIUS * math.sin(heading), y + sign * RADIUS * math.cos(heading)
            h = heading + sign * along / RADIUS
            px, py = cx + sign * RADIUS * math.sin(h), cy - sign * RADIUS * math.cos(h)
        return px - d * math.sin(h), py + d * math.cos(h), h

    def turning(self, s):
        return any(p[5] and p[0] - 2 <= s <= p[0] + p[1] + 2 for p in self.pieces)

    def straight(self, s, margin=25):
        return not any(p[5] and p[0] - margin <= s <= p[0] + p[1] + margin for p in self.pieces)


route = Route()
LIGHTS = [EGO + s for s in (150, 330, 520, 690, 860, 1160, 1340, 1530, 1720, 2080, 2270, 2440, 2640)]
CYCLE, GREEN = 50.0, 24.0  # [s]
PHASE = {s: rng.uniform(0, CYCLE) for s in LIGHTS}


QUEUE = 8.0                         # [m] always red


def red(s, t):
    if s == QUEUE:
        return True
    return (t + PHASE[s]) % CYCLE >= GREEN


def wanted(s, v):
    return min(v, 5.0) if route.turning(s) else v


def idm(gap, v, closing, v0):
    a = 1 - (v / v0) ** 4
    if gap is not None:
        target = GAP + max(0, v * HEADWAY + v * closing / (2 * math.sqrt(ACCEL * BRAKE)))
        a -= (target / max(gap, 0.1)) ** 2
    return max(-6.0, ACCEL * a)


def drive(cars, direction):
    """Positions along the route by time; cars: [s, speed, length, wish], the foremost first."""
    paths = [[] for _ in cars]
    for k in range(int(DURATION / STEP) + 1):
        t = k * STEP
        before = None
        for i, car in enumerate(cars):
            s, v, length, wish = car
            if k % 5 == 0:
                paths[i].append((t, s))
            gaps = []
            if before is not None:
                gaps.append((direction * (before[0] - s) - (before[2] + length) / 2, v - before[1]))
            for light in LIGHTS + [QUEUE]:
                ahead = direction * (light - s) - length / 2 - 4
                if -1 < ahead < 60 and red(light, t) and v * v / (2 * 3.0) < ahead + 1:
                    gaps.append((max(ahead, .1) + GAP - .5, v))
            a = min([idm(g, v, c, wanted(s, wish)) for g, c in gaps] + [idm(None, v, 0, wanted(s, wish))])
            car[1] = max(0.0, v + a * STEP)
            car[0] = s + direction * car[1] * STEP
            before = car
    return paths


def thin(path, tolerance):
    """Douglas and Peucker over time, kept within a tolerance [m] of the place at each time."""
    if len(path) < 3:
        return path
    (t0, s0), (t1, s1) = path[0], path[-1]
    worst, at = 0.0, 0
    for i, (t, s) in enumerate(path[1:-1], 1):
        off = abs(s - (s0 + (s1 - s0) * (t - t0) / (t1 - t0)))
        if off > worst:
            worst, at = off, i
    if worst <= tolerance:
        return [path[0], path[-1]]
    return thin(path[:at + 1], tolerance)[:-1] + thin(path[at:], tolerance)


def way(path, d, tolerance=0.3):
    kept = {t for t, _ in thin(path, tolerance)}
    kept |= {t for t, s in path if route.turning(s)}
    rows = [(t, *route.at(s, d)[:2]) for t, s in path if t in kept]
    out = [rows[0]]
    for row in rows[1:]:  # a turn at rest is one place
        if row is rows[-1] or row[1:] != out[-1][1:] or len(out) < 2 or out[-2][1:] != row[1:]:
            out.append(row)
        else:
            out[-1] = row
    return out


def section(name, kind, rows, heading=None, **keys):
    print(f"[{name}]")
    if kind:
        print(f"kind = {kind}")
    for key, value in keys.items():
        print(f"{key} = {value:g}" if isinstance(value, float) else f"{key} = {value}")
    for letter, column in zip("txy", zip(*rows)):
        print(f"{letter} = " + ", ".join(f"{value:.2f}".rstrip("0").rstrip(".") for value in column))
    if heading is not None:
        print(f"heading_deg = {math.degrees(heading):.0f}")
    print()


def standing(name, kind, s, d, turn=0.0, **keys):
    x, y, h = route.at(s, d)
    section(f"object.{name}", kind, [(0, x, y)], h + turn, **keys)


print("""; An urban drive of seven minutes through straight streets with two turns: thirteen traffic lights with crosswalks, a
; leading car and a follower, oncoming traffic, cyclists, people on sidewalks and crosswalks, parked cars, trees, houses.
; Simulated, nothing is recorded; written by tests/bench/paper/urban_drive.py. Paths of vehicles are by a car-following model
; (Treiber's intelligent driver model: 1.4 m/s^2, 2 m and 1.2 s of gap). Waypoints: t [s], x and y [m].

include = ../vehicles/skynet.ini

[scenario]
description = urban drive of seven minutes, clear weather
duration = 420               ; [s]
""")
marks, s = [], 0.0
while s <= route.length:
    marks.append(s)
    s += 2 if route.turning(s) or route.turning(s + 20) else 20
for name, d, width in (("road.main", LANE / 2, 13), ("lane.ahead", 0, 3.6), ("lane.oncoming", LANE, 3.6)):
    points = [route.at(m, d)[:2] for m in marks if route.turning(m) or m % 100 < 20]
    if name == "lane.oncoming":
        points.reverse()
    print(f"[{name}]")
    print("x = " + ", ".join(f"{x:.1f}" for x, _ in points))
    print("y = " + ", ".join(f"{y:.1f}" for _, y in points))
    print(f"width = {width}\n")

ours = [[EGO + s, 10.0, length, 12.0] for s, length in ((45, 4.6), (22, 4.5), (0, 5.0), (-16, 4.3))]
paths = drive(ours, 1)
section("ego", None, way(paths[2], 0, 0.1))
for i, kind in ((0, "van"), (1, "car"), (3, "car")):
    section(f"object.{('lead_2', 'lead', '', 'follower')[i]}", kind, way(paths[i], 0), length=ours[i][2])

oncoming, s = [], EGO + 60.0
while s < route.length - 20:
    oncoming.append([s, 10.0, rng.choice([4.2, 4.5, 4.7]), rng.uniform(11, 14)])
    s += rng.uniform(60, 160)
for i, path in enumerate(drive(oncoming, -1)):
    kind = "van" if i % 9 == 4 else "car"
    section(f"object.oncoming_{i}", kind, way(path, LANE), **({} if kind == "van" else {"length": oncoming[i][2]}))

ego_at = dict((round(t, 2), s) for t, s in paths[2])
number = 0
for light in LIGHTS:  # people cross while it is red
    for start in range(int(DURATION / CYCLE) + 1):
        t0 = start * CYCLE + GREEN - PHASE[light] + 3
        here = ego_at.get(round(t0 * 4) / 4)
        if here is None or t0 < 0 or abs(here - light) > 90:
            continue
        for k in range(3):
            number += 1
            pace, sign = rng.uniform(1.1, 1.5), rng.choice([-1, 1])
            s, begin = light - 1.5 + k, t0 + rng.uniform(0, 4)
            ends = [(-7.0, begin), (11.0, begin + 18 / pace)]
            if sign < 0:
                ends = [(11.0, begin), (-7.0, begin + 18 / pace)]
            rows = [(t, *route.at(s, d)[:2]) for d, t in ends]
            section(f"object.crosser_{number}", "pedestrian", rows, height=round(rng.uniform(1.55, 1.9), 2))
for i in range(36):  # along the sidewalks, when the ego passes
    t = 5 + i * DURATION / 36
    s = ego_at[round(t * 4) / 4] + rng.uniform(15, 45)
    side, way_s = (-4.95, -5.65, 8.9, 9.6, 10.3)[i % 5], rng.choice([-1, 1]) * rng.uniform(1.1, 1.6)
    if route.straight(s, 40):
        rows = [(u, *route.at(s + way_s * (u - t), side)[:2]) for u in (max(0, t - 12), min(DURATION, t + 14))]
        section(f"object.walker_{i}", "pedestrian", rows, height=round(rng.uniform(1.55, 1.9), 2))
for i in range(8):  # cyclists at the edge of our lane, overtaken
    t = 20 + i * 50
    s = ego_at[round(t * 4) / 4] + 25
    if route.straight(s, 70):
        rows = [(u, *route.at(s + 4.5 * (u - t), -1.6)[:2]) for u in (max(0, t - 10), min(DURATION, t + 12))]
        section(f"object.cyclist_{i}", "cyclist", rows)

farthest = max(s for _, s in paths[2]) + 80
number, s = 0, EGO - 20
while s < farthest:
    if route.straight(s) and all(abs(s - light) > 12 for light in LIGHTS):
        number += 1
        kind = "van" if number % 6 == 0 else "car"
        if rng.random() < .4:
            standing(f"parked_right_{number}", kind, s, -3.5)
        if rng.random() < .4:
            standing(f"parked_left_{number}", kind, s + 3, LANE + 3.7, math.pi)
        if number % 3 == 0:
            standing(f"trunk_{number}", "pole", s + 4, -6.5, height=2.8, width=0.3, length=0.3)
            standing(f"crown_{number}", "bush", s + 4, -6.5, base=2.2, length=3.4, width=3.2, height=3.4)
    s += rng.uniform(11, 16)
number, s = 0, EGO - 40
while s < farthest:
    length = rng.choice([18.0, 24.0, 30.0])
    if route.straight(s + length / 2, 35) and all(abs(s + length / 2 - light) > length / 2 + 7 for light in LIGHTS):
        number += 1
        standing(f"house_right_{number}", "box", s + length / 2, -13.5, length=length, width=9.0, height=rng.choice([9.0, 12.0]))
        standing(f"house_left_{number}", "box", s + length / 2, 17.2, length=length, width=9.0, height=rng.choice([9.0, 12.0]))
    s += length + rng.uniform(3, 9)
