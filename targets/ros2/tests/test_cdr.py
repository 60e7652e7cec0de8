"""All messages of the driver, against the encoder and the decoder of rosbags, in the layouts of Humble and Jazzy."""

import json
import os
import random
import subprocess
from pathlib import Path

import numpy
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PROGRAM = Path(os.environ["MDLE_ROS2_CDR"])
OTHERS = {
    "irobot_create_msgs/msg/HazardDetection": "std_msgs/Header header\nuint8 type\n",
    "irobot_create_msgs/msg/HazardDetectionVector": "std_msgs/Header header\nHazardDetection[] detections\n",
}
TYPES = {
    "Twist": "geometry_msgs/msg/Twist",
    "TwistStamped": "geometry_msgs/msg/TwistStamped",
    "Odometry": "nav_msgs/msg/Odometry",
    "LaserScan": "sensor_msgs/msg/LaserScan",
    "Range": "sensor_msgs/msg/Range",
    "Bool": "std_msgs/msg/Bool",
    "String": "std_msgs/msg/String",
    "HazardDetectionVector": "irobot_create_msgs/msg/HazardDetectionVector",
    "BatteryState": "sensor_msgs/msg/BatteryState",
    "Clock": "rosgraph_msgs/msg/Clock",
    "DiagnosticArray": "diagnostic_msgs/msg/DiagnosticArray",
}
STORES = {"humble": Stores.ROS2_HUMBLE, "jazzy": Stores.ROS2_JAZZY}


def store(distribution):
    types = get_typestore(STORES[distribution])
    for name, text in OTHERS.items():
        types.register(get_types_from_msg(text, name))
    return types


def value(types, kind, luck):
    """A random value of a field's type, as rosbags describes it."""
    node, what = int(kind[0]), kind[1]
    if node == 2:
        return message(types, what, luck)
    if node == 1:
        name = what[0]
        if name == "string":
            return "".join(luck.choices("aß/ _9", k=luck.randrange(9)))
        if name == "bool":
            return luck.random() < 0.5
        if name.startswith("float"):
            # Single precision has the same shortest text everywhere only if it has few digits.
            return luck.randrange(-8000, 8000) / 8 if name == "float32" else luck.uniform(-1e3, 1e3)
        bits = int(name.removeprefix("u").removeprefix("int") or 8) if name not in ("byte", "octet") else 8
        return luck.randrange(2 ** (bits - 1))
    part, count = what
    values = [value(types, part, luck) for _ in range(count if node == 3 else luck.randrange(5))]
    if int(part[0]) == 1 and part[1][0] != "string":
        return numpy.array(values, dtype={"byte": "uint8", "octet": "uint8"}.get(part[1][0], part[1][0]))
    return values


def message(types, name, luck):
    fields = types.fielddefs[name][1]
    return types.types[name](**{field: value(types, kind, luck) for field, kind in fields})


def plain(thing):
    """A message as JSON has it, with the names of the driver, without constants."""
    if isinstance(thing, numpy.ndarray):
        return thing.tolist()
    if isinstance(thing, list):
        return [plain(part) for part in thing]
    if hasattr(thing, "__msgtype__"):
        fields = {key: plain(part) for key, part in vars(thing).items() if not (key.isupper() or key.startswith("__"))}
        return {"kind" if key == "type" else key: part for key, part in fields.items()}
    return thing


def converted(lines):
    text = "".join(f"{line}\n" for line in lines)
    run = subprocess.run([PROGRAM], input=text, capture_output=True, text=True, check=True, timeout=600)
    return run.stdout.splitlines()


@pytest.mark.parametrize("distribution", STORES)
@pytest.mark.parametrize("name", TYPES)
def test_messages_are_those_of_rosbags(distribution, name):
    types, luck = store(distribution), random.Random(f"{distribution} {name}")
    ours = "ShortRange" if (distribution, name) == ("humble", "Range") else name
    messages = [message(types, TYPES[name], luck) for _ in range(50)]
    theirs = [bytes(types.serialize_cdr(each, TYPES[name])) for each in messages]
    # Read by the driver.
    read = converted(f"{ours} read {each[4:].hex()}" for each in theirs)
    assert [json.loads(line) for line in read] == [plain(each) for each in messages]
    # Written by the driver.
    written = converted(f"{ours} write {json.dumps(plain(each))}" for each in messages)
    header = bytes([0, 1, 0, 0])
    back = [types.deserialize_cdr(header + bytes.fromhex(line), TYPES[name]) for line in written]
    assert [plain(each) for each in back] == [plain(each) for each in messages]
    for line, each in zip(written, theirs):
        assert each[4:].startswith(bytes.fromhex(line)) and len(each) - 4 - len(line) // 2 < 4


@pytest.mark.parametrize("distribution, size", [("humble", 24), ("jazzy", 16)])
def test_the_nodes_of_a_program_are_those_of_rosbags(distribution, size):
    types, luck = get_typestore(STORES[distribution]), random.Random(distribution)
    package = "rmw_dds_common/msg/"
    name = package + "ParticipantEntitiesInfo"
    gid, node, info = (types.types[package + each] for each in ["Gid", "NodeEntitiesInfo", "ParticipantEntitiesInfo"])

    def ids(count):
        return [[luck.randrange(256) for _ in range(16)] for _ in range(count)]

    def theirs(id):
        return gid(numpy.array(id + [0] * (size - 16), dtype="uint8"))

    for _ in range(20):
        [own], readers, writers = ids(1), ids(luck.randrange(4)), ids(luck.randrange(4))
        names = ["/" + "a" * luck.randrange(9), "b" * luck.randrange(9)]
        message = info(theirs(own), [node(*names, [*map(theirs, readers)], [*map(theirs, writers)])])
        keys = ["node_namespace", "node_name", "reader_gid_seq", "writer_gid_seq"]
        ours = {"gid": own, "node_entities_info_seq": [dict(zip(keys, [*names, readers, writers]))]}
        expected = bytes(types.serialize_cdr(message, name))[4:]
        [written] = converted([f"{'Participant' if size == 16 else 'Long'}EntitiesInfo write {json.dumps(ours)}"])
        assert expected.startswith(bytes.fromhex(written)) and len(expected) - len(written) // 2 < 4
        if size == 16:
            assert json.loads(*converted([f"ParticipantEntitiesInfo read {expected.hex()}"])) == ours


@pytest.mark.parametrize("name", TYPES)
def test_damaged_bytes_are_no_message_and_no_crash(name):
    types, luck = store("jazzy"), random.Random(name)
    lines = []
    for _ in range(200):
        whole = bytearray(types.serialize_cdr(message(types, TYPES[name], luck), TYPES[name]))[4:]
        for _ in range(luck.randrange(1, 4)):
            if whole:
                whole[luck.randrange(len(whole))] = luck.randrange(256)
        cut = whole[: luck.randrange(len(whole) + 1)] if luck.random() < 0.5 else whole + bytes(luck.randrange(9))
        lines.append(f"{name} read {bytes(cut).hex()}")
    answers = converted(lines)
    assert len(answers) == len(lines)
    assert name == "Bool" or any(answer.startswith("error: ") for answer in answers)
