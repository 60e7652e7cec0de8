"""A suspension of the program, however short, ends its middleware: the robot is stopped all the same."""

import math
import signal
import time

import pytest
from cyclonedds.sub import DataReader

from harness import configuration, drives, new_domain, running, stopped
from robot import Robot

# A robot that nothing but a command stops.
RECKLESS = dict(watchdog=math.inf)
MIDDLEWARE = "the middleware of ROS 2 has ended, as it does when this program is suspended"


def suspend(run, seconds):
    """Suspends the program; returns the time at which it went on."""
    run.process.send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    since = time.monotonic()
    run.process.send_signal(signal.SIGCONT)
    return since


@pytest.mark.parametrize("seconds", [0.05, 0.3, 1.0, 5.0])
def test_a_suspension_stops_a_robot_without_a_watchdog(seconds):
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        since = suspend(run, seconds)
        code, _, err = run.end()
        print(f"the run has ended after {1000 * (time.monotonic() - since):.0f} ms")
        assert code == 3, err
        # After more than a second the host has noticed it first.
        assert MIDDLEWARE in err or seconds >= 1 and "was suspended" in err, err
        assert "may not have stopped" not in err, err
        stopped(robot, since)
        assert robot.body.v == 0.0


def test_a_signal_after_a_suspension_stops_the_robot():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        run.process.send_signal(signal.SIGSTOP)
        run.process.send_signal(signal.SIGINT)
        since = suspend(run, 0.05)
        code, _, err = run.end()
        assert code in (3, 130), err
        assert "may not have stopped" not in err, err
        stopped(robot, since)


def test_a_subscriber_that_acknowledges_nothing_is_stopped_after_a_suspension():
    domain = new_domain()
    with Robot(domain, reliable=False, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        since = suspend(run, 0.05)
        code, _, err = run.end()
        assert code == 3 and MIDDLEWARE in err, err
        stopped(robot, since)


def test_a_suspension_while_the_robot_is_stopped_is_survived():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        suspend(run, 0.05)
        # The new connection finds the robot, or has just found it.
        time.sleep(0.1)
        since = suspend(run, 0.05)
        code, _, err = run.end()
        assert code == 3 and MIDDLEWARE in err, err
        assert "may not have stopped" not in err, err
        stopped(robot, since)


def test_a_second_subscriber_is_stopped_after_a_suspension():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        # Such as a recorder, which need not be the one that is found last.
        other = DataReader(robot.dp, robot.command_topic, qos=robot.qos)
        since = suspend(run, 0.05)
        code, _, err = run.end()
        assert code == 3 and MIDDLEWARE in err, err
        stopped(robot, since)
        taken = other.take(1000)
        assert taken and taken[-1].linear.x == 0.0, taken


def test_a_robot_that_has_gone_after_a_suspension_is_reported_in_time():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        run.process.send_signal(signal.SIGSTOP)
        robot.take = lambda: 0
        robot.commands = None
        since = suspend(run, 0.05)
        code, _, err = run.end()
        passed = time.monotonic() - since
        print(f"the run has ended after {1000 * passed:.0f} ms")
        assert code == 3 and MIDDLEWARE in err and "may not have stopped" in err, err
        assert 5.0 < passed < 20.0


def test_a_suspension_while_the_robot_is_sought_ends_the_program():
    domain = new_domain()
    with running("ride", configuration(domain)) as run:
        time.sleep(1)
        suspend(run, 0.05)
        code, _, err = run.end()
        assert code == 3 and MIDDLEWARE in err, err
