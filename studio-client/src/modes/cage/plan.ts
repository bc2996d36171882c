// How the next cage shall be built: what the panel sets, and what the server is asked.

import { Signal } from "../../core/signal";
import type { Numbers } from "../../transport/frame";

export type Method = "offset" | "cuts" | "box";

export interface Plan {
  method: Method;
  vertices: number;
  /** In diagonals of the shape. */
  margin: number;
  symmetry: "" | "x" | "y" | "z";
  sides: number;
  coordinates: string;
  /** Planes: origins and normals. */
  cuts: number[][];
  /** Whether the next drag draws a plane. */
  drawing: boolean;
}

export class Plans {
  readonly state = new Signal<Plan>({
    method: "offset",
    vertices: 120,
    margin: 0.03,
    symmetry: "",
    sides: 6,
    coordinates: "mean_value",
    cuts: [],
    drawing: false,
  });

  get now(): Plan {
    return this.state.value;
  }

  change(part: Partial<Plan>): void {
    this.state.set({ ...this.now, ...part });
  }

  /** What the server is asked. */
  get asked(): [Record<string, unknown>, Record<string, Numbers>] {
    const { method, vertices, margin, symmetry, sides, coordinates, cuts } = this.now;
    return [{ method, vertices, margin, symmetry, sides, coordinates }, { cuts: Float64Array.from(cuts.flat()) }];
  }
}
