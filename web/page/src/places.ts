// Places of a floor: where outlines reach, and what is at a point.
import type { Floor, Goal, Outline, Point } from "./answers";

/** Returns the smallest and the largest coordinates of an outline. */
export function reach({ points }: Outline): [number, number, number, number] {
  let [left, bottom, right, top] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) [left, bottom, right, top] = [Math.min(left, x), Math.min(bottom, y), Math.max(right, x), Math.max(top, y)];
  return [left, bottom, right, top];
}

export function centre(outline: Outline): Point {
  const [left, bottom, right, top] = reach(outline);
  return [(left + right) / 2, (bottom + top) / 2];
}

/** Returns the name of what is at a point, or within `near` metres of it; empty if nothing with a name is. */
export function nameAt(floor: Floor, point: Point, near: number): string {
  if (floor.charger && Math.hypot(point[0] - floor.charger.at[0], point[1] - floor.charger.at[1]) <= floor.charger.reach) return "charger";
  const inside = floor.outlines.find((outline) => outline.solid && contains(outline, point));
  if (inside) return inside.name;
  const wall = floor.outlines.find(({ points }) => points.some((from, place) => distance(point, from, points[place + 1] ?? from) <= near));
  if (wall && wall.name !== "") return wall.name;
  return floor.goal && distanceTo(floor.goal, point) === 0 ? "goal" : "";
}

/** Returns the distance of a point from the area of a goal, in metres; 0 inside. */
export function distanceTo(goal: Goal, [x, y]: [number, number, ...number[]]): number {
  if ("radius" in goal) return Math.max(0, Math.hypot(x - goal.center[0], y - goal.center[1]) - goal.radius);
  const { min, max } = goal;
  return Math.hypot(Math.max(min[0] - x, 0, x - max[0]), Math.max(min[1] - y, 0, y - max[1]));
}

function contains({ points }: Outline, [x, y]: Point): boolean {
  let isInside = false;
  points.forEach(([x1, y1], place) => {
    const [x2, y2] = points[(place + 1) % points.length] ?? [x1, y1];
    if (y1 > y !== y2 > y && x < x1 + ((x2 - x1) * (y - y1)) / (y2 - y1)) isInside = !isInside;
  });
  return isInside;
}

/** Returns the distance between a point and a line between two others. */
function distance([x, y]: Point, [x1, y1]: Point, [x2, y2]: Point): number {
  const [dx, dy] = [x2 - x1, y2 - y1];
  const length = dx * dx + dy * dy;
  const along = length === 0 ? 0 : Math.min(1, Math.max(0, ((x - x1) * dx + (y - y1) * dy) / length));
  return Math.hypot(x - x1 - along * dx, y - y1 - along * dy);
}
