import { Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { pickEdge } from "../src/modes/cage/edge_picking";
import { ControlPoints } from "../src/modes/control_points";
import { segmentsOf } from "../src/view/ghost_lines";
import type { Viewport } from "../src/view/viewport";

/** A view along z in which a unit is ten pixels. */
const view = { project: ({ x, y, z }: Vector3) => ({ x: 10 * x, y: 10 * y, depth: z }) } as unknown as Viewport;

function points(rest: number[], extra: { links?: number[]; places?: number[] } = {}): ControlPoints {
  const arrays = {
    rest: Float64Array.from(rest),
    points: Float64Array.from(rest),
    links: Uint32Array.from(extra.links ?? []),
    axes: Float64Array.from([1, 0, 0, 0, 1, 0, 0, 0, 1]),
    locked: new Uint32Array(),
    ...(extra.places ? { places: Int32Array.from(extra.places) } : {}),
  };
  return new ControlPoints("Layer", null, { head: {}, arrays }, new Vector3(1, 0, 0));
}

describe("edges of a cage", () => {
  const square = points([0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0], { links: [0, 1, 1, 2, 2, 3, 3, 0] });

  test("the one under the pointer is taken, its nearer end first", () => {
    expect(pickEdge(view, square, 30, 4)).toEqual([0, 1]);
    expect(pickEdge(view, square, 97, 80)).toEqual([2, 1]);
    expect(pickEdge(view, square, 50, 50)).toBeNull();
  });

  test("of two that lie over one another, the one in front", () => {
    const pair = points([0, 0, 0.5, 10, 0, 0.5, 0, 0, -0.5, 10, 0, -0.5], { links: [0, 1, 2, 3] });
    expect(pickEdge(view, pair, 40, 0)).toEqual([2, 3]);
  });
});

describe("control points without a box", () => {
  test("a twin is where the mirror image is, or there is none", () => {
    const sites = points([0, 0, 0, 2.01, 0, 0, 5, 3, 0, 1, 4, 0]);
    expect(sites.mirrored(0, 0)).toBe(1);
    expect(sites.mirrored(1, 0)).toBe(0);
    expect(sites.mirrored(2, 0)).toBeNull();
    expect(sites.mirrored(3, 0)).toBe(3);
  });

  test("rings, spokes and layers of a round lattice leave out points that stand at several places", () => {
    const places = [-1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0, 0, 2, 1];
    const round = points(Array(18).fill(0) as number[], { places });
    expect(round.round && round.arranged).toBe(true);
    expect(round.rowOf(1, 0)).toEqual([1, 2]);
    expect(round.rowOf(3, 1)).toEqual([1, 3]);
    expect(round.rowOf(0, 0)).toEqual([0]);
    expect(round.layerOf(3, 2)).toEqual([0, 1, 2, 3, 4]);
    expect(round.layers(1)).toBe(3);
  });
});

test("polylines are cut into pairs of neighbours", () => {
  expect([...segmentsOf([0, 3, 5])]).toEqual([0, 1, 1, 2, 3, 4]);
  expect([...segmentsOf([0])]).toEqual([]);
});
