"""What the tests share: the router, robots that are linked by it, and what they report at which time."""

import contextlib
import os
import shutil
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import zenoh
from router import configuration

ROOT = Path(__file__).resolve().parents[3]
WORK = Path(os.environ.get("MDLE_FLEET_WORK", ROOT / "target/fleet/work"))
MDLE = Path(os.environ.get("MDLE", ROOT / "target/fleet/release/mdle"))
ROUTER = Path(__file__).with_name("router.py")
KEY = "a word of all robots"

# No event takes so long, however busy the machine is.
LONG = 120.0


def folder(name):
    """An empty folder."""
    place = WORK / name
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    return place


def free_port():
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        return bound.getsockname()[1]


def until(holds, what, limit=LONG):
    """Waits for an event; returns the time that it took."""
    begun = time.monotonic()
    while not holds():
        assert time.monotonic() - begun < limit, f"never: {what}"
        time.sleep(0.002)
    return time.monotonic() - begun


class Router:
    """A router that can be killed and started again, as a context."""

    def __init__(self):
        self.port = free_port()
        self.process = None

    @property
    def address(self):
        return f"tcp/127.0.0.1:{self.port}"

    def start(self):
        self.process = subprocess.Popen([sys.executable, ROUTER, str(self.port)], stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n"

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def send(self, signal):
        self.process.send_signal(signal)

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.kill()


def link(place, router, name, others, key=KEY, plans=None, start=None):
    """Writes the link file of a robot; `plans` are the keys of pairs."""
    text = f'name = "{name}"\nrouter = "{router.address}"\nkey = "{key}"\n'
    text += f'start = "{start}"\n' if start else ""
    for other in others:
        text += f'[[robot]]\nname = "{other}"\n'
        text += f'plans = "{plans[other]}"\n' if plans and other in plans else ""
    file = place / f"{name}.toml"
    file.touch(mode=0o600)
    file.write_text(text)
    return file


class Robot:
    """A running program, whose lines are noted with their times."""

    def __init__(self, place, words):
        self.lines, self.place = [], place
        command = [MDLE, *words.split()]
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, cwd=place, stdin=subprocess.DEVNULL, stdout=pipe, stderr=pipe, text=True)
        streams = (self.process.stdout, self.process.stderr)
        self.readers = [threading.Thread(target=self._read, args=(stream,), daemon=True) for stream in streams]
        for reader in self.readers:
            reader.start()

    def _read(self, stream):
        for line in stream:
            self.lines.append((time.monotonic(), line))

    @property
    def report(self):
        return "".join(line for _, line in list(self.lines))

    def time(self, words, since=0.0):
        """The time of the first line with these words after another time, or None."""
        return next((at for at, line in list(self.lines) if at >= since and words in line), None)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def end(self):
        """Waits for the end; returns the exit status."""
        status = self.process.wait(timeout=LONG)
        for reader in self.readers:
            reader.join(timeout=LONG)
        return status


@contextlib.contextmanager
def robots(place, plans, options=""):
    """Runs a plan for each name, on a simulated robot in real time with 50 turns a second."""
    running = {}
    try:
        for name, plan in plans.items():
            (place / f"{name}.mdle").write_text(plan + "\n")
            words = f"run {name}.mdle --target sim --world room --period 0.02 --link {name}.toml {options}"
            running[name] = Robot(place, words)
        yield running
    finally:
        for robot in running.values():
            if robot.process.poll() is None:
                robot.kill()


@contextlib.contextmanager
def stranger(router):
    """A session of somebody else with the router."""
    session = zenoh.open(configuration("client", connect=router.address))
    try:
        yield session
    finally:
        session.close()


def captured(session, robot):
    """A frame that a robot publishes, as it passes by."""
    frames = []
    subscriber = session.declare_subscriber(f"mdle/{robot}/state", lambda sample: frames.append(sample.payload.to_bytes()))
    until(lambda: frames, "a state")
    subscriber.undeclare()
    return frames[0]
