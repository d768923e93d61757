#!/usr/bin/env python3
"""Runs nginx as deploy/nginx/lipofill.conf sets it up before the real daemon, and floods it.

    check_front.py CONFIGURATION LIPOFILLD

Only names, ports and certificates are replaced, as the file says; nginx speaks HTTP/2 in plain text
here, so that frames can be written by hand. Exits with 77 where there is no nginx.
"""

import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

CONFIGURATION, LIPOFILLD = sys.argv[1:3]
NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
DATA, HEADERS, RESET, SETTINGS, GOAWAY, WINDOW, CONTINUATION = 0, 1, 3, 4, 7, 8, 9
END_STREAM, END_HEADERS = 1, 4
HEALTH = "/grpc.health.v1.Health/Check"
MOST_GROWTH_MB = 100

MAIN = """
daemon off;
worker_processes 1;
pid {folder}/pid;
error_log {folder}/error.log;
{user}
events {{ worker_connections 1024; }}
http {{
  access_log off;
  client_body_temp_path {folder}/body;
  proxy_temp_path {folder}/proxy;
  fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi;
  scgi_temp_path {folder}/scgi;
  include {folder}/lipofill.conf;
}}
"""


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def wait_until(what, condition, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.1)
    sys.exit(f"{what} did not come about within {seconds} s")


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def text(value):
    """A text of HPACK with its length before it, without Huffman coding (RFC 7541, 5.2)."""
    data = value.encode()
    if len(data) < 127:
        return bytes([len(data)]) + data
    rest, head = len(data) - 127, [127]
    while rest >= 128:
        head.append(rest % 128 + 128)
        rest //= 128
    return bytes([*head, rest]) + data


def headers(path, more=()):
    fields = [(":method", "POST"), (":scheme", "http"), (":path", path), (":authority", "lipofill.example.org")]
    fields += [("te", "trailers"), ("content-type", "application/grpc"), *more]
    return b"".join(b"\0" + text(name) + text(value) for name, value in fields)


def call(stream, path, more=()):
    """A whole call with an empty message."""
    return frame(HEADERS, END_HEADERS, stream, headers(path, more)) + frame(DATA, END_STREAM, stream, b"\0" * 5)


class Client:
    """A connection whose frames are written by hand."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=5)
        self.come = b""
        self.send(PREFACE + frame(SETTINGS, 0, 0))

    def send(self, data):
        """False once the connection has ended, or takes nothing for five seconds."""
        try:
            self.socket.sendall(data)
            return True
        except OSError:
            return False

    def frames(self, seconds):
        """Yields type, flags and stream of what comes, for so long as something does."""
        self.socket.settimeout(seconds)
        while True:
            while len(self.come) >= 9 and len(self.come) >= 9 + int.from_bytes(self.come[:3], "big"):
                size = int.from_bytes(self.come[:3], "big")
                kind, flags, stream = struct.unpack(">BBI", self.come[3:9])
                self.come = self.come[9 + size :]
                yield kind, flags, stream
            try:
                data = self.socket.recv(65536)
            except OSError:
                return
            if not data:
                return
            self.come += data


class Front:
    """The daemon, and nginx before it."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.port = free_port()
        daemon_port = self.folder / "daemon-port"
        # Proxies have a connection for each call: the daemon is told who they are by nobody else.
        self.daemon = subprocess.Popen(
            [LIPOFILLD, "--listen", "127.0.0.1:0", "--data", folder + "/data", "--port-file", str(daemon_port)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        wait_until("the daemon", lambda: daemon_port.exists() and daemon_port.read_text().strip())
        self.configure(daemon_port.read_text().strip())
        self.nginx = subprocess.Popen([NGINX, "-p", folder, "-c", folder + "/nginx.conf"], stderr=subprocess.DEVNULL)
        wait_until("nginx", self.is_healthy)

    def configure(self, daemon_port):
        conf = pathlib.Path(CONFIGURATION).read_text()
        replaced = [
            (r"listen 443 ssl http2;", f"listen 127.0.0.1:{self.port} http2;"),
            (r"server 127\.0\.0\.1:50061;", f"server 127.0.0.1:{daemon_port};"),
            (r"ssl_certificate(_key)? [^;]*;", ""),
        ]
        for pattern, value in replaced:
            conf, count = re.subn(pattern, value, conf)
            if count == 0:
                sys.exit(f"{CONFIGURATION} has no {pattern} any more")
        (self.folder / "lipofill.conf").write_text(conf)
        user = "user root;" if os.geteuid() == 0 else ""
        (self.folder / "nginx.conf").write_text(MAIN.format(folder=self.folder, user=user))

    def is_healthy(self):
        """Whether a call of health through the front is answered."""
        try:
            client = Client(self.port)
        except OSError:
            return False
        client.send(call(1, HEALTH))
        return any(kind == DATA and stream == 1 for kind, _, stream in client.frames(2))

    def memory_mb(self):
        """Of the daemon, and of nginx with its workers."""
        children = pathlib.Path(f"/proc/{self.nginx.pid}/task/{self.nginx.pid}/children").read_text().split()
        return [resident_mb(self.daemon.pid), sum(resident_mb(pid) for pid in [self.nginx.pid, *children])]

    def stop(self):
        for process in (self.nginx, self.daemon):
            process.send_signal(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(30)


def flood_with_resets(front):
    """Opens and resets streams over and over, on a new connection where one is ended."""
    client, taken, ended = Client(front.port), 0, 0
    stream, block = 1, headers(HEALTH)
    end = time.monotonic() + 8
    while time.monotonic() < end:
        batch = b""
        for _ in range(100):
            batch += frame(HEADERS, END_HEADERS, stream, block) + frame(RESET, 0, stream, struct.pack(">I", 8))
            stream += 2
        if client.send(batch):
            taken += 100
            continue
        client, stream, ended = Client(front.port), 1, ended + 1
    return f"{taken} streams were opened and reset, {ended} connections ended"


def endless_headers(front):
    """nginx takes them or not; it keeps none of them."""
    client = Client(front.port)
    client.send(frame(HEADERS, 0, 1, headers(HEALTH)))
    more = frame(CONTINUATION, 0, 1, b"\0" + text("x") + text("y" * 16000))
    sent = 0
    while sent < 20000 and client.send(more):
        sent += 1
    return f"{sent} frames of headers without an end were taken"


def share_a_connection(front):
    """A watch goes on whatever headers another call on its connection has."""
    client = Client(front.port)
    client.send(call(1, "/grpc.health.v1.Health/Watch"))
    if not any(kind == DATA and stream == 1 for kind, _, stream in client.frames(2)):
        sys.exit("the watch of health does not begin")
    bad = [("trace-bin", "*" * 21), ("x-long", "x" * 9000), ("authorization", "Bearer " + "y" * 8000)]
    for at, field in enumerate(bad):
        client.send(call(3 + 2 * at, HEALTH, [field]))
        for kind, flags, stream in client.frames(1):
            if kind == GOAWAY or (stream == 1 and (kind == RESET or flags & END_STREAM)):
                sys.exit(f"the watch ends when another call has the header {field[0]}")
    client.send(call(21, HEALTH))
    if not any(stream == 21 and kind == DATA for kind, _, stream in client.frames(2)):
        sys.exit("the connection does not answer any more")
    return f"a watch goes on beside calls with {len(bad)} bad headers"


def main():
    if NGINX is None:
        print("there is no nginx here")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="lipofill-front-") as folder:
        front = Front(folder)
        try:
            before = front.memory_mb()
            for attack in (share_a_connection, endless_headers, flood_with_resets):
                print(attack(front))
                grown = [now - then for now, then in zip(front.memory_mb(), before)]
                print(f"  the daemon has grown by {grown[0]:.0f} MB, nginx by {grown[1]:.0f} MB")
                if max(grown) > MOST_GROWTH_MB:
                    sys.exit(f"they may grow by {MOST_GROWTH_MB} MB")
                wait_until("health", front.is_healthy)
        finally:
            front.stop()


if __name__ == "__main__":
    main()
