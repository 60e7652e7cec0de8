"""A robot behind CycloneDDS: a body that `cmd_vel` moves, and its odometry, scan and bumper.

Alone it runs until it is killed: `robot.py --domain 7 --world office.toml [--lockstep]`. Tests run it in a thread.
"""

import argparse
import math
import threading
import time
from pathlib import Path

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

import messages as m
from body import LEAST, MOST, RAYS, Body, Floor

# The loopback interface alone, whose multicast Linux does not announce.
LOOPBACK = """<CycloneDDS><Domain id="any">
<General>
<Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>
<AllowMulticast>true</AllowMulticast>
</General>
<Discovery><ParticipantIndex>auto</ParticipantIndex></Discovery>
</Domain></CycloneDDS>"""

# A network that passes no multicast: the robot hears and says only what is addressed to one program.
UNICAST = LOOPBACK.replace("<AllowMulticast>true", "<AllowMulticast>false")
# The same, and the robot knows where the driver is.
PEER = UNICAST.replace("</ParticipantIndex>", """</ParticipantIndex><MaxAutoParticipantIndex>20</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers>""")
NETWORKS = {"multicast": LOOPBACK, "unicast": UNICAST, "peer": PEER}

RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(50))
BEST_EFFORT = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))

_domains = {}


def participant(domain, network="multicast"):
    if domain not in _domains:
        _domains[domain] = Domain(domain, NETWORKS[network])
    return DomainParticipant(domain)


class Robot:
    """The robot; `muted` names the topics that are silent, and a function in `changed` may change a message."""

    def __init__(self, domain, world=None, stamped=False, lockstep=False, rate=20.0, bumper="bool", namespace="",
                 reliable=True, rays=RAYS, watchdog=0.5, network="multicast"):
        self.body, self.lockstep, self.rate, self.rays = Body(Floor(world)), lockstep, rate, rays
        self.domain, self.stamped, self.watchdog = domain, stamped, watchdog
        self.dp = participant(domain, network)
        self.qos = RELIABLE if reliable or lockstep else BEST_EFFORT
        prefix = f"rt/{namespace}/" if namespace else "rt/"
        self.prefix = prefix
        self.command_topic = Topic(self.dp, prefix + "cmd_vel", m.TwistStamped if stamped else m.Twist)
        self.commands = DataReader(self.dp, self.command_topic, qos=self.qos)
        self.writers = {}
        self.add("odom", m.Odometry)
        self.add("scan", m.LaserScan)
        self.bumper = bumper
        self.add("bumper", m.HazardDetectionVector if bumper == "hazard" else m.Bool)
        self.muted, self.changed, self.history = set(), {}, []
        self.clock = 1000.0
        self.offset = [0.0, 0.0]
        self.stopping = threading.Event()
        self.failure = None
        self.thread = None

    def add(self, name, kind, topic=None):
        self.writers[name] = DataWriter(self.dp, Topic(self.dp, topic or self.prefix + name, kind), qos=self.qos)

    def header(self, frame):
        return m.Header(m.Time(int(self.clock), int(self.clock % 1 * 1e9)), frame)

    def odometry(self):
        place, message = self.body.place, m.Odometry(self.header("odom"), "base_link")
        pose = message.pose.pose
        pose.position.x, pose.position.y = place.x + self.offset[0], place.y + self.offset[1]
        pose.orientation.z, pose.orientation.w = math.sin(place.theta / 2), math.cos(place.theta / 2)
        message.twist.twist.linear.x, message.twist.twist.angular.z = self.body.v, self.body.omega
        return message

    def scan(self):
        step = 2 * math.pi / self.rays
        ranges = [float(value) for value in self.body.scan(self.rays)]
        return m.LaserScan(self.header("laser"), -math.pi, math.pi - step, step, 0.0, 0.1, LEAST, MOST, ranges, [])

    def contact(self):
        if self.bumper != "hazard":
            return m.Bool(self.body.bumps)
        bump = m.HazardDetection(self.header("bump_front_center"), 1)
        return m.HazardDetectionVector(self.header("base_link"), [bump] if self.body.bumps else [])

    def publish(self):
        """Publishes all topics, the odometry last."""
        for name, message in [("bumper", self.contact), ("scan", self.scan), ("odom", self.odometry)]:
            if name in self.muted or name not in self.writers:
                continue
            sent = self.changed.get(name, lambda message: message)(message())
            if sent is not None:
                self.writers[name].write(sent)

    def take(self):
        """Obeys the commands that have come; returns their number."""
        taken = self.commands.take(50)
        now = time.monotonic()
        for sample in taken:
            if not hasattr(sample, "linear") and not hasattr(sample, "twist"):
                continue
            twist = sample.twist if self.stamped else sample
            self.body.v, self.body.omega = twist.linear.x, twist.angular.z
            self.history.append((now, twist.linear.x, twist.angular.z))
        return len(taken)

    def run(self):
        try:
            self.run_in_lockstep() if self.lockstep else self.run_in_time()
        except Exception as error:
            self.failure = error
            raise

    def run_in_time(self):
        period, due = 1 / self.rate, time.monotonic()
        while not self.stopping.is_set():
            self.take()
            # As the base of every robot does.
            if self.history and time.monotonic() - self.history[-1][0] > self.watchdog:
                self.body.v = self.body.omega = 0.0
            self.body.move(period)
            self.clock += period
            self.publish()
            due = max(due + period, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))

    def run_in_lockstep(self, period=0.1):
        idle = 0.0
        self.publish()
        while not self.stopping.is_set():
            if self.take():
                self.body.move(period)
                self.clock += period
                self.publish()
            else:
                time.sleep(0.0005)
                idle += 0.0005
                # Until the first command, for a driver that comes later.
                if not self.history and idle > 0.1:
                    idle = 0.0
                    self.publish()

    def __enter__(self):
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stopping.set()
        self.thread.join(10)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--world", type=Path)
    parser.add_argument("--lockstep", action="store_true")
    parser.add_argument("--stamped", action="store_true")
    parser.add_argument("--network", choices=NETWORKS, default="multicast")
    options = parser.parse_args()
    Robot(options.domain, options.world, options.stamped, options.lockstep, network=options.network).run()


if __name__ == "__main__":
    main()
