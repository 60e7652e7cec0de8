"""Frames that are none, or are not to be taken, from a program of others and from robots with other keys."""

import random
import time

from harness import Robot, Router, captured, folder, link, robots, stranger, until

PAIR = [("ada", "bob"), ("bob", "ada")]


def hears(other, seconds=6):
    return "{ Hears (wait 1min) (Atom (sync %s) stop) (Atom (NOT sync %s OR wait %s) stop) }" % (other, other, seconds)


def test_frames_of_a_stranger_are_refused_once_and_stop_nobody():
    place = folder("stranger")
    with Router() as router:
        for name, other in PAIR:
            link(place, router, name, [other], plans={other: "a word of two"})
        with stranger(router) as session, robots(place, {name: hears(other) for name, other in PAIR}) as running:
            frame = captured(session, "ada")
            luck = random.Random(1)
            version = frame[:4] + bytes([frame[4] + 1]) + frame[5:]
            damaged = frame[:-1] + bytes([frame[-1] ^ 1])
            until(lambda: all(" <- " in robot.report for robot in running.values()), "robots that hear each other")
            session.put("mdle/ada/state", bytes(1_000_000))
            session.put("mdle/ada/state", bytes(60_000))
            sent = 2
            while not any("plan over" in robot.report for robot in running.values()):
                noise = luck.randbytes(luck.randrange(300))
                for key in ["mdle/ada/state", "mdle/bob/state", "mdle/ada/letters/bob", "mdle/bob/letters/ada"]:
                    for payload in [noise, b"", version, damaged, b"MDLl" + frame[4:5] + noise]:
                        session.put(key, payload)
                        sent += 1
                time.sleep(0.005)
            print(f"{sent} frames of a stranger")
            assert [robot.end() for robot in running.values()] == [0, 0]
        for name, other in PAIR:
            report = running[name].report
            assert "plan over: wait 6" in report, report
            for key in [f"mdle/{other}/state", f"mdle/{other}/letters/{name}"]:
                for reason in ["it sends no states", f"its version of the link is {frame[4] + 1}"]:
                    assert report.count(f"a sender under {key} is refused: {reason}") == 1, (key, reason, report)
            assert report.count(f"a letter of {other} is refused: it is damaged") == 1, report


def test_an_old_state_that_is_sent_again_is_not_fresh():
    place = folder("replayed")
    with Router() as router:
        for name, other in PAIR:
            link(place, router, name, [other])
        plans = {"ada": "{ P (wait 1min) (Atom (null) stop) }", "bob": "{ P (wait 1min) (Atom (sync ada) stop) (Atom (NOT sync ada) stop) }"}
        with stranger(router) as session, robots(place, plans) as running:
            frame = captured(session, "ada")
            time.sleep(0.5)
            until(lambda: " <- sync ada" in running["bob"].report, "a state of ada")
            running["ada"].kill()
            killed = time.monotonic()
            while "plan over" not in running["bob"].report:
                session.put("mdle/ada/state", frame)
                time.sleep(0.01)
            print(f"stale {time.monotonic() - killed:.2f} s after the last new state, with old ones")
            assert running["bob"].end() == 0 and "plan over: NOT sync ada" in running["bob"].report
            assert "warning" not in running["bob"].report, running["bob"].report


def test_a_robot_with_another_key_and_a_second_of_one_name():
    place = folder("keys")
    with Router() as router:
        link(place, router, "ada", ["bob", "eve"])
        link(place, router, "bob", ["ada", "eve"])
        link(place, router, "eve", ["ada", "bob"], key="another word")
        twice = place / "twice"
        twice.mkdir()
        link(twice, router, "bob", ["ada", "eve"])
        plan = "{ P (wait 4) (Atom (sync eve) stop) }"
        deaf = "{ P (wait 4) (Atom (sync ada) stop) }"
        with robots(place, {"ada": plan, "bob": plan, "eve": deaf}) as running, robots(twice, {"bob": plan}) as second:
            reports = {}
            for name, robot in [*running.items(), ("bob again", second["bob"])]:
                assert robot.end() == 0
                reports[name] = robot.report
                assert "plan over: wait 4" in robot.report, robot.report
        assert reports["ada"].count("a sender under mdle/eve/state is refused: it has another key") == 1, reports["ada"]
        assert reports["eve"].count("a sender under mdle/ada/state is refused: it has another key") == 1, reports["eve"]
        twins = "a sender under mdle/bob/state is refused: another run of `bob` has sent states within 2 s"
        assert reports["ada"].count(twins) == 1, reports["ada"]


GO = "{ Go (wait 1s) (Atom (null) (go 10 0)) }"


def sent(router, of_ada, of_bob):
    """Lets `ada` send a plan to `bob`, with these keys; returns the reports of both, and the exit status of `ada`."""
    place = folder("plans")
    link(place, router, "ada", ["bob"], plans=of_ada)
    link(place, router, "bob", ["ada"], plans=of_bob)
    (place / "stand.mdle").write_text("{ Stand (wait 6s) (Atom (null) stop) }\n")
    (place / "go.mdle").write_text(GO + "\n")
    (place / "commands.txt").write_text("load_plan go.mdle\nwait 2500ms\ncall /link/bob/send_plan Go now\nwait\n")
    bob = Robot(place, "run stand.mdle --target sim --world room --link bob.toml --log bob.mcap")
    ada = Robot(place, "shell stand.mdle --target sim --world room --link ada.toml -x -c commands.txt")
    status = ada.end(), bob.end()
    replayed = Robot(place, "replay bob.mcap")
    assert replayed.end() == 0 and replayed.report.startswith("the same to the bit, "), replayed.report
    return ada.report, bob.report, status


def test_a_plan_needs_the_key_of_the_two():
    key = "a word of two"
    with Router() as router:
        ada, bob, status = sent(router, {"bob": key}, {"ada": key})
        assert "bob takes the plan: Go takes over" in ada and status == (0, 0), ada
        assert "plan over: wait 1s (plan of ada:1)" in bob, bob
        for of_bob, words in [
            ({"ada": "another word"}, "a letter of ada is refused: it has another key `plans`"),
            ({}, "a letter of ada is refused: no plans are exchanged with ada"),
        ]:
            ada, bob, _ = sent(router, {"bob": key}, of_bob)
            assert words in bob and "plan over: wait 6s (stand.mdle:1)" in bob, ada + bob
        ada, bob, status = sent(router, {}, {"ada": key})
        assert status == (1, 0) and "plan over: wait 6s" in bob, ada + bob


def test_a_plan_that_is_sent_again_counts_once():
    place = folder("plan_again")
    key = "a word of two"
    with Router() as router:
        link(place, router, "ada", ["bob"], plans={"bob": key})
        link(place, router, "bob", ["ada"], plans={"ada": key})
        (place / "stand.mdle").write_text("{ Stand (wait 7s) (Atom (null) stop) }\n")
        (place / "go.mdle").write_text("{ Go (wait 3s) (Atom (null) (go 10 0)) }\n")
        (place / "commands.txt").write_text("load_plan go.mdle\nwait 2500ms\ncall /link/bob/send_plan Go now\nwait\n")
        with stranger(router) as session:
            letters = []
            session.declare_subscriber("mdle/ada/letters/bob", lambda sample: letters.append(sample.payload.to_bytes()))
            bob = Robot(place, "run stand.mdle --target sim --world room --link bob.toml")
            ada = Robot(place, "shell stand.mdle --target sim --world room --link ada.toml -x -c commands.txt")
            until(lambda: letters and "main set to Go" in bob.report, "the plan")
            session.put("mdle/ada/letters/bob", letters[0])
            assert (ada.end(), bob.end()) == (0, 0)
            assert bob.report.count("main set to Go") == 1, bob.report
