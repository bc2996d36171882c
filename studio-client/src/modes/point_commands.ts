// What is asked of the server for the control points that are selected.

import type { Studio } from "../studio";
import type { ControlPoints } from "./control_points";

/** Put the one that was chosen last somewhere. */
export async function placeLast(studio: Studio, points: ControlPoints | null, position: Float64Array): Promise<void> {
  if (!points || points.last === null) return;
  await studio.ask("points.set", { layer: points.layer }, { index: Uint32Array.of(points.last), positions: position });
}

/** Back to where they rest: the selected ones, or all. */
export async function resetPoints(studio: Studio, points: ControlPoints | null, all: boolean): Promise<void> {
  if (!points || (!all && !points.selected.size)) return;
  await studio.ask("points.reset", { layer: points.layer }, all ? {} : { index: Uint32Array.from(points.selected) });
}

/** Nobody may move the selected ones, or everybody may. */
export async function lockPoints(studio: Studio, points: ControlPoints | null, locked: boolean): Promise<void> {
  if (points) await studio.ask("points.lock", { layer: points.layer, locked }, { index: Uint32Array.from(points.selected) });
}
