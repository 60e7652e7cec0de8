"""Every way out sends a zero velocity, which the robot sees."""

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness import LONG, configuration, drives, new_domain, running, stopped, until
from robot import Robot

HERE = Path(__file__).parent


@pytest.mark.parametrize("number, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_a_signal_stops_the_robot(number, status):
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        since = time.monotonic()
        run.process.send_signal(number)
        code, _, err = run.end()
        assert code == status, err
        stopped(robot, since)


@pytest.mark.parametrize("option, value", [("--timeout", "2s"), ("--turns", "15")])
def test_a_limit_stops_the_robot(option, value):
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain), option, value) as run:
        code, _, err = run.end()
        assert code == 4, err
        drives(robot)
        stopped(robot)


def test_the_end_of_a_plan_stops_the_robot():
    domain = new_domain()
    with Robot(domain) as robot, running("hop", configuration(domain)) as run:
        code, out, err = run.end()
        assert code == 0, out + err
        stopped(robot)
        assert 0.19 < robot.body.place.x < 1.0


def test_a_subscriber_that_acknowledges_nothing_is_stopped_as_well():
    domain = new_domain()
    with Robot(domain, reliable=False) as robot, running("ride", configuration(domain), "--turns", "15") as run:
        code, _, err = run.end()
        assert code == 4, err
        zeros = sum((v, omega) == (0.0, 0.0) for _, v, omega in robot.history[-4:])
        assert zeros >= 3, robot.history[-6:]


def test_a_killed_program_leaves_the_robot_to_its_watchdog():
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        run.process.kill()
        run.process.wait(LONG)
        last = robot.history[-1][0]
        until(lambda: robot.body.v == 0.0, "the watchdog of the body")
        print(f"the body has stopped itself {1000 * (time.monotonic() - last):.0f} ms after the last command")


def test_a_killed_robot_is_a_fault():
    domain = new_domain()
    robot = subprocess.Popen([sys.executable, HERE / "robot.py", "--domain", str(domain)])
    try:
        log = Path(configuration(domain)).with_suffix(".log")
        log.unlink(missing_ok=True)
        with running("ride", configuration(domain), "--log", log) as run:
            until(lambda: log.exists() and log.read_text().count("\n") > 5, "turns")
            since = time.monotonic()
            os.kill(robot.pid, signal.SIGKILL)
            code, _, err = run.end()
            print(f"the run has ended {1000 * (time.monotonic() - since):.0f} ms after the robot")
            assert code == 3, err
            assert "`/odom` has been silent for" in err, err
    finally:
        robot.kill()
        robot.wait()


@pytest.mark.parametrize("seconds", [0.3, 1.0, 5.0])
def test_silence_is_a_fault_if_it_lasts(seconds):
    domain = new_domain()
    # Of 0.3 s and 1 s, with a machine that may be busy: the limit lies between them by a factor.
    config = configuration(domain, stale_odom=600)
    with Robot(domain) as robot, running("ride", config, "--timeout", "10s") as run:
        drives(robot)
        robot.muted.add("odom")
        since = time.monotonic()
        if seconds < 0.5:
            clock = robot.clock + seconds
            until(lambda: robot.clock > clock, "the end of the silence")
            robot.muted.clear()
            code, _, err = run.end()
            # A machine that is too busy makes the silence longer, which the message then says.
            longer = code == 3 and "`/odom` has been silent for" in err
            assert code == 4 or longer, err
        else:
            code, _, err = run.end()
            assert code == 3 and "`/odom` has been silent for" in err and "its limit is 600 ms" in err, err
            stopped(robot, since)


def test_a_base_that_acknowledges_and_drives_on_is_reported():
    domain = new_domain()
    with Robot(domain, watchdog=math.inf) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.take = lambda: len(robot.commands.take(50))
        run.process.send_signal(signal.SIGINT)
        code, _, err = run.end()
        assert code == 3 and "the robot may not have stopped: `/odom` still reports 0.10 m/s and 0°/s" in err, err


def test_a_base_that_stops_and_drives_on_is_reported():
    domain = new_domain()
    with Robot(domain, watchdog=math.inf) as robot, running("ride", configuration(domain)) as run:
        drives(robot)

        def stumbling():
            taken = robot.commands.take(50)
            if taken:
                stopped_at[0] = time.monotonic()
            robot.body.v = 0.0 if time.monotonic() - stopped_at[0] < 0.1 else 0.1
            return len(taken)

        stopped_at = [0.0]
        robot.take = stumbling
        run.process.send_signal(signal.SIGINT)
        code, _, err = run.end()
        assert code == 3 and "the robot may not have stopped: `/odom` still reports 0.10 m/s" in err, err


def test_a_base_that_neither_acknowledges_nor_reports_is_reported():
    domain = new_domain()
    with Robot(domain, watchdog=math.inf, reliable=False) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.muted.add("odom")
        run.process.send_signal(signal.SIGINT)
        code, _, err = run.end()
        assert code == 3 and "no message of `/odom` has come since the zero velocity" in err, err


def test_a_base_that_is_moving_is_stopped_while_it_is_opened():
    domain = new_domain()
    with Robot(domain, watchdog=math.inf) as robot:
        robot.body.v = 0.1
        robot.muted.add("scan")
        with running("ride", configuration(domain)) as run:
            time.sleep(2)
            since = time.monotonic()
            run.process.send_signal(signal.SIGINT)
            code, _, err = run.end()
            assert code == 130, err
            stopped(robot, since)


def test_a_base_that_slows_down_in_its_time_is_stopped():
    domain = new_domain()
    with Robot(domain, watchdog=math.inf) as robot, running("ride", configuration(domain)) as run:
        drives(robot)

        def slowing():
            speed, taken = robot.body.v, len(robot.commands.take(50))
            robot.body.v = max(0.0, speed - 0.005)
            return taken

        robot.take = slowing
        run.process.send_signal(signal.SIGINT)
        code, _, err = run.end()
        assert code == 130, err
