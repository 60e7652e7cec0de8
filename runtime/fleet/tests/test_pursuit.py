"""Local pursuit (paper, section IV-D) by three programs that are linked by a router."""

import math
import shutil

from harness import ROOT, Robot, Router, folder, link

# Name, plan, start on the first axis, and the options by which it records its ways.
ROBOTS = [
    ("robot1", "first_robot", 0.0, "--records lastPath --paths robot1"),
    ("robot2", "second_robot", -0.95, ""),
    ("robot3", "third_robot", -1.9, "--records lastPath --paths robot3"),
]
FLOOR = "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[-6, -6], [9, -6], [9, 6], [-6, 6], [-6, -6]]\n"
LAPS = 2


def excess(way):
    """By how much a way is longer than the distance of its ends, in percent."""
    length = sum(math.dist(one, other) for one, other in zip(way, way[1:]))
    return (length / math.dist(way[0], way[-1]) - 1) * 100


def trips(robot, place):
    """The ways of `path` by the report of a robot, as places of its record."""
    replayed = Robot(place, f"replay {robot.name}.mcap")
    assert replayed.end() == 0 and replayed.report.startswith("the same to the bit, "), replayed.report
    table = Robot(place, f"log export --csv {robot.name}.mcap")
    assert table.end() == 0
    rows = [line.split(",") for line in table.report.splitlines()[1:]]
    places = [(float(row[1]), (float(row[4]), float(row[5]))) for row in rows]
    lines = [line.split(" s  ", 1) for _, line in robot.lines if " s  " in line]
    lines = sorted((float(time), rest) for time, rest in lines if rest[:1].islower() or rest.startswith("Follow"))
    ways = []
    for (start, law), (end, _) in zip(lines, lines[1:]):
        if law.startswith("path"):
            ways.append([at for time, at in places if start <= time <= end])
    return ways


def test_three_robots_learn_a_short_way():
    place = folder("pursuit")
    names = [name for name, *_ in ROBOTS]
    (place / "floor.toml").write_text(FLOOR)
    with Router() as router:
        running = []
        for number, (name, plan, x, records) in enumerate(ROBOTS):
            (place / name).mkdir()
            text = (ROOT / f"plans/pursuit/{plan}.mdle").read_text().replace("ExecPlan 4", f"ExecPlan {LAPS}")
            (place / f"{plan}.mdle").write_text(text)
            link(place, router, name, [other for other in names if other != name], start=f"{x},0,0")
        shutil.copy(ROOT / "plans/pursuit/robot1/lastPath.csv", place / "robot1")
        for number, (name, plan, x, records) in enumerate(ROBOTS):
            world = f"--target sim --world floor.toml --body scout --seed {number} --start {x},0,0 --speed 2"
            running.append(Robot(place, f"run {plan}.mdle --link {name}.toml {records} --log {name}.mcap {world}"))
            running[-1].name = name
        assert [robot.end() for robot in running] == [0, 0, 0], [robot.report for robot in running]
    for robot in running:
        assert "plan over: completed" in robot.report, robot.report
    leaders = [excess(way) for pair in zip(trips(running[0], place), trips(running[2], place)) for way in pair]
    print("longer than straight by", ", ".join(f"{percent:.1f} %" for percent in leaders))
    assert len(leaders) == 2 * LAPS
    assert leaders[0] >= 20 and leaders[2] <= 6 and leaders[3] <= 3.5, leaders
    assert all(later < earlier for earlier, later in zip(leaders, leaders[2:])), leaders
