// The edge of a cage that is nearest to a pixel.

import { Vector3 } from "three";
import type { Viewport } from "../../view/viewport";
import type { ControlPoints } from "../control_points";

const REACH = 9; // pixels

/** The two ends of the edge under a pixel, the nearer end first; null where there is none. */
export function pickEdge(viewport: Viewport, points: ControlPoints, x: number, y: number): [number, number] | null {
  const seen = Array.from({ length: points.count }, (_, index) => viewport.project(points.at(index)));
  let best: [number, number] | null = null;
  let least = Infinity;
  for (let i = 0; i < points.links.length; i += 2) {
    const [a, b] = [points.links[i]!, points.links[i + 1]!];
    const [from, to] = [seen[a]!, seen[b]!];
    const { away, part } = distance(x, y, from, to);
    if (away > REACH) continue;
    const rank = away + 40 * (from.depth + part * (to.depth - from.depth));
    if (rank < least) [best, least] = [part < 0.5 ? [a, b] : [b, a], rank];
  }
  return best;
}

function distance(x: number, y: number, from: { x: number; y: number }, to: { x: number; y: number }): { away: number; part: number } {
  const along = new Vector3(to.x - from.x, to.y - from.y);
  const part = Math.min(Math.max(((x - from.x) * along.x + (y - from.y) * along.y) / (along.lengthSq() || 1), 0), 1);
  return { away: Math.hypot(from.x + part * along.x - x, from.y + part * along.y - y), part };
}
