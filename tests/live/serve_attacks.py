"""What perception-track --serve does with clients that mean it no good, as a table.

    python3 tests/live/serve_attacks.py build/bin/perception-track rawlogs/demo.rawlog ini/demo.ini [HANDSHAKES]

The program tracks the log slowly; meanwhile each attack is made against its port from this machine. HANDSHAKES (10000) of the
fuzzer are one valid handshake with one to six changes each, by a fixed seed, sixty a second: the server takes 64 requests a second.
At the end the tracks must have the bytes of a run that nothing was connected to.
"""
import base64
import collections
import os
import random
import re
import resource
import select
import socket
import subprocess
import sys
import tempfile
import time

TOKEN = "0123456789abcdef0123"
KEY = base64.b64encode(b"sixteen bytes ok").decode()
PERIOD = 1 / 60  # [s] between handshakes


class Server:
    """The program with its port; with a token where one is given."""

    def __init__(self, program, log, ini, folder, speed, token=False):
        self.results = os.path.join(folder, "token" if token else "plain")
        arguments = [program, "-c", ini, "-i", log, "-o", self.results, "--serve", "0",
                     "--serve-speed", str(speed)]
        if token:
            path = os.path.join(folder, "token.txt")
            with open(path, "w", encoding="utf-8") as file:
                file.write(TOKEN + "\n")
            arguments += ["--serve-token", path]
        self.said = open(self.results + ".log", "w+", encoding="utf-8")
        self.process = subprocess.Popen(arguments, stdout=self.said, stderr=subprocess.STDOUT)
        while not (found := re.search(r"http://127\.0\.0\.1:(\d+)/", self.text())):
            if self.process.poll() is not None:
                sys.exit(self.text())
            time.sleep(0.05)
        self.port = int(found[1])

    def text(self):
        with open(self.said.name, encoding="utf-8") as file:
            return file.read()

    def memory_mb(self):
        """Most memory so far of the program and its child [MB]."""
        pid = str(self.process.pid)
        with open(f"/proc/{pid}/task/{pid}/children", encoding="utf-8") as file:
            pids = [pid] + file.read().split()
        peak = 0
        for one in pids:
            with open(f"/proc/{one}/status", encoding="utf-8") as file:
                peak += int(re.search(r"VmHWM:\s*(\d+)", file.read())[1])
        return peak // 1024

    def connect(self, receive_buffer=0):
        client = socket.socket()
        client.settimeout(15)
        if receive_buffer:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        client.connect(("127.0.0.1", self.port))
        return client


def handshake(port, host=None, more="", target="/", protocol="foxglove.sdk.v1"):
    return (f"GET {target} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{port}'}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {KEY}\r\n"
            f"Sec-WebSocket-Protocol: {protocol}\r\n{more}\r\n").encode()


def answer(server, request):
    """The first line that comes back, or what happens in its place. Nothing is sent after the request."""
    with server.connect() as client:
        try:
            client.sendall(request)
            client.shutdown(socket.SHUT_WR)
            text = client.recv(4096)
        except socket.timeout:
            return "no answer in 15 s"
        except OSError:
            return "closed"
    return text.split(b"\r\n")[0].decode("latin1")[:60] if text else "closed without an answer"


def pause():
    time.sleep(1.1)  # a second has requests of its own


def many_connections(server, count):
    """Opens so many, and counts those that the server keeps; how a late one fares after they have gone."""
    clients = [server.connect() for _ in range(count)]
    time.sleep(2)
    closed = sum(1 for c in clients if select.select([c], [], [], 0)[0] and not peek(c))
    for client in clients:
        client.close()
    pause()
    return f"{count - closed} kept, {closed} closed; afterwards: {answer(server, handshake(server.port))}"


def peek(client):
    try:
        return client.recv(1, socket.MSG_PEEK)
    except OSError:
        return b""


def long_frame(server):
    with server.connect() as client:
        client.sendall(handshake(server.port))
        while b"\r\n\r\n" not in client.recv(4096):
            pass
        client.sendall(bytes([0x82, 0xff]) + (1 << 30).to_bytes(8, "big") + bytes(4))
        received, sent = b"", 0
        try:
            while chunk := client.recv(65536):
                received += chunk
                sent += client.send(bytes(65536))
        except OSError:
            pass
    at = received.find(b"\x88")
    code = int.from_bytes(received[at + 2:at + 4], "big") if at >= 0 else 0
    return f"closed with code {code}, {sent >> 10} kB of it sent; {server.memory_mb()} MB of memory at most"


def changed(rng, request):
    """The request with one to six changes."""
    data = bytearray(request)
    for _ in range(rng.randint(1, 6)):
        kind, at = rng.randrange(7), rng.randrange(len(data) or 1)
        lines = bytes(data).split(b"\r\n")
        line = rng.randrange(len(lines))
        if kind == 0 and data:
            data[at % len(data)] = rng.randrange(256)
        elif kind == 1:
            del data[at:at + rng.randint(1, 40)]
        elif kind == 2:
            data[at:at] = rng.randbytes(rng.randint(1, 40))
        elif kind == 3:
            data[at:at] = bytes([rng.choice(b"\0\r\n :,;/\\%?&=\xff")]) * rng.choice([1, 2, 300, 9000])
        elif kind == 4:
            data = bytearray(b"\r\n".join(lines[:line] + lines[line:line + 1] * rng.randint(2, 80) + lines[line + 1:]))
        elif kind == 5:
            data = bytearray(b"\r\n".join(lines[:line] + lines[line + 1:]))
        else:
            del data[at:]
    return bytes(data)


def fuzz(server, count):
    """Malformed handshakes with a token; those in which the token is no more must not be let in."""
    rng, answers, let_in = random.Random(54), collections.Counter(), 0
    base = handshake(server.port, target=f"/?token={TOKEN}")
    begin = time.monotonic()
    for k in range(count):
        request = changed(rng, base)
        status = answer(server, request)
        answers[" ".join(status.split()[1:2]) if status.startswith("HTTP/1.1 ") else status] += 1
        if TOKEN.encode() not in request and status.startswith(("HTTP/1.1 101", "HTTP/1.1 200")):
            let_in += 1
        time.sleep(max(0, begin + (k + 1) * PERIOD - time.monotonic()))
    counts = ", ".join(f"{name}: {n}" for name, n in answers.most_common())
    pause()
    return (f"{counts}; let in without the token: {let_in}; {server.memory_mb()} MB at most; afterwards: "
            f"{answer(server, handshake(server.port, target=f'/?token={TOKEN}'))}")


def attacks(server, guarded, handshakes):
    port = server.port

    def get(path, of=server):
        return answer(of, f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{of.port}\r\n\r\n".encode())

    yield "a client of this machine", answer(server, handshake(port))
    yield "WebSocket, Origin: https://evil.example", answer(server, handshake(port, more="Origin: https://evil.example\r\n"))
    yield "the page, Host: evil.example", answer(server, b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n")
    yield "WebSocket, Host: evil.example", answer(server, handshake(port, host=f"evil.example:{port}"))
    yield "the page without the token", get("/", guarded)
    yield "WebSocket without the token", answer(guarded, handshake(guarded.port))
    yield "WebSocket with a wrong token", answer(guarded, handshake(guarded.port, target=f"/?token={TOKEN[:-1]}x"))
    for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/\\..\\x"):
        yield f"path {path}", get(path)
    pause()
    yield "a frame of 1 GB", long_frame(server)
    yield "1000 connections", many_connections(server, 1000)
    slow = server.connect(4096)
    slow.sendall(handshake(port, protocol="perception.live.v1"))
    yield f"{handshakes} malformed handshakes", fuzz(guarded, handshakes)
    slow.close()


def main():
    program, log, ini = sys.argv[1:4]
    handshakes = int(sys.argv[4]) if len(sys.argv) > 4 else 10_000
    resource.setrlimit(resource.RLIMIT_NOFILE, (4096, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
    with tempfile.TemporaryDirectory() as folder:
        alone = os.path.join(folder, "alone")
        subprocess.run([program, "-c", ini, "-i", log, "-o", alone], check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(alone, "scenes.csv"), encoding="utf-8") as file:
            scenes = len(file.readlines()) - 1
        speed = scenes / 10 / (handshakes * PERIOD * 1.3 + 60)  # the log outlasts the attacks
        servers = [Server(program, log, ini, folder, speed, token) for token in (False, True)]
        for attack, seen in attacks(*servers, handshakes):
            print(f"{attack:45s} {seen}", flush=True)
        for server in servers:
            code = server.process.wait()
            with open(os.path.join(server.results, "tracks.csv"), "rb") as a, open(os.path.join(alone, "tracks.csv"), "rb") as b:
                same = a.read() == b.read()
            print(f"code {code}, tracks.csv {'the same bytes' if same else 'OTHER BYTES'} as without clients")
            print(*(line for line in server.text().splitlines() if "client" in line), sep="\n")


if __name__ == "__main__":
    main()
