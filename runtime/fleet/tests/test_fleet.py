"""Sixteen robots behind a router that is killed, and one of which is killed."""

import signal
import time

import pytest
from harness import Router, folder, link, robots, until

NAMES = [f"r{number}" for number in range(1, 17)]
VICTIM = NAMES[-1]
# A plan names eight other robots at most: half of the others.
NAMED = 8


def conditions(names, negated=False):
    return " AND ".join(f"{'NOT ' if negated else ''}sync {name}" for name in names)


def plan(names):
    """Waits until all these robots are heard, until they are stale, and until they are heard again; then for the victim."""
    left = [name for name in names if name != VICTIM]
    atoms = [f"({conditions(names)})", f"({conditions(names, True)})", f"({conditions(names)})"]
    atoms += [f"(NOT sync {VICTIM})"] if VICTIM in names else ["(wait 4)"]
    # The others still look for it meanwhile.
    atoms += [f"({conditions(left)})", "(wait 8)"]
    return "{ Fleet (wait 2min) " + " ".join(f"(Atom {condition} stop)" for condition in atoms) + " }"


def passed(fleet, atom, since):
    """The greatest time since an event within which a robot of the fleet has begun its atom of this number."""
    def times():
        # The first line names the second atom.
        lines = [[at for at, line in list(robot.lines) if " <- " in line] for robot in fleet]
        return [at[atom - 2] for at in lines if len(at) > atom - 2]

    until(lambda: len(times()) == len(fleet), f"atom {atom} of all: {[robot.report for robot in fleet]}")
    return max(times()) - since, min(times()) - since


@pytest.mark.parametrize("direction", [1, -1])
def test_everybody_hears_everybody_and_outlives_router_and_robot(direction):
    place = folder(f"fleet_{direction}")
    plans = {}
    with Router() as router:
        for at, name in enumerate(NAMES):
            link(place, router, name, [other for other in NAMES if other != name])
            plans[name] = plan([NAMES[(at + direction * step) % len(NAMES)] for step in range(1, NAMED + 1)])
        begun = time.monotonic()
        with robots(place, plans) as running:
            fleet = list(running.values())
            print(f"all heard after {passed(fleet, 2, begun)[0]:.2f} s")
            time.sleep(1)
            assert all(robot.report.count(" <- ") == 1 for robot in fleet), "heard, and still in the second atom"
            killed = time.monotonic()
            router.kill()
            last, first = passed(fleet, 3, killed)
            print(f"all stale {first:.2f} to {last:.2f} s after the router was killed")
            assert first > 0, "nothing was stale before"
            assert all("it has closed the connection" in robot.report for robot in fleet)
            restarted = time.monotonic()
            router.start()
            print(f"all fresh again {passed(fleet, 4, restarted)[0]:.2f} s after it was started")
            time.sleep(1)
            killed = time.monotonic()
            running[VICTIM].kill()
            others = [running[name] for name in NAMES[:-1]]
            hearers = [running[name] for name in plans if name != VICTIM and f"sync {VICTIM}" in plans[name]]
            assert len(hearers) == NAMED
            last, first = passed(hearers, 5, killed)
            print(f"{VICTIM} stale {first:.2f} to {last:.2f} s after it was killed")
            assert first > 0
            assert [robot.end() for robot in others] == [0] * len(others)
            for robot in others:
                assert "plan over: wait 8" in robot.report, robot.report
                assert robot.report.count("cannot be reached") == 1, robot.report
                assert robot.report.count("connected to the router") == 1, robot.report


def test_a_router_that_hangs_stops_no_turn():
    place, names = folder("hangs"), NAMES[:3]
    plans = {}
    with Router() as router:
        for name in names:
            others = [other for other in names if other != name]
            link(place, router, name, others)
            atoms = [f"({conditions(others)})", f"({conditions(others, True)})", f"({conditions(others)})", "(wait 8)"]
            plans[name] = "{ Hangs (wait 2min) " + " ".join(f"(Atom {condition} stop)" for condition in atoms) + " }"
        begun = time.monotonic()
        with robots(place, plans) as running:
            fleet = list(running.values())
            passed(fleet, 2, begun)
            time.sleep(1)
            stopped = time.monotonic()
            router.send(signal.SIGSTOP)
            print(f"all stale {passed(fleet, 3, stopped)[0]:.2f} s after the router hung")
            # Longer than the router waits for a sign of a robot, once it goes on.
            time.sleep(3)
            assert all(robot.report.count(" <- ") == 2 for robot in fleet), "stale, and still in the third atom"
            awake = time.monotonic()
            router.send(signal.SIGCONT)
            print(f"all fresh again {passed(fleet, 4, awake)[0]:.2f} s after it went on")
            assert [robot.end() for robot in fleet] == [0] * len(fleet)
            assert all("plan over: wait 8" in robot.report for robot in fleet)


def test_a_router_that_comes_later_or_never():
    place = folder("later")
    router = Router()
    for name, other in [("ada", "bob"), ("bob", "ada")]:
        link(place, router, name, [other])
    alone = "{ Alone (wait 2) (Atom (sync bob) stop) }"
    with robots(place, {"ada": alone}) as running:
        assert running["ada"].end() == 0
        report = running["ada"].report
        assert "plan over: wait 2" in report, report
        words = f"the router at 127.0.0.1:{router.port} cannot be reached: "
        assert report.count(words) == 1 and "start it, or correct `router` in ada.toml" in report, report
    plans = {name: "{ P (wait 1min) (Atom (rendezvous %s) stop) }" % other for name, other in [("ada", "bob"), ("bob", "ada")]}
    with robots(place, plans) as running:
        until(lambda: all("cannot be reached" in robot.report for robot in running.values()), "warnings")
        with router:
            assert [robot.end() for robot in running.values()] == [0, 0]
            for robot in running.values():
                assert "plan over: rendezvous" in robot.report, robot.report
                assert f"connected to the router at 127.0.0.1:{router.port} again" in robot.report, robot.report
