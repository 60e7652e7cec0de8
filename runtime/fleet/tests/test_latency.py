"""What `runtime/fleet/tests/run --latency` measures: states that arrive, over TCP and by a router."""

import random

from harness import WORK, Router
from latency import measured

EXAMPLE = WORK.parent / "release/examples/latency"


def test_states_arrive_over_tcp():
    assert measured(EXAMPLE, "tcp", random.randrange(20_000, 30_000), robots=3, seconds=1).endswith(" of 2 robots")


def test_states_arrive_by_a_router():
    with Router() as router:
        assert measured(EXAMPLE, "router", router.port, robots=3, seconds=1).endswith(" of 2 robots")
