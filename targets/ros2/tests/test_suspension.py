"""A suspension of the program: a short one changes nothing, and after a long one the robot is stopped."""

import math
import signal
import time

import pytest
from cyclonedds.sub import DataReader

from harness import configuration, drives, new_domain, running, stopped, until
from robot import Robot

# A robot that nothing but a command stops.
RECKLESS = dict(watchdog=math.inf)
# Longer than the 10 s after which a silent program counts as dead, here and in the robot.
FORGOTTEN = 12.0


def suspend(run, seconds):
    """Suspends the program; returns the time at which it went on."""
    run.process.send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    since = time.monotonic()
    run.process.send_signal(signal.SIGCONT)
    return since


def drives_since(robot, since):
    """Waits until the robot is driven after that time."""
    until(lambda: any(v != 0 and t > since for t, v, _ in robot.history), "a velocity")


def ends_by_signal(run, robot):
    """Ends a run that drives; the robot has to be stopped."""
    since = time.monotonic()
    run.process.send_signal(signal.SIGTERM)
    code, _, err = run.end()
    assert code == 143, err
    stopped(robot, since)


@pytest.mark.parametrize("seconds", [0.003, 0.05, 0.3])
def test_a_short_suspension_changes_nothing(seconds):
    domain = new_domain()
    # The machine may be busy for longer.
    config = configuration(domain, stale_odom=5000)
    with Robot(domain, **RECKLESS) as robot, running("ride", config) as run:
        drives(robot)
        for _ in range(3):
            drives_since(robot, suspend(run, seconds))
        ends_by_signal(run, robot)


@pytest.mark.parametrize("seconds", [1.5, 5.0, FORGOTTEN])
def test_a_long_suspension_stops_the_robot(seconds):
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        since = suspend(run, seconds)
        code, _, err = run.end()
        print(f"the run has ended after {1000 * (time.monotonic() - since):.0f} ms")
        assert code == 3 and "was suspended" in err, err
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


@pytest.mark.parametrize("seconds", [0.05, FORGOTTEN])
def test_a_suspension_while_the_robot_is_stopped_is_survived(seconds):
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        # The robot acknowledges nothing for a while, so that the program is still at it.
        take, robot.take = robot.take, lambda: 0
        run.process.send_signal(signal.SIGTERM)
        time.sleep(0.02)
        since = suspend(run, seconds)
        robot.take = take
        code, _, err = run.end()
        assert code == 143 and "may not have stopped" not in err, err
        stopped(robot, since)


def test_a_base_that_drives_on_after_a_long_suspension_is_reported():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.take = lambda: len(robot.commands.take(50))
        suspend(run, FORGOTTEN)
        code, _, err = run.end()
        assert code == 3 and "the robot may not have stopped: `/odom` still reports 0.10 m/s" in err, err


def test_all_subscribers_are_stopped_after_a_long_suspension():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        # Such as a recorder, which need not be the one that is found last.
        other = DataReader(robot.dp, robot.command_topic, qos=robot.qos)
        until(lambda: other.take(1000), "a command for the second subscriber")
        since = suspend(run, FORGOTTEN)
        code, _, err = run.end()
        assert code == 3 and "may not have stopped" not in err, err
        stopped(robot, since)
        taken = other.take(1000)
        assert taken and taken[-1].linear.x == 0.0, taken


def test_a_subscriber_that_acknowledges_nothing_is_stopped_after_a_long_suspension():
    domain = new_domain()
    with Robot(domain, reliable=False, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        since = suspend(run, FORGOTTEN)
        code, _, err = run.end()
        assert code == 3, err
        stopped(robot, since)


def test_a_robot_that_has_gone_after_a_suspension_is_reported_in_time():
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        run.process.send_signal(signal.SIGSTOP)
        robot.take = lambda: 0
        robot.commands = None
        since = suspend(run, FORGOTTEN)
        code, _, err = run.end()
        passed = time.monotonic() - since
        print(f"the run has ended after {1000 * passed:.0f} ms")
        assert code == 3 and "may not have stopped" in err, err
        assert passed < 20.0


@pytest.mark.parametrize("tenths", range(1, 7, 2))
def test_a_suspension_while_the_robot_is_opened_is_survived(tenths):
    domain = new_domain()
    with Robot(domain, **RECKLESS) as robot, running("ride", configuration(domain)) as run:
        for _ in range(3):
            time.sleep(tenths / 30)
            suspend(run, 0.02)
        drives(robot)
        ends_by_signal(run, robot)


def test_a_suspension_while_the_robot_is_sought_is_survived():
    domain = new_domain()
    with running("ride", configuration(domain)) as run:
        time.sleep(1)
        suspend(run, 0.05)
        with Robot(domain, **RECKLESS) as robot:
            drives(robot)
            ends_by_signal(run, robot)
