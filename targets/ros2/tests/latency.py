"""The time from a scan to its command, of an executable and of a loop with nothing in it, at 10 and 50 Hz.

The robot shows a wall and takes it away by turns; `shy` drives backwards while it is near. The loop does the same
without a plan and without a host. Both take messages when a turn begins, and send what a turn computes when the next
one begins. They run by turns, so that other work of the machine meets both.

A time begins before the robot writes the scan, and ends where its middleware has the first command in the other
direction: both ways through the middlewares are part of it.
"""

import os
import random
import subprocess
import sys
import time

from cyclonedds.core import Listener
from cyclonedds.sub import DataReader

from harness import built, configuration, new_domain, until
from robot import RELIABLE, Robot

ROUNDS = 5
CHANGES = 40


class Heard(Listener):
    """Notes each command with the time at which it has come."""

    def __init__(self):
        super().__init__()
        self.commands = []

    def on_data_available(self, reader):
        now = time.monotonic()
        self.commands += [(now, sample.linear.x) for sample in reader.take(50) if hasattr(sample, "linear")]


def latencies(command, domain):
    """Milliseconds from each change of the scan to the first command in the other direction."""
    luck, times, heard = random.Random(domain), [], Heard()
    with Robot(domain, rate=50.0) as robot:
        robot.muted.add("scan")
        reader = DataReader(robot.dp, robot.command_topic, qos=RELIABLE, listener=heard)
        scan = robot.scan()

        def show(near):
            scan.header = robot.header("laser")
            scan.ranges = [0.5 if near else 5.0] * len(scan.ranges)
            since = time.monotonic()
            robot.writers["scan"].write(scan)
            return since

        def first(since, near):
            return next((t for t, v in heard.commands if t > since and (v < 0 if near else v > 0)), None)

        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        try:
            near = False
            until(lambda: show(near) and time.sleep(0.05) or any(v > 0 for _, v in heard.commands), "a velocity")
            for _ in range(CHANGES):
                near = not near
                time.sleep(luck.uniform(0.2, 0.4))
                heard.commands.clear()
                since = show(near)
                until(lambda: first(since, near) or process.poll() is not None, "the command")
                assert process.poll() is None, "the run has ended"
                times.append(1000 * (first(since, near) - since))
        finally:
            process.kill()
            process.wait()
            del reader
    return times


def main():
    plan, loop = built("shy"), sys.argv[1]
    for hertz in (10, 50):
        times, period = {"plan": [], "loop": []}, str(1000 // hertz)
        before = os.getloadavg()[0]
        for _ in range(ROUNDS):
            for name in times:
                domain = new_domain()
                config = configuration(domain, ring_radius=0.0, stale_odom=60000, stale_scan=60000)
                driven = [plan, "--config", config, "--period", f"{period}ms"]
                times[name] += latencies(driven if name == "plan" else [loop, config, period], domain)
        for name, all_times in times.items():
            ordered = sorted(all_times)
            half, most = ordered[len(ordered) // 2], ordered[len(ordered) * 99 // 100]
            print(f"{hertz} Hz, {name}: p50 {half:.1f} ms, p99 {most:.1f} ms, of {len(ordered)}")
        print(f"{hertz} Hz: load {before:.1f} before, {os.getloadavg()[0]:.1f} after")


if __name__ == "__main__":
    main()
