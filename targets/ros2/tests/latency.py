"""The time from a scan to its command, of an executable and of a loop with nothing in it, at 10 and 50 Hz.

The robot shows a wall and takes it away by turns; `shy` drives backwards while it is near. The loop does the same
without a plan and without a host. Both take messages when a turn begins, and send what a turn computes when the next
one begins.
"""

import random
import subprocess
import sys
import time

from harness import built, configuration, new_domain, until
from robot import Robot

CHANGES = 100


def latencies(command, domain):
    """Milliseconds from each change of the scan to the first command in the other direction."""
    luck, times = random.Random(1), []
    with Robot(domain, rate=200.0) as robot:
        robot.muted.add("scan")
        scan, published = robot.scan(), [0.0]

        def show(near):
            scan.header = robot.header("laser")
            scan.ranges = [0.5 if near else 5.0] * len(scan.ranges)
            published[0] = time.monotonic()
            robot.writers["scan"].write(scan)

        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            near = False
            until(lambda: show(near) or time.sleep(0.05) or any(v > 0 for _, v, _ in robot.history), "a velocity")
            for _ in range(CHANGES):
                near = not near
                time.sleep(luck.uniform(0.2, 0.4))
                wanted = (lambda v: v < 0) if near else (lambda v: v > 0)
                show(near)
                until(lambda: wanted(robot.history[-1][1]), "the command")
                first = next(t for t, v, _ in robot.history if t > published[0] and wanted(v))
                times.append(1000 * (first - published[0]))
        finally:
            process.kill()
            process.wait()
    return sorted(times)


def main():
    plan, loop = built("shy"), sys.argv[1]
    for hertz in (10, 50):
        for name in ("plan", "loop"):
            domain = new_domain()
            config = configuration(domain, ring_radius=0.0, stale_scan=60000)
            period = str(1000 // hertz)
            command = {"plan": [plan, "--config", config, "--period", f"{period}ms"], "loop": [loop, config, period]}
            times = latencies(command[name], domain)
            half, most = times[len(times) // 2], times[len(times) * 99 // 100]
            print(f"{hertz} Hz, {name}: p50 {half:.1f} ms, p99 {most:.1f} ms, of {len(times)}")


if __name__ == "__main__":
    main()
