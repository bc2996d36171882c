// Control points of a layer as the client knows them: where they rest, where they are, which are chosen or locked.

import { Box3, Matrix4, Quaternion, Vector3 } from "three";
import type { Frame } from "../transport/frame";

export type Shape = [number, number, number];

const TWIN = 0.02; // of the extent: how far a twin may be from the mirror image

export class ControlPoints {
  readonly rest: Float64Array;
  readonly now: Float64Array;
  readonly links: Uint32Array;
  readonly axes: Vector3[];
  readonly selected = new Set<number>();
  locked: Set<number>;
  /** The one that was chosen last. */
  last: number | null = null;
  /** (m, 3) places around, outwards and along of a round lattice; -1 where a point stands at several. */
  private readonly places: Int32Array | null;

  /** Whether patches meet in it, whose joints can be kept smooth. */
  readonly joints: boolean;

  constructor(
    readonly layer: string,
    readonly shape: Shape | null,
    answer: Frame,
    /** Through which points without a lattice are mirrored. */
    private readonly middle = new Vector3(),
  ) {
    this.places = (answer.arrays["places"] as Int32Array | undefined) ?? null;
    this.joints = answer.head["joints"] === true;
    this.rest = answer.arrays["rest"] as Float64Array;
    this.now = answer.arrays["points"] as Float64Array;
    this.links = answer.arrays["links"] as Uint32Array;
    const axes = answer.arrays["axes"] as Float64Array;
    this.axes = [0, 1, 2].map((i) => new Vector3(axes[i]!, axes[3 + i]!, axes[6 + i]!));
    this.locked = new Set(answer.arrays["locked"]);
  }

  /** How the lattice's axes are turned against the world's; null where they are the same. */
  get turn(): Quaternion | null {
    const [x, y] = this.axes as [Vector3, Vector3, Vector3];
    const z = x.clone().cross(y).normalize();
    const turn = new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(x, z.clone().cross(x), z));
    return Math.abs(turn.w) > 1 - 1e-9 ? null : turn;
  }

  get count(): number {
    return this.rest.length / 3;
  }

  at(index: number): Vector3 {
    return new Vector3().fromArray(this.now, 3 * index);
  }

  displacement(index: number): Vector3 {
    return this.at(index).sub(new Vector3().fromArray(this.rest, 3 * index));
  }

  /** Whether the control points stand in a lattice: of a box, or around an axis. */
  get arranged(): boolean {
    return this.shape !== null || this.places !== null;
  }

  /** Whether the lattice goes around an axis. */
  get round(): boolean {
    return this.places !== null;
  }

  /** (i, j, k) of a control point of a lattice. */
  place(index: number): Shape | null {
    if (this.places) return [...this.places.subarray(3 * index, 3 * index + 3)] as Shape;
    if (!this.shape) return null;
    const [, y, z] = this.shape;
    return [Math.floor(index / (y * z)), Math.floor(index / z) % y, index % z];
  }

  index([i, j, k]: Shape): number {
    const [, y, z] = this.shape!;
    return (i * y + j) * z + k;
  }

  /** How many layers there are along an axis. */
  layers(axis: 0 | 1 | 2): number {
    if (this.shape) return this.shape[axis];
    return this.places ? 1 + this.places.reduce((most, value, i) => (i % 3 === axis ? Math.max(most, value) : most), 0) : 0;
  }

  /** A whole layer of the lattice: all that share the index along an axis. */
  layerOf(index: number, axis: 0 | 1 | 2): number[] {
    const place = this.place(index);
    if (!place || place[axis] < 0) return [index];
    return this.where((other) => other[axis] === place[axis]);
  }

  /** All that differ from a control point along one axis only: a ring where that goes around. */
  rowOf(index: number, axis: 0 | 1 | 2): number[] {
    const place = this.place(index);
    if (!place || place[axis] < 0) return [index];
    return this.where((other) => other.every((value, k) => k === axis || value === place[k]));
  }

  /** The control point on the other side of the lattice, or of the middle; null where there is none. */
  mirrored(index: number, axis: 0 | 1 | 2): number | null {
    if (!this.shape) return this.twin(index, axis);
    const other: Shape = [...this.place(index)!];
    other[axis] = this.shape[axis] - 1 - other[axis];
    return this.index(other);
  }

  choose(indices: Iterable<number>, how: "only" | "toggle" | "add"): void {
    const given = [...indices];
    if (how === "only") this.selected.clear();
    for (const index of given) {
      if (how === "toggle" && this.selected.has(index)) this.selected.delete(index);
      else {
        this.selected.add(index);
        this.last = index;
      }
    }
    if (this.last === null || !this.selected.has(this.last)) this.last = [...this.selected].at(-1) ?? null;
  }

  keepSelection(before: ControlPoints): void {
    if (before.layer !== this.layer || before.count !== this.count) return;
    for (const index of before.selected) this.selected.add(index);
    this.last = before.last;
  }

  get center(): Vector3 {
    const sum = new Vector3();
    for (const index of this.selected) sum.add(this.at(index));
    return sum.divideScalar(Math.max(this.selected.size, 1));
  }

  get box(): Box3 {
    const box = new Box3();
    for (const index of this.selected) box.expandByPoint(this.at(index));
    return box;
  }

  private twin(index: number, axis: 0 | 1 | 2): number | null {
    const goal = new Vector3().fromArray(this.rest, 3 * index);
    goal.setComponent(axis, 2 * this.middle.getComponent(axis) - goal.getComponent(axis));
    const extent = new Box3().setFromArray(this.rest).getSize(new Vector3()).length();
    let best: number | null = null;
    let least = TWIN * extent;
    const at = new Vector3();
    for (let i = 0; i < this.count; i++) {
      const away = at.fromArray(this.rest, 3 * i).distanceTo(goal);
      if (away < least) [best, least] = [i, away];
    }
    return best;
  }

  private where(wanted: (place: Shape) => boolean): number[] {
    return [...Array(this.count).keys()].filter((index) => wanted(this.place(index)!));
  }
}

/** How strongly a neighbour follows, by its distance as part of the radius: a smooth hill. */
export function falloff(part: number): number {
  if (part >= 1) return 0;
  const rest = 1 - part * part;
  return rest * rest;
}

/** A drag of control points: where they began, how strongly each follows, and who mirrors whom. */
export class PointMotion {
  readonly indices: Uint32Array;
  private readonly start: Float64Array;
  private readonly weights = new Map<number, number>();
  private readonly mirrors: [number, number][] = [];

  constructor(
    private readonly points: ControlPoints,
    softRadius: number | null,
    private readonly mirrorAxis: 0 | 1 | 2 | null,
  ) {
    this.start = points.now.slice();
    for (const index of points.selected) if (!points.locked.has(index)) this.weights.set(index, 1);
    if (softRadius) this.addSoft(softRadius);
    if (mirrorAxis !== null) this.addMirrors(mirrorAxis);
    this.indices = Uint32Array.from(new Set([...this.weights.keys(), ...this.mirrors.map(([, to]) => to)]));
  }

  weight(index: number): number {
    return this.weights.get(index) ?? 0;
  }

  translate(by: Vector3): void {
    this.each((start) => by.clone().add(start));
  }

  transform(matrix: Matrix4): void {
    this.each((start) => start.clone().applyMatrix4(matrix));
  }

  undo(): void {
    this.points.now.set(this.start);
  }

  /** Where all the others go with it: (n, 3). */
  takeAlong(controls: ArrayLike<number>): void {
    const own = new Set(this.indices);
    for (let i = 0; i < this.points.count; i++) {
      if (!own.has(i)) for (let k = 3 * i; k < 3 * i + 3; k++) this.points.now[k] = controls[k]!;
    }
  }

  /** (k, 3) where the moved ones are now. */
  get positions(): Float64Array {
    const out = new Float64Array(3 * this.indices.length);
    this.indices.forEach((index, i) => out.set(this.points.now.subarray(3 * index, 3 * index + 3), 3 * i));
    return out;
  }

  private each(image: (start: Vector3) => Vector3): void {
    const start = new Vector3();
    for (const [index, weight] of this.weights) {
      start.fromArray(this.start, 3 * index);
      image(start).sub(start).multiplyScalar(weight).add(start).toArray(this.points.now, 3 * index);
    }
    for (const [from, to] of this.mirrors) this.reflect(from, to);
  }

  private reflect(from: number, to: number): void {
    const axis = this.points.axes[this.mirrorAxis!]!;
    const moved = this.points.at(from).sub(new Vector3().fromArray(this.start, 3 * from));
    moved.addScaledVector(axis, (from === to ? -1 : -2) * moved.dot(axis));
    moved.add(new Vector3().fromArray(this.start, 3 * to)).toArray(this.points.now, 3 * to);
  }

  private addSoft(radius: number): void {
    const chosen = [...this.weights.keys()].map((index) => new Vector3().fromArray(this.points.rest, 3 * index));
    const at = new Vector3();
    for (let i = 0; i < this.points.count; i++) {
      if (this.weights.has(i) || this.points.locked.has(i)) continue;
      at.fromArray(this.points.rest, 3 * i);
      const nearest = chosen.reduce((least, each) => Math.min(least, each.distanceTo(at)), Infinity);
      const weight = falloff(nearest / radius);
      if (weight > 0) this.weights.set(i, weight);
    }
  }

  private addMirrors(axis: 0 | 1 | 2): void {
    for (const index of [...this.weights.keys()]) {
      const other = this.points.mirrored(index, axis);
      if (other !== null && (other === index || !this.weights.has(other)) && !this.points.locked.has(other)) this.mirrors.push([index, other]);
    }
  }
}
