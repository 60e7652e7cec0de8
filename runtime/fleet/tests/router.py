"""The router of eclipse-zenoh at a port of this machine, until it is killed."""

import sys
import threading

import zenoh


def configuration(mode, **endpoints):
    """The configuration of a session that looks for no other by itself."""
    config = zenoh.Config()
    config.insert_json5("mode", f'"{mode}"')
    config.insert_json5("scouting/multicast/enabled", "false")
    for key, endpoint in endpoints.items():
        config.insert_json5(f"{key}/endpoints", f'["{endpoint}"]')
    return config


if __name__ == "__main__":
    session = zenoh.open(configuration("router", listen=f"tcp/127.0.0.1:{sys.argv[1]}"))
    print("ready", flush=True)
    threading.Event().wait()
