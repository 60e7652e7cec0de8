"""What the tests share: plans that are built, robots, and runs of plans on them."""

import contextlib
import itertools
import os
import signal
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
WORK = Path(os.environ.get("MDLE_ROS2_WORK", ROOT / "target/ros2/work"))
MDLEC = Path(os.environ.get("MDLEC", ROOT / "target/debug/mdlec"))
OFFICE = ROOT / "targets/sim/worlds/office.toml"

# No event takes so long, however busy the machine is.
LONG = 120.0

PLANS = {
    # Drives until something stops it.
    "ride": "{ Ride (wait 10min) (Atom (wait 10min) (go 10 0)) }",
    # Drives a little, and is over.
    "hop": "{ Hop (wait 10min) (Atom (way >= 20cm) (go 10 0)) (Atom (wait 300ms) stop) }",
    "until_bumper": "{ Until (wait 10min) (Atom (bumper) (go 20 0)) }",
    "until_near": "{ Until (wait 10min) (Atom (r0 < 60cm) (go 20 0)) }",
    "until_low": "{ Until (wait 10min) (Atom (lowBattery) (go 10 0)) }",
    "shy": "{ Shy (wait 10min) ((Atom (r0 < 60cm) (go 10 0)) (Atom (r0 > 60cm) (go -10 0)))^1000000 }",
}

# Under nohup the tests, and all that they start, would take no hangup.
signal.signal(signal.SIGHUP, signal.SIG_DFL)

_domains = itertools.count(2)


def new_domain():
    """A domain that no other test uses. Above 101 its ports are among those that the system gives to other programs."""
    return next(_domains)


def built(name, target="ros2", plan=None, machine=None):
    """The executable of a plan for a target, and for this machine or another, built once."""
    WORK.mkdir(parents=True, exist_ok=True)
    executable = WORK / "_".join(filter(None, [name, target, machine]))
    if plan is None:
        plan = WORK / f"{name}.mdle"
        plan.write_text(PLANS[name] + "\n")
    if executable not in built.done:
        command = [MDLEC, plan, "--target", target, "-o", executable]
        command += ["--machine", machine] if machine else []
        subprocess.run(command, check=True, capture_output=True, text=True, timeout=3600)
        built.done.add(executable)
    return executable


built.done = set()


def configuration(domain, **values):
    """Writes a configuration file."""
    WORK.mkdir(parents=True, exist_ok=True)
    values = {"domain": domain, "network": "127.0.0.1", "discovery": 60000, **values}
    text = "".join(f"{key.replace('_', '-')} = {toml(value)}\n" for key, value in values.items())
    file = WORK / f"domain_{domain}.toml"
    file.write_text(text)
    return file


def toml(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return "[" + ", ".join(toml(part) for part in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(part)}" for key, part in value.items()) + " }"
    return f'"{value}"' if isinstance(value, str) else repr(value)


class Run:
    """A running plan; with an emulator, in an emulated processor."""

    def __init__(self, executable, config, *options, emulator=None):
        command = [emulator] if emulator else []
        command += [executable, "--config", config, *options]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self):
        """Waits for the end; returns the exit status and both outputs."""
        out, err = self.process.communicate(timeout=LONG)
        return self.process.returncode, out, err


@contextlib.contextmanager
def running(name, config, *options):
    run = Run(built(name), config, *options)
    try:
        yield run
    finally:
        if run.process.poll() is None:
            run.process.kill()
            run.process.communicate()


def until(holds, what, limit=LONG):
    """Waits for an event; returns the time that it took."""
    begun = time.monotonic()
    while not holds():
        assert time.monotonic() - begun < limit, f"never: {what}"
        time.sleep(0.002)
    return time.monotonic() - begun


def drives(robot):
    """Waits until the robot is driven."""
    until(lambda: any(v != 0 for _, v, _ in robot.history), "a velocity")


def stopped(robot, since=None):
    """Waits for a zero velocity after the last other one; says how long that took since `since`."""
    until(lambda: robot.history and robot.history[-1][1:] == (0.0, 0.0), "a zero velocity")
    if since is not None:
        zero = next(t for t, v, omega in reversed(robot.history) if (v, omega) == (0.0, 0.0))
        first = zero
        for t, v, omega in reversed(robot.history):
            if (v, omega) != (0.0, 0.0):
                break
            first = t
        print(f"zero velocity after {1000 * (first - since):.0f} ms")
