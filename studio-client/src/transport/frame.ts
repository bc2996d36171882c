// A frame: u32 length | JSON | arrays, each at a multiple of eight bytes. The same on both sides and both ways.

export type Numbers =
  | Float32Array
  | Float64Array
  | Uint32Array
  | Int32Array
  | Uint16Array
  | Int8Array
  | Uint8Array;

const TYPES = {
  f4: Float32Array,
  f8: Float64Array,
  u4: Uint32Array,
  i4: Int32Array,
  u2: Uint16Array,
  i1: Int8Array,
  u1: Uint8Array,
} as const;

type Code = keyof typeof TYPES;

export interface Frame {
  head: Record<string, unknown>;
  arrays: Record<string, Numbers>;
}

interface Listed {
  name: string;
  type: Code;
  length: number;
}

const aligned = (at: number): number => (at + 7) & ~7;

export function encode({ head, arrays }: Frame): Uint8Array<ArrayBuffer> {
  const listed: Listed[] = Object.entries(arrays).map(([name, array]) => ({
    name,
    type: codeOf(array),
    length: array.length,
  }));
  const json = new TextEncoder().encode(JSON.stringify({ ...head, arrays: listed }));
  let size = aligned(4 + json.length);
  const places = listed.map((_, i) => {
    const at = size;
    size = aligned(size + Object.values(arrays)[i]!.byteLength);
    return at;
  });
  const bytes = new Uint8Array(size);
  new DataView(bytes.buffer).setUint32(0, json.length, true);
  bytes.set(json, 4);
  Object.values(arrays).forEach((array, i) => {
    bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), places[i]!);
  });
  return bytes;
}

export function decode(data: ArrayBuffer): Frame {
  const length = new DataView(data).getUint32(0, true);
  if (4 + length > data.byteLength) throw new Error("a frame is shorter than it says");
  const { arrays: listed, ...head } = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length))) as {
    arrays?: Listed[];
  };
  const arrays: Record<string, Numbers> = {};
  let at = aligned(4 + length);
  for (const { name, type, length: count } of listed ?? []) {
    const array = new TYPES[type](data, at, count);
    arrays[name] = array;
    at = aligned(at + array.byteLength);
  }
  return { head, arrays };
}

function codeOf(array: Numbers): Code {
  const found = Object.entries(TYPES).find(([, type]) => array instanceof type);
  if (!found) throw new Error("no such array travels");
  return found[0] as Code;
}
