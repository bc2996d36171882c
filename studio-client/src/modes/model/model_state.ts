// A shape model as the client knows it: its coefficients, its landmarks, and how much each field says.

import { Vector3 } from "three";
import type { Frame } from "../../transport/frame";

export class ModelState {
  readonly rank: number;
  readonly count: number;
  readonly noise: number;
  /** Whether each field serves all three coordinates: three coefficients a field. */
  readonly scalar: boolean;
  readonly coefficients: Float64Array;
  readonly vertices: Uint32Array;
  readonly positions: Float64Array;
  readonly variances: Float64Array;

  constructor(
    readonly layer: string,
    { head, arrays }: Frame,
  ) {
    this.rank = head["rank"] as number;
    this.count = head["count"] as number;
    this.noise = head["noise"] as number;
    this.scalar = head["scalar"] as boolean;
    this.coefficients = arrays["coefficients"] as Float64Array;
    this.vertices = arrays["vertices"] as Uint32Array;
    this.positions = arrays["positions"] as Float64Array;
    this.variances = arrays["variances"] as Float64Array;
  }

  get landmarks(): number {
    return this.vertices.length;
  }

  landmark(index: number): Vector3 {
    return new Vector3().fromArray(this.positions, 3 * index);
  }

  /** What a coefficient is called: its field, counted from one, and the coordinate that it moves. */
  label(index: number): string {
    return this.scalar ? `${Math.floor(index / 3) + 1} ${"xyz"[index % 3]}` : String(index + 1);
  }

  /** The part of the variance that a coefficient's field has. */
  share(index: number): number {
    return this.variances[this.scalar ? Math.floor(index / 3) : index] ?? 0;
  }

  /** What the uncertainty depends on. */
  get knowledge(): string {
    return JSON.stringify([this.layer, this.count, this.noise, [...this.vertices]]);
  }
}
