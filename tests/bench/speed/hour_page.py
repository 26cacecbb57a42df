"""The page of a long run with a dense lidar log: what does making and opening it take?

    python3 tests/bench/speed/hour_page.py build/bin FOLDER [--part 60] [--seconds 3600]

Simulates the first minute of the urban drive with a lidar of 64 layers and 450 directions a turn at 10 Hz, tracks it, and repeats
log, truth and results with later stamps and other ids until the run is as long as wanted; at each repetition the vehicle jumps back.
Then perception-report makes the page, and a headless Chromium opens it. Prints processor time and peak memory of perception-report, the
size of log and page, the time until the page shows the run, and the memory of its renderer. The log of an hour takes 6.5 GB; what is in FOLDER
already is used again. All of it is simulated. Needs Chromium (CHROMIUM names another one than Debian's).
"""
import argparse
import csv
import gzip
import json
import math
import multiprocessing
import os
import re
import struct
import subprocess
import sys
import tempfile
import time

TREE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(TREE, "tests", "live"))
from four_browsers import Browser  # noqa: E402

VEHICLE = """[ego]
pose_rate = 100
pose_sigma_xy = 0.05
pose_sigma_yaw_deg = 0.2

[sensor.LIDAR_TOP]
kind = lidar64
x = 1.0
z = 2.15
rate = 10
azimuth_step_deg = 0.8
divergence_deg = 0.17
"""
PERIOD = 0.1                     # [s] of the lidar: between the last scene and the first of the next repetition
TICKS = 10_000_000               # of MRPT's stamps in a second, since 1601
EPOCH = 11_644_473_600           # [s] from 1601 to 1970
NEAR = 700                       # [bytes] from an end of an entry, where its stamp stands
ENTRY = re.compile(rb"[\x80-\xff](?:mrpt::obs|perception)::CObservation[A-Za-z]+\x00?")
PATIENCE = 120                   # [s] until a page is open
OPEN = "!!document.querySelector('[data-run][data-ready]')"


def run(words):
    """Processor time [s] and peak memory [MB] of a program that must succeed (3: a warning)."""
    process = subprocess.Popen(["nice", "-n", "12"] + words, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 3):
        raise SystemExit(f"{' '.join(words)} ended with {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def make_part(programs, folder, seconds):
    """A log of `seconds`, its truth, and its run."""
    log, results = os.path.join(folder, "part.rawlog"), os.path.join(folder, "part")
    vehicle = os.path.join(folder, "vehicle.ini")
    with open(vehicle, "w", encoding="utf-8") as file:
        file.write(VEHICLE)
    if not os.path.exists(log):
        run([programs + "/perception-simulate", "-c", TREE + "/ini/scenarios/urban_drive.ini", "--vehicle", vehicle,
             "--set", f"scenario.duration={seconds}", "-o", log])
    if not os.path.exists(results + "/done.json"):
        cpu, memory = run([programs + "/perception-track", "-c", TREE + "/ini/skynet.ini", "-i", log, "-o", results,
                           "--sensors", "L", "--set", "run.without=IBEO"])
        print(f"{seconds} s tracked: {cpu:.1f} s of CPU, {memory:.0f} MB", flush=True)
    return log, results


def entries_of(data):
    """Where the entries of a rawlog begin, and the length of the last one's end."""
    starts = [m.start() for m in ENTRY.finditer(data)
              if data[m.start()] & 0x7f == len(m.group().rstrip(b"\0")) - 1 and
              (m.start() == 0 or data[m.start() - 1] == 0x88)]
    return list(zip(starts, starts[1:] + [len(data)]))


def stamp_place(data, begin, end, first, last):
    """Byte at which the stamp of an entry stands: the one number that is a time of this log."""
    for places in (range(begin, min(begin + NEAR, end - 7)), range(max(begin, end - NEAR), end - 7)):
        found = [p for p in places if first <= struct.unpack_from("<q", data, p)[0] <= last]
        if len(found) == 1:
            return found[0]
    raise SystemExit(f"the entry at byte {begin} has {len(found)} stamps")


def repeat_log(log, target, record, times, length):
    """Compressed once: an entry's data behind its stamp stay the same; a file may have many gzip members."""
    with gzip.open(log) as file:
        data = file.read()
    first, last = (round((float(record["input"][k]) + EPOCH) * TICKS) for k in ("first_stamp", "last_stamp"))
    small, pieces, at = [], [], 0  # (bytes up to and with stamps, places of the stamps, compressed bytes behind)
    for begin, end in entries_of(data):
        place = stamp_place(data, begin, end, first - TICKS, last + TICKS)
        small.append(place - at)
        if end - place > 4096:
            pieces.append((data[at:place + 8], small, gzip.compress(data[place + 8:end], 1)))
            small, at = [], end
    if at < len(data):
        pieces.append((data[at:], small, b""))
    with open(target, "wb") as out:
        for k in range(times):
            move = round(k * length * TICKS)
            for text, places, rest in pieces:
                moved = bytearray(text)
                for place in places:
                    struct.pack_into("<q", moved, place, struct.unpack_from("<q", text, place)[0] + move)
                out.write(gzip.compress(bytes(moved), 1) + rest)


def later(text, seconds):
    """A decimal number of seconds, as many digits, later."""
    whole, part = text.split(".")
    unit = 10 ** len(part)
    count = int(whole + part) + round(seconds * unit)
    return f"{count // unit}.{count % unit:0{len(part)}d}"


def repeat_table(source, target, times, length, frames, ids):
    """A table with t, and stamp, frame, id and last hits where it has them."""
    with open(source, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    moved = [i for i, name in enumerate(head) if name in ("t", "stamp") or name.startswith("last_hit_")]
    counted = [(head.index(name), step) for name, step in (("frame", frames), ("id", ids)) if name in head]
    with open(target, "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(head)
        for k in range(times):
            for row in rows:
                row = list(row)
                for i in moved:
                    if row[i]:
                        row[i] = later(row[i], k * length)
                for i, step in counted:
                    if row[i] and int(row[i]) >= 0:
                        row[i] = str(int(row[i]) + k * step)
                out.writerow(row)


def repeat_events(source, target, times, length, ids):
    with open(source, encoding="utf-8") as file:
        events = [json.loads(line) for line in file]
    with open(target, "w", encoding="utf-8") as out:
        for k in range(times):
            for event in events:
                event = json.loads(json.dumps(event))
                event["t"] += k * length
                event["stamp"] = later(event["stamp"], k * length)
                fields = event.get("fields", {})
                if "id" in fields:
                    event["message"] = event["message"].replace(f"object {fields['id']}", f"object {fields['id'] + k * ids}")
                    fields["id"] += k * ids
                out.write(json.dumps(event, separators=(",", ":")) + "\n")


def repeat(log, long_log, results, target, seconds, truth):
    """The long log and its run; in a process of its own, since a program's peak begins with the memory of the one that starts it."""
    with open(results + "/done.json", encoding="utf-8") as file:
        record = json.load(file)
    with open(results + "/scenes.csv", newline="", encoding="utf-8") as file:
        scenes = list(csv.DictReader(file))
    with open(results + "/tracks.csv", newline="", encoding="utf-8") as file:
        ids = max(int(row["id"]) for row in csv.DictReader(file)) + 1
    length = round(float(scenes[-1]["t"]) + PERIOD, 1)
    times, frames = math.ceil(seconds / length), int(scenes[-1]["frame"]) + 1
    os.makedirs(target, exist_ok=True)
    repeat_log(log, long_log, record, times, length)
    if truth:
        repeat_table(log.replace(".rawlog", ".truth.csv"), long_log.replace(".rawlog", ".truth.csv"), times, length, frames, 100000)
    for name in os.listdir(results):
        if name in ("tracks.csv", "scenes.csv", "weather.csv", "ledger.csv"):
            repeat_table(f"{results}/{name}", f"{target}/{name}", times, length, frames, ids)
        elif name == "events.jsonl":
            repeat_events(f"{results}/{name}", f"{target}/{name}", times, length, ids)
        elif name in ("effective.ini", "timing.json", "innovations.csv"):
            with open(f"{results}/{name}", "rb") as source, open(f"{target}/{name}", "wb") as out:
                out.write(source.read())
    record["input"]["last_stamp"] = later(record["input"]["last_stamp"], (times - 1) * length)
    record["input"].update(name=os.path.basename(long_log), bytes=os.path.getsize(long_log), entries=record["input"]["entries"] * times)
    record["scenes"] *= times
    record["tracks"] *= times
    with open(target + "/done.json", "w", encoding="utf-8") as file:
        json.dump(record, file, indent=2)


def renderer_mb(browser):
    """[MB] resident in the page's process, and its share of what several processes hold."""
    best = (0, 0)
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.getsid(int(pid)) != browser.process.pid:
                continue
            with open(f"/proc/{pid}/cmdline", encoding="utf-8") as file:
                if "--type=renderer" not in file.read():
                    continue
            with open(f"/proc/{pid}/smaps_rollup", encoding="utf-8") as file:
                text = file.read()
        except OSError:
            continue
        best = max(best, tuple(int(re.search(rf"{key}:\s*(\d+)", text)[1]) / 1024 for key in ("Rss", "Pss")))
    return best


def open_page(page):
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(folder, niceness=0)
        try:
            begin = time.time()
            browser.open("file://" + os.path.abspath(page), (1400, 900))
            while not browser.value(OPEN):
                if time.time() - begin > PATIENCE:
                    raise SystemExit(f"the page did not open: {browser.faults}")
                time.sleep(0.02)
            took = time.time() - begin
            time.sleep(3)
            opened = renderer_mb(browser)
            for share in (0.25, 0.5, 0.75, 1):
                browser.value(f"perceptionViewers[0].seek({share} * perceptionViewers[0].run.times.at(-1))")
                time.sleep(1)
            return took, opened, renderer_mb(browser), browser.faults
        finally:
            browser.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", help="folder of the programs")
    parser.add_argument("folder")
    parser.add_argument("--part", type=int, default=60, help="[s] that are simulated")
    parser.add_argument("--seconds", type=int, default=3600, help="[s] of the long run")
    parser.add_argument("--truth", action="store_true", help="repeat the truth as well: a gigabyte an hour, of 350 objects a scan")
    parser.add_argument("--times", type=int, default=3, help="how often the page is opened")
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    log, results = make_part(options.programs, options.folder, options.part)
    target = os.path.join(options.folder, f"run-{options.seconds}")
    long_log = target + ".rawlog"
    if not os.path.exists(target + "/done.json"):
        work = multiprocessing.Process(target=repeat, args=(log, long_log, results, target, options.seconds, options.truth))
        work.start()
        work.join()
        if work.exitcode:
            raise SystemExit(work.exitcode)
    with open(target + "/done.json", encoding="utf-8") as file:
        print(f"log of {os.path.getsize(long_log) / 1e6:.0f} MB, {json.load(file)['scenes']} scenes", flush=True)
    page = target + ".html"
    begin = time.time()
    cpu, memory = run([options.programs + "/perception-report", "-r", target, "-i", long_log, "-o", page])
    print(f"making the page: {cpu:.1f} s of CPU in {time.time() - begin:.0f} s, {memory:.0f} MB at most; page "
          f"{os.path.getsize(page) / 1e6:.1f} MB; load of the machine {os.getloadavg()[0]:.1f}", flush=True)
    for _ in range(options.times):
        took, opened, later, faults = open_page(page)
        print(f"opened in {took:.1f} s; renderer {opened[0]:.0f} MB resident, share {opened[1]:.0f} MB; after four looks elsewhere "
              f"{later[0]:.0f} and {later[1]:.0f} MB; faults {faults}; load {os.getloadavg()[0]:.1f}", flush=True)


if __name__ == "__main__":
    main()
