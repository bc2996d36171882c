import { expect, test } from "vitest";
import { widened } from "../src/modes/layer_drag";
import { shortNumber } from "../src/panels/controls";
import { roundStep } from "../src/view/ground";

test("numbers are shown short and read back near", () => {
  for (const value of [0, 1, -0.375, 1234.5678, 1e-9, 6.02e23, 0.1 + 0.2]) {
    expect(Number(shortNumber(value))).toBeCloseTo(value, 5 - Math.ceil(Math.log10(Math.abs(value) + 1)));
  }
  expect(shortNumber(0.1 + 0.2)).toBe("0.3");
  expect(shortNumber(NaN)).toBe("–");
});

test("positions in sixteen bits come back to half a step", () => {
  const wide = widened(Uint16Array.of(0, 32768, 65535), [-1, 0, 5], [1, 10, 6]);
  expect([...wide]).toEqual([-1, expect.closeTo(5, 3), 6]);
});

test("steps are round and not longer than asked for", () => {
  for (const length of [0.0123, 0.7, 1, 3.3, 99, 1e6]) {
    const step = roundStep(length);
    expect(step).toBeLessThanOrEqual(length);
    expect(step * 2.5).toBeGreaterThanOrEqual(length);
    expect([1, 2, 5]).toContain(Math.round(step / 10 ** Math.floor(Math.log10(step * 1.0001))));
  }
});
