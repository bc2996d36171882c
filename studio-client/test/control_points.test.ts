import { Matrix4, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { ControlPoints, PointMotion, falloff, type Shape } from "../src/modes/control_points";

/** A lattice of unit spacing. */
function lattice(shape: Shape): ControlPoints {
  const rest: number[] = [];
  for (let i = 0; i < shape[0]; i++)
    for (let j = 0; j < shape[1]; j++) for (let k = 0; k < shape[2]; k++) rest.push(i, j, k);
  return new ControlPoints("Lattice", shape, {
    head: {},
    arrays: {
      rest: Float64Array.from(rest),
      points: Float64Array.from(rest),
      links: new Uint32Array(),
      axes: Float64Array.from(new Matrix4().elements.filter((_, i) => i % 4 < 3 && i < 12)),
      locked: new Uint32Array(),
    },
  });
}

describe("indices of a lattice", () => {
  const points = lattice([2, 3, 4]);

  test("a place has its index, and back", () => {
    for (let index = 0; index < points.count; index++) expect(points.index(points.place(index)!)).toBe(index);
    expect(points.at(points.index([1, 2, 3])).toArray()).toEqual([1, 2, 3]);
  });

  test("a layer shares an index", () => {
    expect(points.layerOf(points.index([1, 0, 2]), 2)).toHaveLength(6);
    expect(points.layerOf(0, 0).every((index) => points.place(index)![0] === 0)).toBe(true);
  });

  test("mirroring twice is nothing", () => {
    for (const axis of [0, 1, 2] as const)
      for (let index = 0; index < points.count; index++)
        expect(points.mirrored(points.mirrored(index, axis)!, axis)).toBe(index);
  });
});

describe("a motion", () => {
  test("moves what is selected, and nothing that is locked", () => {
    const points = lattice([2, 2, 2]);
    points.choose([0, 7], "only");
    points.locked.add(7);
    const motion = new PointMotion(points, null, null);
    motion.translate(new Vector3(1, 2, 3));
    expect([...motion.indices]).toEqual([0]);
    expect(points.at(0).toArray()).toEqual([1, 2, 3]);
    expect(points.displacement(7).length()).toBe(0);
    motion.undo();
    expect(points.displacement(0).length()).toBe(0);
  });

  test("reflects in the mirror, and keeps the middle in its plane", () => {
    const points = lattice([3, 1, 1]);
    points.choose([0, 1], "only");
    new PointMotion(points, null, 0).translate(new Vector3(0.5, 1, 0));
    expect(points.displacement(2).toArray()).toEqual([-0.5, 1, 0]);
    expect(points.displacement(1).toArray()).toEqual([0, 1, 0]);
  });

  test("fades with distance under soft selection", () => {
    const points = lattice([5, 1, 1]);
    points.choose([0], "only");
    new PointMotion(points, 3, null).translate(new Vector3(0, 1, 0));
    const lifted = [0, 1, 2, 3, 4].map((index) => points.displacement(index).y);
    expect(lifted[0]).toBe(1);
    expect(lifted[1]).toBeCloseTo(falloff(1 / 3), 12);
    expect(lifted[3]).toBe(0);
    expect(lifted).toEqual([...lifted].sort((a, b) => b - a));
  });

  test("a turn about a pivot keeps distances", () => {
    const points = lattice([2, 2, 1]);
    points.choose([0, 1, 2, 3], "only");
    const turn = new Matrix4().makeRotationZ(0.7);
    new PointMotion(points, null, null).transform(turn);
    expect(points.at(0).distanceTo(points.at(3))).toBeCloseTo(Math.SQRT2, 12);
  });
});
