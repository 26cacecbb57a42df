"""Rows of the files of a run, for unseen_streets.py and its modules."""
import csv

ROAD_USERS = ("pedestrian", "cyclist", "car", "bus")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def by_frame(rows):
    found = {}
    for row in rows:
        found.setdefault(row["frame"], []).append(row)
    return found


def is_user(row):
    return row["class"] in ROAD_USERS and row["classified"] == "1"
