import { expect, test } from "vitest";
import { markerColor, weightsAt } from "../src/modes/transfer/state";

test("poses play one after another, from rest to rest", () => {
  expect(weightsAt(0, 2)).toEqual([0, 0]);
  expect(weightsAt(1, 2)).toEqual([1, 0]);
  expect(weightsAt(2, 2)).toEqual([0, 1]);
  expect(weightsAt(3, 2)).toEqual([0, 0]); // and again
  const [one, two] = weightsAt(1.3, 2) as [number, number];
  expect(one + two).toBeCloseTo(1, 12);
  expect(weightsAt(2.5, 2)[1]).toBeCloseTo(0.5, 12);
  for (let at = 0; at < 6; at += 0.07) for (const weight of weightsAt(at, 3)) expect(weight).toBeGreaterThanOrEqual(0);
});

test("neighbours in the list of markers have other colours", () => {
  for (let i = 0; i < 30; i++) expect(markerColor(i).getHexString()).not.toBe(markerColor(i + 1).getHexString());
});
