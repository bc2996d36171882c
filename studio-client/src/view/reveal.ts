// Stepping back where something new would lie outside of the canvas, or behind the bar above it.

import { Box3, Vector3 } from "three";
import type { Studio } from "../studio";

const EDGE = 12; // pixels of the canvas that it keeps clear of
const BAR = 58; // and above, where the tools are

/** Show the shape and (3 n) places around it, from where one looks now. */
export function reveal(studio: Studio, places: ArrayLike<number>): void {
  const { viewport } = studio;
  const { width, height } = viewport.size;
  const box = new Box3().setFromArray(Float64Array.from(places));
  let hidden = false;
  for (let i = 0; i < places.length; i += 3) {
    const { x, y } = viewport.project(new Vector3().fromArray(places, i));
    hidden ||= x < EDGE || y < BAR || x > width - EDGE || y > height - EDGE;
  }
  if (!hidden) return;
  box.union(studio.mesh.box);
  studio.frame(box.expandByScalar(0.07 * box.getSize(new Vector3()).length()));
}
