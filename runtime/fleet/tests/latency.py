"""The time of a state from robot to robot, of 16 robots with 50 turns a second, by a router and over TCP.

Each robot is a process; all are on this machine. The links take turns, so that other work of the machine meets both.
"""

import os
import random
import subprocess
import sys

from harness import Router

ROBOTS, SECONDS, ROUNDS = 16, 20, 3


def measured(example, kind, port, robots=ROBOTS, seconds=SECONDS):
    """What the first robot prints."""
    words = [[example, kind, number, robots, port, seconds] for number in range(robots)]
    fleet = [subprocess.Popen(list(map(str, line)), stdout=subprocess.PIPE, text=True) for line in words]
    outputs = [robot.communicate()[0] for robot in fleet]
    assert all(robot.returncode == 0 for robot in fleet)
    return outputs[0].strip()


def main():
    for _ in range(ROUNDS):
        load = os.getloadavg()[0]
        print(measured(sys.argv[1], "tcp", random.randrange(20_000, 30_000)), f"(load {load:.1f} before)", flush=True)
        with Router() as router:
            load = os.getloadavg()[0]
            print(measured(sys.argv[1], "router", router.port), f"(load {load:.1f} before)", flush=True)


if __name__ == "__main__":
    main()
