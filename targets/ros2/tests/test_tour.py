"""The lab tour on a robot behind CycloneDDS, in lockstep, beside the same tour in the simulator."""

import csv
import math
import re
import subprocess

from harness import OFFICE, ROOT, WORK, Run, built, configuration, new_domain
from robot import Robot

TOUR = ROOT / "plans/lab_tour.mdle"
BODY = dict(bumper_type="bool", body_radius=0.205, ring_radius=0.19, wheel_base=0.34519, fastest=1.0, fastest_turn=6.0)


def atoms(report):
    """The atoms of a report and what ended them, without the times."""
    return [re.sub(r"^[0-9.]+ s  ", "", line) for line in report.splitlines()]


def test_the_tour_ends_where_the_simulated_one_does():
    domain, trail = new_domain(), WORK / "tour.csv"
    simulated = [built("tour", "sim", TOUR), "--speed", "max", "--trail", trail]
    reference = subprocess.run(simulated, check=True, capture_output=True, text=True, timeout=600).stdout
    with trail.open() as rows:
        *_, end = csv.reader(rows)
    x, y, heading = map(float, end[1:4])
    with Robot(domain, OFFICE, lockstep=True) as robot:
        status, out, err = Run(built("tour", "ros2", TOUR), configuration(domain, **BODY), "--lockstep").end()
    assert status == 0, out + err
    assert atoms(out) == atoms(reference)
    place = robot.body.place
    off = math.hypot(place.x - x, place.y - y)
    turned = math.degrees(place.theta) - heading
    turned = math.remainder(turned, 360)
    print(f"{len(robot.history)} commands; {100 * off:.1f} cm and {turned:.1f}° from the simulated end")
    assert off < 0.15
    assert robot.history[-1][1:] == (0.0, 0.0)
