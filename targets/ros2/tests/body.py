"""A round body that moves in a floor of walls, and what its sensors see of it."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy

RADIUS = 0.205
RAYS = 360
LEAST, MOST = 0.05, 12.0


@dataclass
class Place:
    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0


class Floor:
    """The walls of a world of the simulator, as segments."""

    def __init__(self, file: Path | None):
        world = tomllib.loads(file.read_text()) if file else {}
        start = world.get("start", {})
        self.start = Place(start.get("x", 0.0), start.get("y", 0.0), math.radians(start.get("heading", 0.0)))
        segments = [(*a, *b) for wall in world.get("wall", []) for a, b in zip(wall["points"], wall["points"][1:])]
        self.segments = numpy.array(segments, dtype=float).reshape(-1, 4)

    def distance(self, x, y):
        """The distance of a place from the nearest wall."""
        if not len(self.segments):
            return math.inf
        a, b = self.segments[:, :2], self.segments[:, 2:]
        way, here = b - a, numpy.array([x, y]) - a
        part = numpy.clip((here * way).sum(1) / (way * way).sum(1), 0.0, 1.0)
        return float(numpy.hypot(*(here - part[:, None] * way).T).min())

    def ranges(self, place, angles):
        """The range of each ray, infinite where it meets no wall."""
        if not len(self.segments):
            return numpy.full(len(angles), math.inf)
        directions = numpy.stack([numpy.cos(place.theta + angles), numpy.sin(place.theta + angles)], 1)
        a, way = self.segments[:, :2] - [place.x, place.y], self.segments[:, 2:] - self.segments[:, :2]
        cross = directions[:, None, 0] * way[None, :, 1] - directions[:, None, 1] * way[None, :, 0]
        with numpy.errstate(divide="ignore", invalid="ignore"):
            along = (a[None, :, 0] * way[None, :, 1] - a[None, :, 1] * way[None, :, 0]) / cross
            part = (a[None, :, 0] * directions[:, None, 1] - a[None, :, 1] * directions[:, None, 0]) / cross
        hits = numpy.where((along > 0) & (part >= 0) & (part <= 1), along, math.inf)
        return hits.min(1)


class Body:
    """The body, which moves as it was commanded last."""

    def __init__(self, floor: Floor):
        self.floor, self.place = floor, Place(**vars(floor.start))
        self.v = self.omega = 0.0
        self.bumps = False

    def move(self, seconds):
        """Moves along an arc, as far as no wall stops it."""
        steps = max(1, round(seconds / 0.01))
        self.bumps = False
        for _ in range(steps):
            turn, way = self.omega * seconds / steps, self.v * seconds / steps
            heading = self.place.theta + turn / 2
            x, y = self.place.x + way * math.cos(heading), self.place.y + way * math.sin(heading)
            self.place.theta += turn
            if self.floor.distance(x, y) < RADIUS:
                self.bumps = True
            else:
                self.place.x, self.place.y = x, y

    def angles(self, rays=RAYS):
        return -math.pi + 2 * math.pi * numpy.arange(rays) / rays

    def scan(self, rays=RAYS):
        """The ranges of a scanner in the middle, from the back counter-clockwise."""
        ranges = self.floor.ranges(self.place, self.angles(rays))
        return numpy.where((ranges > MOST) | (ranges < LEAST), math.inf, ranges)
