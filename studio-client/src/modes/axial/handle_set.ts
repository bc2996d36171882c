// The handles of a layer as the client knows them: names, units, places and what they say. What they mean, the server knows.

import { Box3, Vector3 } from "three";
import { shortNumber } from "../../panels/controls";
import type { Frame, Numbers } from "../../transport/frame";

export type Unit = "radians" | "factor" | "length" | "place" | "direction";

export interface HandleFacts {
  name: string;
  unit: Unit;
}

/** What can be dragged belongs to the deformation itself, or to where its axis stands. */
export type Role = "number" | "bound" | "origin" | "direction";

export class HandleSet {
  readonly facts: HandleFacts[];
  positions = new Float64Array();
  values = new Float64Array();

  constructor(
    readonly layer: string,
    answer: Frame,
  ) {
    this.facts = answer.head["handles"] as HandleFacts[];
    this.follow(answer.arrays);
  }

  follow(arrays: Record<string, Numbers>): void {
    this.positions = arrays["handles"] as Float64Array<ArrayBuffer>;
    this.values = arrays["values"] as Float64Array<ArrayBuffer>;
  }

  at(index: number): Vector3 {
    return new Vector3().fromArray(this.positions, 3 * index);
  }

  get box(): Box3 {
    return new Box3().setFromArray(this.positions);
  }

  index(name: string): number {
    return this.facts.findIndex((each) => each.name === name);
  }

  role(index: number): Role {
    const { name, unit } = this.facts[index]!;
    if (unit === "direction") return "direction";
    if (unit === "place") return "origin";
    return name === "low" || name === "high" ? "bound" : "number";
  }

  /** What a handle says: its name, and its number where it has one. */
  text(index: number, name: string): string {
    const { unit } = this.facts[index]!;
    if (unit === "place" || unit === "direction") return name;
    const value = this.values[index]!;
    return unit === "radians" ? `${name} ${shortNumber(Math.round((value * 1800) / Math.PI) / 10)}°` : `${name} ${Number(value.toPrecision(3))}`;
  }
}
