// What the server says of a transfer: the source with its poses, and the markers.

import { Color } from "three";

export interface TransferState {
  name: string | null;
  points: number;
  poses: string[];
  markers: [number, number][];
  ready: boolean;
  layer: string;
}

export const NOTHING: TransferState = { name: null, points: 0, poses: [], markers: [], ready: false, layer: "" };

/** The colour of a marker: neighbours in the list are far apart on the wheel. */
export const markerColor = (index: number): Color => new Color().setHSL((0.58 + index * 0.381966) % 1, 0.72, 0.55);

/** Poses one after another, from rest to rest: their weights at a moment, a second each. */
export function weightsAt(seconds: number, count: number): number[] {
  const weights = new Array<number>(count).fill(0);
  const steps = count + 1;
  const at = seconds % steps;
  const from = Math.floor(at);
  const part = at - from;
  const eased = part * part * (3 - 2 * part);
  if (from > 0) weights[from - 1] = 1 - eased;
  if (from < count) weights[from] = eased;
  return weights;
}
