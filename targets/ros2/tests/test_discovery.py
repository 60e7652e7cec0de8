"""Robots that do not learn of the driver, or are silent."""

import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

import messages as m
from harness import LONG, built, configuration, new_domain, running, until
from robot import RELIABLE, Robot, participant

# The first bytes of a datagram of RTPS: its mark, version, vendor, and the id of the participant that sends it.
VENDOR, PREFIX, HEADER = 6, 8, 20
DRIVER = b"\x01\x12"
INFO_SOURCE = 0x0C


def port(domain, index):
    """The port at which the participant of a program on this computer hears of others."""
    return 7410 + 250 * domain + 2 * index


def announced_by_another(datagram):
    """The announcement of a participant, in a datagram that another participant of its program begins.

    CycloneDDS sends such a datagram if a program opens two participants at once.
    """
    mark, version, prefix, rest = datagram[:PREFIX], datagram[4:PREFIX], datagram[PREFIX:HEADER], datagram[HEADER:]
    other = prefix[:-1] + bytes([prefix[-1] ^ 1])
    return mark + other + struct.pack("<BBHI", INFO_SOURCE, 1, 20, 0) + version + prefix + rest


class Announcer:
    """Announces a robot so until it is `silent`, and counts the driver's participants."""

    def __init__(self, domain):
        self.domain, self.drivers, self.datagram = domain, [], None
        self.silent = self.ending = False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port(domain, 9)))
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        self.socket.settimeout(0.001)
        while not self.ending:
            try:
                datagram = self.socket.recv(65536)
                if datagram[VENDOR:PREFIX] != DRIVER:
                    self.datagram = self.datagram or announced_by_another(datagram)
                elif datagram[PREFIX:HEADER] not in self.drivers:
                    self.drivers.append(datagram[PREFIX:HEADER])
            except TimeoutError:
                pass
            if self.datagram and not self.silent:
                for index in range(1, 5):
                    self.socket.sendto(self.datagram, ("127.0.0.1", port(self.domain, index)))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ending = True
        self.thread.join(LONG)
        self.socket.close()


def test_a_robot_that_does_not_know_the_driver_is_found_anew():
    domain = new_domain()
    built("hop")
    with Announcer(domain) as announcer:
        command = [sys.executable, Path(__file__).with_name("robot.py"), "--domain", str(domain), "--network", "peer"]
        robot = subprocess.Popen(command)
        try:
            until(lambda: announcer.datagram, "an announcement")
            # The robot announces itself to the driver later.
            robot.send_signal(signal.SIGSTOP)
            with running("hop", configuration(domain, discovery=30000)) as run:
                until(lambda: announcer.drivers, "the driver")
                time.sleep(0.2)
                announcer.silent = True
                robot.send_signal(signal.SIGCONT)
                code, out, err = run.end()
                assert code == 0, out + err
            assert len(announcer.drivers) == 2
        finally:
            robot.kill()
            robot.wait()


def test_a_silent_topic_is_reported_after_the_time_to_find_it():
    domain = new_domain()
    built("ride")
    with Robot(domain) as robot:
        robot.muted.add("odom")
        begun = time.monotonic()
        with running("ride", configuration(domain, discovery=8000)) as run:
            code, out, err = run.end()
        assert code == 3 and "`/odom` has a publisher, and no message has come" in err, out + err
        assert 8 < time.monotonic() - begun < 20


def test_other_publishers_of_velocities_are_counted_at_the_start():
    domain = new_domain()
    with Robot(domain) as robot:
        # The first odometry comes when the driver has found the others.
        robot.muted.add("odom")
        others = [DataWriter(robot.dp, robot.command_topic, qos=RELIABLE) for _ in range(2)]
        with running("hop", configuration(domain)) as run:
            time.sleep(2)
            robot.muted.clear()
            code, out, err = run.end()
            assert code == 0 and "warning: `/cmd_vel` has 2 other publishers" in err, out + err
        del others


def test_subscribers_of_two_types_are_a_warning():
    domain = new_domain()
    with Robot(domain) as robot:
        # The first odometry comes when the driver has found the other.
        robot.muted.add("odom")
        dp = participant(domain)
        other = DataReader(dp, Topic(dp, "rt/cmd_vel", m.TwistStamped), qos=RELIABLE)
        with running("hop", configuration(domain)) as run:
            time.sleep(3)
            robot.muted.clear()
            code, out, err = run.end()
            warning = "warning: `/cmd_vel` has subscribers of two types, geometry_msgs/msg/Twist and geometry_msgs/msg/Tw"
            assert code == 0 and warning in err and "commands are geometry_msgs/msg/Twist, and" in err, out + err
        del other
