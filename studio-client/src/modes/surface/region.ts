// The region of interest and the handle in it: what is picked. The handle is a part of the region, always.

import { IN_HANDLE, IN_REGION } from "../../view/marks";

export type Part = "region" | "handle";
export type Merge = "only" | "add" | "remove";

export class Region {
  marks: Uint8Array;
  /** How often it has changed. */
  version = 0;

  constructor(count: number) {
    this.marks = new Uint8Array(count);
  }

  static of(count: number, region: Iterable<number>, handle: Iterable<number>): Region {
    const made = new Region(count);
    made.take("region", region, "add");
    made.take("handle", handle, "add");
    return made;
  }

  /** The vertices of a part, ascending. */
  indices(part: Part): Uint32Array {
    const bit = part === "region" ? IN_REGION : IN_HANDLE;
    const found: number[] = [];
    this.marks.forEach((mark, i) => {
      if (mark & bit) found.push(i);
    });
    return Uint32Array.from(found);
  }

  count(part: Part): number {
    const bit = part === "region" ? IN_REGION : IN_HANDLE;
    return this.marks.reduce((sum, mark) => sum + (mark & bit ? 1 : 0), 0);
  }

  /** Take vertices into a part, or out of it; what leaves the region leaves the handle, and a handle brings its region. */
  take(part: Part, indices: Iterable<number>, how: Merge): void {
    const { marks } = this;
    this.version++;
    if (how === "only") this.clear(part);
    if (how === "remove") {
      const kept = part === "region" ? 0 : IN_REGION;
      for (const i of indices) marks[i]! &= kept;
      return;
    }
    const bits = part === "region" ? IN_REGION : IN_REGION | IN_HANDLE;
    for (const i of indices) marks[i]! |= bits;
    if (how === "only" && part === "region") this.keepHandleInside();
  }

  restore(marks: Uint8Array): void {
    this.version++;
    this.marks.set(marks);
  }

  clear(part: Part): void {
    const lost = part === "region" ? IN_REGION : IN_HANDLE;
    this.version++;
    for (let i = 0; i < this.marks.length; i++) this.marks[i]! &= ~lost;
  }

  private keepHandleInside(): void {
    for (let i = 0; i < this.marks.length; i++) if (!(this.marks[i]! & IN_REGION)) this.marks[i] = 0;
  }
}
