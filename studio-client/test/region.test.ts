import { expect, test } from "vitest";
import { Region } from "../src/modes/surface/region";

test("a handle is a part of its region, whatever is picked", () => {
  const region = new Region(8);
  region.take("handle", [2, 3], "only");
  expect([...region.indices("region")]).toEqual([2, 3]);
  region.take("region", [3, 4, 5], "add");
  expect([...region.indices("region")]).toEqual([2, 3, 4, 5]);
  region.take("region", [3, 4, 7], "only");
  expect([...region.indices("handle")]).toEqual([3]);
  region.take("handle", [3], "remove");
  expect([...region.indices("region")]).toEqual([3, 4, 7]);
  expect(region.count("handle")).toBe(0);
  region.take("handle", [4], "add");
  region.take("region", [4], "remove");
  expect(region.count("handle")).toBe(0);
  expect(region.count("region")).toBe(2);
});
