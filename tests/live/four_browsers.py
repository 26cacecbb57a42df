"""Four browsers that watch a live run: does it change the run, and what do they show?

    python3 tests/live/four_browsers.py build/bin/perception-track rawlogs/ibeo.rawlog ini/skynet.ini run.sensors=L
        run.without=LIDAR_TOP [--pairs 3] [--seconds 40] [--memory 600] [--pictures FOLDER]

The log is played again and again as a sensor at work (CRawlogSensor), served to nothing or to four headless Chromiums of which the last
has a twentieth of its processor. The browsers have the lowest priority, since on computers of their own they would not take the
tracker's processor. Pairs of runs take turns. It prints the latency of the scenes (timing.json), frames a second, scenes
left out and new connections in each page; with --memory the resident memory of the tracker every 10 s of one long run with the four browsers; with --pictures
the page as two windows show it; with --readers four connections that read what a page gets and draw nothing, the last one slowly, take
the place of the browsers: four browsers on two processors slow down everything. Needs Chromium (CHROMIUM names another one than Debian's).
"""
import argparse
import base64
import json
import os
import re
import select
import signal
import socket
import statistics
import subprocess
import tempfile
import threading
import time

THROTTLE = 20        # of the last browser
WINDOWS = [(1400, 900), (900, 700), (390, 800), (900, 700)]  # [px]
LAST = 6             # [s] before the end, when the pages are looked at
SAMPLE = 10          # [s] between looks at the memory
PATIENCE = 60        # [s] until a page is open
SILENCE = 120        # [s] after which a browser that answers nothing is given up
WARM = 60            # [s] after which the memory should be flat
COUNT = """(() => { const v = perceptionViewers[0], draw = v.space.draw.bind(v.space); v.frames = 0;
  v.space.draw = () => { ++v.frames; draw(); };
  const connect = v.connect.bind(v);
  v.again = 0;
  v.connect = () => { ++v.again; connect(); }; })()"""


class Browser:
    """A headless Chromium, steered over pipes by the DevTools protocol."""

    def __init__(self, folder, niceness=19):
        self.profile = tempfile.TemporaryDirectory(dir=folder)
        read, self.to = os.pipe()
        self.back, write = os.pipe()

        def pipes():
            a, b = os.dup2(os.dup(read), 30), os.dup2(os.dup(write), 31)
            os.dup2(a, 3), os.dup2(b, 4)
            os.nice(niceness)

        self.process = subprocess.Popen(
            [os.environ.get("CHROMIUM", "/usr/bin/chromium"), "--headless=new", "--no-sandbox", "--no-first-run",
             "--disable-extensions", "--disable-background-networking", "--disable-dev-shm-usage", "--use-gl=angle",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
             "--user-data-dir=" + self.profile.name, "about:blank"],
            preexec_fn=pipes, close_fds=False, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(read), os.close(write)
        self.calls, self.unread, self.session, self.faults = 0, b"", None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Page.enable"), self.call("Runtime.enable")

    def call(self, method, **params):
        self.calls += 1
        message = {"id": self.calls, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self.unread:
                if not select.select([self.back], [], [], SILENCE)[0]:
                    raise RuntimeError(f"the browser has not answered {method} for {SILENCE} s")
                piece = os.read(self.back, 1 << 16)
                if not piece:
                    raise RuntimeError(f"the browser ended at {method}")
                self.unread += piece
            raw, self.unread = self.unread.split(b"\0", 1)
            answer = json.loads(raw)
            if answer.get("method") == "Runtime.exceptionThrown":
                self.faults.append(answer["params"]["exceptionDetails"])
            if answer.get("id") == self.calls:
                if "error" in answer:
                    raise RuntimeError(answer["error"])
                return answer["result"]

    def value(self, expression):
        return self.call("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def open(self, address, window):
        width, height = window
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.call("Page.navigate", url=address)

    def watch(self, throttle):
        until = time.time() + PATIENCE
        while not self.value("!!document.querySelector('[data-run][data-ready]')"):
            if time.time() > until:
                raise RuntimeError(f"the page did not open: {self.faults}")
            time.sleep(0.2)
        if throttle > 1:
            self.call("Emulation.setCPUThrottlingRate", rate=throttle)
        self.value(COUNT)
        self.began = time.time()

    def shown(self):
        """Frames a second, scenes left out, how often it connected again."""
        frames, left, again = self.value("(({ frames, left, again }) => [frames, left, again])(perceptionViewers[0])")
        return frames / (time.time() - self.began), left, again

    def picture(self, path):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        os.close(self.to), os.close(self.back)
        time.sleep(0.2)
        self.profile.cleanup()


class Reader:
    """Reads what a page gets and draws nothing; `throttle`: a piece of 4 kB each fifth of a second."""

    def __init__(self, _):
        self.faults, self.messages, self.slow = [], 0, False

    def open(self, address, _):
        port = int(re.search(r":(\d+)/", address)[1])
        self.socket = socket.socket()
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 16)
        self.socket.connect(("127.0.0.1", port))
        self.socket.sendall((f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: c2l4dGVlbiBieXRlcyBvaw==\r\n"
                             "Sec-WebSocket-Protocol: perception.live.v1\r\n\r\n").encode())
        self.began = time.time()
        threading.Thread(target=self.read, daemon=True).start()

    def exactly(self, count):
        data = b""
        while len(data) < count:
            piece = self.socket.recv(min(count - len(data), 4096 if self.slow else 1 << 16))
            if not piece:
                raise ConnectionError
            data += piece
            if self.slow:
                time.sleep(0.2)
        return data

    def read(self):
        try:
            answer = b""
            while not answer.endswith(b"\r\n\r\n"):
                answer += self.exactly(1)
            while True:
                head = self.exactly(2)
                length = head[1] & 127
                if length > 125:
                    length = int.from_bytes(self.exactly(2 if length == 126 else 8), "big")
                self.exactly(length)
                self.messages += head[0] & 15 == 2
        except (ConnectionError, OSError):
            pass

    def watch(self, throttle):
        self.slow = throttle > 1

    def shown(self):
        return self.messages / (time.time() - self.began), "?", "?"

    def close(self):
        self.socket.close()


def resident_mb(pid):
    """[MB] of a program and its children."""
    total = 0
    with open(f"/proc/{pid}/task/{pid}/children", encoding="utf-8") as file:
        pids = [pid] + [int(p) for p in file.read().split()]
    for one in pids:
        with open(f"/proc/{one}/cmdline", encoding="utf-8") as file:
            if "perception-track" not in file.read():
                continue  # the recorder
        with open(f"/proc/{one}/status", encoding="utf-8") as file:
            total += int(re.search(r"VmRSS:\s*(\d+)", file.read())[1]) / 1024
    return total


def listed(shown):
    return "frames a second, scenes left out, connected again: " + "; ".join(f"{f:.1f}, {n}, {a}" for f, n, a in shown)


def address_of(tracker, path):
    """Where the tracker says that its page is."""
    while True:
        ended = tracker.poll() is not None
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if found := re.search(r"http://127\.0\.0\.1:\d+/", text):
            return found[0]
        if ended:
            raise SystemExit(text)
        time.sleep(0.05)


def run(options, folder, seconds, count, memory=False):
    """One live run with `count` browsers: its timing, and what they and the memory were."""
    capture = os.path.join(folder, "play.ini")
    with open(capture, "w", encoding="utf-8") as file:
        file.write(f"[LOG]\ndriver = CRawlogSensor\nprocess_rate = 100\nrawlog = {os.path.abspath(options.log)}\nrepeats = 0\n")
    results = os.path.join(folder, "run")
    words = [options.program, "-c", options.ini, "-i", "live:" + capture, "-o", results, "--overwrite", "--serve", "0",
             "--duration", str(seconds)]
    for setting in options.settings:
        words += ["--set", setting]
    browsers, tracker, samples = [], None, []
    said = open(os.path.join(folder, "said.txt"), "w+", encoding="utf-8")
    try:
        for _ in range(count):
            browsers.append((Reader if options.readers else Browser)(folder))
        tracker = subprocess.Popen(words, stdout=said, stderr=subprocess.STDOUT)
        address, begin = address_of(tracker, said.name), time.time()
        for browser, window in zip(browsers, WINDOWS):
            browser.open(address, window)
        for i, browser in enumerate(browsers):
            browser.watch(THROTTLE if i == 3 else 1)
        while tracker.poll() is None and time.time() - begin < seconds - LAST:
            if memory:
                samples.append((round(time.time() - begin), resident_mb(tracker.pid)))
                print(f"{samples[-1][0]} s: {samples[-1][1]:.1f} MB", flush=True)
            time.sleep(SAMPLE if memory else 0.5)
        shown = [b.shown() for b in browsers]
        for i, name in ((0, "live-1400.png"), (2, "live-390.png")):
            if options.pictures and count and not options.readers:
                browsers[i].picture(os.path.join(options.pictures, name))
        faults = [f for b in browsers for f in b.faults]
    except BaseException:
        if tracker:
            tracker.terminate()
        raise
    finally:
        for browser in browsers:
            browser.close()
    code = tracker.wait()
    with open(said.name, encoding="utf-8") as file:
        text = file.read()
    if not os.path.exists(os.path.join(results, "timing.json")):
        raise SystemExit(f"{options.program} ended with {code} and left no timing.json:\n{text}")
    with open(os.path.join(results, "timing.json"), encoding="utf-8") as file:
        timing = json.load(file)
    watched = re.findall(r"watched by .*", text)
    return timing, shown, samples, faults, code, watched


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("program", "log", "ini"):
        parser.add_argument(name)
    parser.add_argument("settings", nargs="*", help="KEY=VALUE of the tracker, before the options")
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--seconds", type=int, default=40)
    parser.add_argument("--memory", type=int, default=0)
    parser.add_argument("--pictures", default="")
    parser.add_argument("--readers", action="store_true")
    options = parser.parse_args()
    if options.pictures:
        os.makedirs(options.pictures, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        by_count = {0: [], 4: []}
        for pair in range(options.pairs):
            for count in ((0, 4), (4, 0))[pair % 2]:
                timing, shown, _, faults, code, watched = run(options, folder, options.seconds, count)
                latency = timing["latency"]
                by_count[count].append(latency["p99_seconds"])
                print(f"{count} browsers: {latency['scenes']} scenes, latency [ms]: half within {1e3 * latency['p50_seconds']:.0f}, "
                      f"99 % within {1e3 * latency['p99_seconds']:.0f}, longest {1e3 * latency['longest_seconds']:.0f}; tracker "
                      f"{timing['cpu_seconds']:.1f} s of CPU, code {code}; load of the machine {os.getloadavg()[0]:.1f}", flush=True)
                if count:
                    print(f"  {listed(shown)}; faults {faults}")
                    print("  " + " ".join(watched), flush=True)
        for count, p99 in by_count.items():
            if p99:
                print(f"{count} browsers: 99 % within {1e3 * statistics.median(p99):.0f} ms, median of {len(p99)} runs")
        if options.memory:
            timing, shown, samples, faults, code, watched = run(options, folder, options.memory, 4, memory=True)
            flat = [m for t, m in samples if t >= WARM]
            print(f"from {WARM} s on: {min(flat):.1f} to {max(flat):.1f} MB, last {flat[-1]:.1f}; 99 % of the scenes within "
                  f"{1e3 * timing['latency']['p99_seconds']:.0f} ms; code {code}; {listed(shown)}; faults {faults}")
            print("  " + " ".join(watched))


if __name__ == "__main__":
    main()
