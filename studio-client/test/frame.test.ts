import { expect, test } from "vitest";
import { decode, encode } from "../src/transport/frame";

test("a frame comes back as it was, its arrays aligned", () => {
  const arrays = {
    a: Float64Array.of(1.5, -2, 3),
    b: Uint8Array.of(1, 2, 3),
    c: Uint32Array.of(7),
    d: new Float32Array(0),
    e: Int8Array.of(-1, 1),
  };
  const bytes = encode({ head: { id: 3, do: "x", with: { name: "形" } }, arrays });
  const found = decode(bytes.buffer);
  expect(found.head).toEqual({ id: 3, do: "x", with: { name: "形" } });
  expect(found.arrays).toEqual(arrays);
  for (const array of Object.values(found.arrays)) expect(array.byteOffset % 8).toBe(0);
});

test("a frame that is cut off is no frame", () => {
  const bytes = encode({ head: { event: "x" }, arrays: { a: Float64Array.of(1, 2, 3, 4) } });
  expect(() => decode(bytes.buffer.slice(0, bytes.length - 8))).toThrow();
  expect(() => decode(bytes.buffer.slice(0, 6))).toThrow();
});
