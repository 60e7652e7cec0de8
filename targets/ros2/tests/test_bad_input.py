"""Robots that are missing, double, late, damaged or mad."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cyclonedds.core import Policy, Qos
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from dataclasses import dataclass

import messages as m
from harness import LONG, built, configuration, drives, new_domain, running, stopped, until
from robot import RELIABLE, Robot, participant


def ends_with(status, sentence, run, robot=None):
    """Checks the end of a run, which a sentence explains, and that the robot stands."""
    code, out, err = run.end()
    assert code == status, (code, out, err)
    assert sentence in err, err
    if robot:
        stopped(robot)
    return err


def test_a_second_publisher_of_odometry_counts_if_it_sends():
    domain = new_domain()
    with Robot(domain) as robot:
        other = DataWriter(robot.dp, Topic(robot.dp, "rt/odom", m.Odometry), qos=RELIABLE)
        with running("hop", configuration(domain)) as run:
            code, out, err = run.end()
            assert code == 0, out + err
        robot.changed["odom"] = lambda message: other.write(message) or message
        with running("ride", configuration(domain)) as run:
            ends_with(3, "`/odom` has 2 publishers, and the pose is that of one", run)
        del other


@pytest.mark.parametrize("clock", [1000.0, 2000.0])
def test_a_robot_that_was_restarted_is_one_publisher(clock):
    domain = new_domain()
    built("hop")
    command = [sys.executable, Path(__file__).with_name("robot.py"), "--domain", str(domain)]
    first = subprocess.Popen(command)
    try:
        with running("hop", configuration(domain, bumper_type="bool", bumper="late")) as run:
            # The driver waits for the bumper, and hears the first robot.
            time.sleep(5)
            first.kill()
            with Robot(domain) as second:
                second.clock = clock
                second.add("late", m.Bool)
                if clock < 1001:
                    sentence = "has 2 publishers, and the last one has sent another pose or time than the one before"
                    assert "if the robot was restarted, start the plan again" in ends_with(3, sentence, run)
                else:
                    code, out, err = run.end()
                    assert code == 0, out + err
    finally:
        first.kill()
        first.wait()


def test_two_publishers_with_different_poses_are_refused_as_two():
    domain = new_domain()
    with Robot(domain) as robot:
        other = DataWriter(robot.dp, Topic(robot.dp, "rt/odom", m.Odometry), qos=RELIABLE)

        def twice(message):
            robot.writers["odom"].write(message)
            message.pose.pose.position.x += 1.5
            message.header.stamp.nanosec += 1
            other.write(message)

        robot.changed["odom"] = twice
        with running("ride", configuration(domain)) as run:
            ends_with(3, "`/odom` has 2 publishers", run)
        del other


def test_a_second_publisher_that_comes_later_is_a_fault():
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        other = DataWriter(robot.dp, Topic(robot.dp, "rt/odom", m.Odometry), qos=RELIABLE)

        def again():
            other.write(robot.odometry())
            return run.process.poll() is not None

        until(again, "the end of the run")
        ends_with(3, "`/odom` has 2 publishers", run, robot)


def test_odometry_that_jumps_is_a_fault():
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.offset[0] = 7.0
        ends_with(3, "the odometry has jumped by 7.", run, robot)


def test_odometry_that_goes_back_in_time_is_a_fault():
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.clock -= 100.0
        ends_with(3, "the odometry has gone back in time by ", run, robot)


def test_a_frozen_clock_makes_odometry_stale():
    def frozen(message):
        message.header.stamp = m.Time(7, 7)
        return message

    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        robot.changed["odom"] = frozen
        # The first message is taken, and all others have its time.
        err = ends_with(3, "`/odom` has been silent for", run)
        assert "its time is not after that of the message before" in err or "gone back" in err, err


def test_odometry_that_is_no_number_is_a_fault():
    def none(message):
        message.pose.pose.position.x = float("nan")
        return message

    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.changed["odom"] = none
        ends_with(3, "the odometry has no pose", run, robot)


@pytest.mark.parametrize("rays", [1, 40_000])
def test_any_number_of_rays_will_do(rays):
    domain = new_domain()
    with Robot(domain, rays=rays) as robot, running("hop", configuration(domain, stale_scan=10000)) as run:
        code, out, err = run.end()
        assert code == 0, out + err
        stopped(robot)


def test_a_scan_that_does_not_look_ahead_is_no_bumper():
    domain = new_domain()
    built("ride")
    with Robot(domain, rays=1), running("ride", configuration(domain, bumper_type="scan")) as run:
        begun = time.monotonic()
        ends_with(3, "`/scan` has messages that cannot be used: as a bumper (`bumper-type = \"scan\"`) the scan has", run)
        # After the limit of the scan, which is a second, and not at the end of `discovery`.
        assert time.monotonic() - begun < 30


def test_a_scan_without_a_valid_ray_is_no_scan():
    def blind(message):
        message.ranges = [float("nan")] * len(message.ranges)
        return message

    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.changed["scan"] = blind
        err = ends_with(3, "`/scan` has been silent for", run, robot)
        assert "none of its 360 rays is valid" in err


def test_a_robot_that_comes_later_is_waited_for():
    domain = new_domain()
    with running("hop", configuration(domain)) as run:
        time.sleep(2)
        with Robot(domain) as robot:
            code, out, err = run.end()
            assert code == 0, out + err
            stopped(robot)


def test_a_subscriber_that_comes_later_is_waited_for():
    domain = new_domain()
    robot = Robot(domain)
    robot.commands, robot.take = None, lambda: 0
    with robot, running("hop", configuration(domain)) as run:
        time.sleep(2)
        assert run.process.poll() is None and not robot.history
        robot.commands = DataReader(robot.dp, robot.command_topic, qos=robot.qos)
        del robot.take
        code, out, err = run.end()
        assert code == 0, out + err
        stopped(robot)


def test_a_subscriber_that_vanishes_is_a_fault():
    domain = new_domain()
    with Robot(domain) as robot, running("ride", configuration(domain)) as run:
        drives(robot)
        robot.take = lambda: 0
        robot.commands = None
        ends_with(3, "nobody subscribes to `/cmd_vel` any more", run)


def test_damaged_bytes_are_left_out():
    @dataclass
    class Damaged(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
        text: str = "no odometry"

    domain = new_domain()
    with Robot(domain) as robot:
        robot.muted.add("odom")
        del robot.writers["odom"]
        other = DataWriter(robot.dp, Topic(robot.dp, "rt/odom", Damaged), qos=RELIABLE)
        robot.changed["bumper"] = lambda message: other.write(Damaged()) or message
        with running("ride", configuration(domain, discovery=8000)) as run:
            ends_with(3, "`/odom` has messages that cannot be used: ", run)


def test_the_layout_of_another_distribution_is_named():
    domain = new_domain()
    with Robot(domain) as robot:
        robot.add("front", m.ShortRange)
        message = m.ShortRange(robot.header("front"), 0, 0.3, 0.02, 4.0, 1.0)
        robot.changed["bumper"] = lambda bumper: robot.writers["front"].write(message) or bumper
        values = dict(scan="", ranges=[dict(topic="front")])
        with running("ride", configuration(domain, discovery=8000, **values)) as run:
            ends_with(3, "`/front` has messages that cannot be used: ", run)
        with running("hop", configuration(domain, distribution="humble", **values)) as run:
            code, out, err = run.end()
            assert code == 0, out + err


def test_a_missing_topic_names_what_is_there():
    domain = new_domain()
    with Robot(domain), running("ride", configuration(domain, odom="wheel_odom", discovery=8000)) as run:
        err = ends_with(3, "nobody publishes `/wheel_odom` (nav_msgs/msg/Odometry)", run)
        assert f"domain {domain} has publishers of /bumper (std_msgs/msg/Bool), /odom (nav_msgs" in err, err
        assert ", and subscribers of /cmd_vel (geometry_msgs/msg/Twist)" in err, err
        assert err.endswith('help: write `odom = "/odom"` into the file of --config\n'), err


def test_an_empty_graph_is_a_fault():
    domain = new_domain()
    with running("ride", configuration(domain, discovery=3000)) as run:
        ends_with(3, f"error: no program of ROS 2 answers in domain {domain}", run)


@pytest.mark.parametrize("network, kind", [
    ("203.0.113.9", "no address of this computer"),
    ("224.0.0.1", "an address of multicast"),
    ("::1", "an address of IPv6, and the driver uses only IPv4"),
])
def test_an_unknown_network_is_refused(network, kind):
    with running("ride", configuration(new_domain(), network=network, discovery=60000)) as run:
        begun = time.monotonic()
        err = ends_with(2, f"`network` is `{network}`, which is {kind}; this computer has 127.0.0.1", run)
        assert time.monotonic() - begun < 30, err


def test_no_network_is_a_fault():
    domain = new_domain()
    command = ["unshare", "--net", "--map-root-user", built("ride"), "--config", configuration(domain, discovery=3000)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=LONG)
    assert run.returncode == 3, run
    assert f"no program of ROS 2 answers in domain {domain}" in run.stderr and "multicast" in run.stderr, run.stderr


def test_without_multicast_a_robot_that_knows_the_address_is_driven():
    domain = new_domain()
    command = [sys.executable, Path(__file__).with_name("robot.py"), "--domain", str(domain), "--network", "peer"]
    robot = subprocess.Popen(command)
    try:
        with running("hop", configuration(domain)) as run:
            code, out, err = run.end()
            assert code == 0, out + err
    finally:
        robot.kill()
        robot.wait()


def test_another_quality_of_service_is_named():
    domain = new_domain()
    dp = participant(domain)
    latched = Qos(Policy.Reliability.Reliable(0), Policy.Durability.TransientLocal)
    reader = DataReader(dp, Topic(dp, "rt/cmd_vel", m.Twist), qos=latched)
    with running("ride", configuration(domain, discovery=8000)) as run:
        ends_with(3, "the subscriber of `/cmd_vel` wants another quality of service (Durability)", run)
    del reader


def test_another_type_of_command_is_named():
    domain = new_domain()
    with Robot(domain, stamped=True), running("ride", configuration(domain, discovery=8000, stamped=False)) as run:
        ends_with(3, "takes geometry_msgs/msg/TwistStamped, and commands are geometry_msgs/msg/Twist", run)


@pytest.mark.parametrize("values, sentence", [
    (dict(domain=233), "`domain` is 233, and has to be a whole number from 0 to 232"),
    (dict(topic="odom"), "there is no key `topic`"),
    (dict(odom="2nd odom"), "`2nd odom` is no name of a topic"),
    (dict(distribution="foxy"), '`distribution` is "foxy", and has to be "humble" or "jazzy" or "kilted"'),
    (dict(network="robot.local"), "`network` is `robot.local`, and has to be an address"),
    (dict(scan="", bumper_type="scan"), '`bumper-type` is "scan", and there is no `scan`'),
])
def test_a_bad_configuration_is_refused(values, sentence):
    config = configuration(**{"domain": new_domain(), **values})
    with running("ride", config) as run:
        ends_with(2, sentence, run)


def test_a_period_longer_than_the_robot_may_be_without_a_command_is_refused():
    with running("ride", configuration(new_domain()), "--period", "2s") as run:
        ends_with(2, "a turn of 2000 ms is longer than the robot may be without a command, 1000 ms", run)


@pytest.mark.parametrize("domain", ["233", "robot"])
def test_a_bad_domain_of_the_environment_is_refused(domain):
    environment = {**os.environ, "ROS_DOMAIN_ID": domain}
    run = subprocess.run([built("ride")], capture_output=True, text=True, timeout=LONG, env=environment)
    assert run.returncode == 2, run
    assert f"the variable ROS_DOMAIN_ID is `{domain}`, and has to be a number from 0 to 232" in run.stderr, run.stderr


def test_a_plan_that_needs_more_is_refused():
    with running("until_bumper", configuration(new_domain())) as run:
        ends_with(2, "the plan uses `bumper`, which needs bumper, and this configuration gives the robot none", run)
    with running("until_near", configuration(new_domain(), scan="")) as run:
        ends_with(2, "the plan uses `r`, which needs sonar[16]", run)


def test_a_configuration_is_read_from_a_pipe():
    domain = new_domain()
    text = configuration(domain).read_text()
    printed = subprocess.run([built("hop"), "--print-config", "--config", "/dev/stdin"], input=text, capture_output=True,
                             text=True, timeout=LONG)
    assert printed.returncode == 0 and f"domain = {domain} " in printed.stdout, printed
    with Robot(domain):
        run = subprocess.run([built("hop"), "--config", "/dev/stdin"], input=printed.stdout, capture_output=True, text=True,
                             timeout=LONG)
        assert run.returncode == 0, run
