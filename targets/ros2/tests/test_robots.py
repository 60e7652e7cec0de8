"""Robots of several kinds: their commands, bumpers, batteries, ranges, clocks and names."""

import json
import math
import shutil
import subprocess
import time
from pathlib import Path

import pytest
from cyclonedds.core import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

import messages as m
from harness import ROOT, Run, built, configuration, drives, new_domain, running, stopped, until
from robot import RELIABLE, Robot

LATCHED = Qos(Policy.Reliability.Reliable(0), Policy.Durability.TransientLocal, Policy.History.KeepLast(8))


@pytest.fixture
def wall(tmp_path):
    """A floor with a wall 1.5 m ahead."""
    file = tmp_path / "wall.toml"
    file.write_text("[[wall]]\nname = 'ahead'\npoints = [[1.5, -3.0], [1.5, 3.0]]\n")
    return file


def arrives(run, robot):
    code, out, err = run.end()
    assert code == 0, out + err
    stopped(robot)


def test_commands_have_the_type_of_their_subscriber():
    for values in [{}, dict(stamped=True, frame_id="robot/base_link")]:
        domain = new_domain()
        with Robot(domain, stamped=True) as robot:
            listener = DataReader(robot.dp, robot.command_topic, qos=RELIABLE)
            with running("hop", configuration(domain, **values)) as run:
                arrives(run, robot)
            headers = {sample.header.frame_id for sample in listener.take(50)}
            assert headers == {values.get("frame_id", "base_link")}


def test_a_namespace_is_that_of_all_topics():
    domain = new_domain()
    with Robot(domain, namespace="a200_0000") as robot:
        with running("hop", configuration(domain, namespace="a200_0000")) as run:
            arrives(run, robot)


@pytest.mark.parametrize("bumper", ["bool", "hazard"])
def test_a_bumper_ends_its_atom(bumper, wall):
    domain = new_domain()
    with Robot(domain, wall, bumper=bumper) as robot:
        with running("until_bumper", configuration(domain, bumper_type=bumper)) as run:
            arrives(run, robot)
        assert robot.body.place.x > 1.2


def test_rays_are_a_bumper(wall):
    domain = new_domain()
    with Robot(domain, wall) as robot:
        values = dict(bumper_type="scan", body_radius=0.205, bumper_margin=0.1)
        with running("until_bumper", configuration(domain, **values)) as run:
            arrives(run, robot)
        assert 1.1 < robot.body.place.x < 1.3


@pytest.mark.parametrize("yaw", [0.0, math.pi])
def test_a_scan_is_sixteen_ranges(yaw, wall):
    def turned(scan):
        half = len(scan.ranges) // 2
        scan.ranges = scan.ranges[half:] + scan.ranges[:half]
        return scan

    domain = new_domain()
    with Robot(domain, wall) as robot:
        if yaw != 0:
            robot.changed["scan"] = turned
        with running("until_near", configuration(domain, ring_radius=0.2, scan_yaw=yaw)) as run:
            arrives(run, robot)
        # At 60 cm from the ring.
        assert 0.6 < robot.body.place.x < 0.85


def test_range_sensors_are_sonars(wall):
    domain = new_domain()
    with Robot(domain, wall) as robot:
        robot.add("front", m.Range)

        def ranged(bumper):
            range = 1.5 - robot.body.place.x - 0.1
            robot.writers["front"].write(m.Range(robot.header("front"), 0, 0.3, 0.02, 4.0, range, 0.0))
            return bumper

        robot.changed["bumper"] = ranged
        values = dict(scan="", ring_radius=0.2, ranges=[dict(topic="front", x=0.1)])
        with running("until_near", configuration(domain, **values)) as run:
            arrives(run, robot)
        assert 0.6 < robot.body.place.x < 0.85


def test_a_low_battery_ends_its_atom():
    domain = new_domain()
    with Robot(domain) as robot:
        robot.add("battery_state", m.BatteryState)
        charge = [0.9]

        def charged(bumper):
            state = m.BatteryState(header=robot.header(""), voltage=12.5, percentage=charge[0], power_supply_status=2)
            robot.writers["battery_state"].write(state)
            return bumper

        robot.changed["bumper"] = charged
        with running("until_low", configuration(domain, battery="battery_state")) as run:
            drives(robot)
            charge[0] = 0.1
            arrives(run, robot)


@pytest.mark.parametrize("charge, why", [(math.nan, "is no number"), (80.0, "is 80, and has to be from 0 to 1.5; 1 is full")])
def test_a_battery_without_a_charge_is_refused(charge, why):
    domain = new_domain()
    with Robot(domain) as robot:
        robot.add("battery_state", m.BatteryState)

        def charged(bumper):
            robot.writers["battery_state"].write(m.BatteryState(header=robot.header(""), percentage=charge))
            return bumper

        robot.changed["bumper"] = charged
        with running("until_low", configuration(domain, battery="battery_state")) as run:
            code, _, err = run.end()
            assert code == 3 and f"`/battery_state` has messages that cannot be used: `percentage` {why}" in err, err
            assert all(v == 0.0 for _, v, _ in robot.history), robot.history


def is_installed(machine):
    """Whether Rust compiles for this machine here."""
    command = ["rustc", "--print", "target-libdir", "--target", machine]
    libraries = subprocess.run(command, capture_output=True, text=True).stdout.strip()
    return libraries != "" and any(Path(libraries).glob("libstd-*"))


def test_an_executable_for_aarch64_drives():
    emulator = shutil.which("qemu-aarch64-static")
    if not emulator or not is_installed("aarch64-unknown-linux-musl"):
        pytest.skip("needs qemu-user-static, and `rustup target add aarch64-unknown-linux-musl`")
    domain = new_domain()
    with Robot(domain) as robot:
        # An emulated processor is slow.
        config = configuration(domain, stale_odom=5000, stale_scan=20000)
        arrives(Run(built("hop", machine="aarch64"), config, emulator=emulator), robot)
        assert 0.19 < robot.body.place.x < 1.0


def test_a_simulation_has_its_own_time():
    domain = new_domain()
    with Robot(domain, rate=200.0) as robot:
        robot.add("clock", m.Clock, "rt/clock")
        # Five times as fast as the host.
        clock = lambda: robot.writers["clock"].write(m.Clock(robot.header("").stamp))
        robot.changed["bumper"] = lambda bumper: clock() or bumper
        period = 1 / robot.rate
        odometry = robot.odometry

        def faster():
            robot.clock += 4 * period
            robot.body.move(4 * period)
            return odometry()

        robot.odometry = faster
        robot.watchdog = 60.0
        with running("hop", configuration(domain, use_sim_time=True, jump=1.0)) as run:
            arrives(run, robot)
        assert robot.body.place.x > 0.19


@pytest.mark.parametrize("back", [0.9, 2, 500])
def test_a_clock_that_goes_back_ends_the_plan(back):
    domain, shift = new_domain(), [0.0]
    with Robot(domain) as robot:
        robot.add("clock", m.Clock, "rt/clock")

        def clock(bumper):
            # The odometry has a time of its own, which goes on.
            nanos = int(1e9 * (robot.clock - shift[0]))
            robot.writers["clock"].write(m.Clock(m.Time(nanos // 10**9, nanos % 10**9)))
            return bumper

        robot.changed["bumper"] = clock
        robot.watchdog = 60.0
        with running("ride", configuration(domain, use_sim_time=True)) as run:
            drives(robot)
            since = time.monotonic()
            while run.process.poll() is None:
                passed = time.monotonic() - since
                assert passed < 8, "the plan goes on"
                # After a small step back the clock advances and goes back again, and never passes its latest time.
                shift[0] = back if back > 1 else back + passed // 0.5 * 0.5
                time.sleep(0.01)
            code, _, err = run.end()
            assert code == 3, err
            assert ("`/clock` has gone back by" if back > 1 else "its time has gone back") in err, err
            stopped(robot, since)


def test_the_state_of_the_plan_is_on_the_graph():
    domain = new_domain()
    with Robot(domain) as robot:
        state = DataReader(robot.dp, Topic(robot.dp, "rt/mdle/state", m.Text), qos=LATCHED)
        diagnostics = DataReader(robot.dp, Topic(robot.dp, "rt/diagnostics", m.DiagnosticArray), qos=LATCHED)
        nodes = DataReader(robot.dp, Topic(robot.dp, "ros_discovery_info", m.ParticipantEntitiesInfo), qos=LATCHED)
        with running("hop", configuration(domain)) as run:
            infos = []
            until(lambda: infos.extend(nodes.take(10)) or infos, "the node on the graph")
            arrives(run, robot)
        states, arrays = [], []

        def is_over():
            states.extend(json.loads(text.data) for text in state.take(50))
            arrays.extend(diagnostics.take(50))
            return states and states[-1]["status"] == "over" and arrays and arrays[-1].status[0].message == "over"

        until(is_over, "the end of the plan")
    node = infos[0].node_entities_info_seq[0]
    assert (node.node_namespace, node.node_name) == ("/", "mdle")
    assert len(node.reader_gid_seq) == 2 and len(node.writer_gid_seq) == 3
    atoms = [state["atom"] for state in states if state["status"] == "running"]
    assert atoms[0] == "go 10 0" and atoms[-1] == "stop"
    stop = next(state for state in states if state["atom"] == "stop")
    assert stop["plan"] == "Hop" and stop["scopes"] == ["Hop"] and stop["cause"].startswith("way = "), stop
    assert all(array.status[0].name == "mdle: plan" for array in arrays)


def test_the_listed_options_are_those_of_executables():
    help = subprocess.run([built("hop"), "-h"], capture_output=True, text=True, check=True).stdout
    lines = [line.lstrip() for line in help.splitlines()]
    options = [line.split("--", 1)[1].split("  ")[0] for line in lines if line.find("--") in (0, 4)]
    options = [option for option in options if option not in ("help", "version")]
    listed = (ROOT / "targets/ros2/options.txt").read_text().splitlines()[1:]
    assert listed == options
