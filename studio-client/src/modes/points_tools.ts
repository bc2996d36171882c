// How control points are moved: tool, soft selection, mirror, snapping, pivot, the axis that a drag is locked to.

import { Quaternion, Vector3 } from "three";
import { Signal } from "../core/signal";
import type { Studio } from "../studio";
import type { Tool } from "../view/gizmo";
import { roundStep } from "../view/ground";

export type Axis = 0 | 1 | 2;
/** What a click takes: one control point, or all of a ring, a row, a layer; an edge or a face of a cage. */
export type Take = "point" | "ring" | "row" | "layer" | "edge" | "face";
export type Pivot = "center" | "origin" | "last";

export interface Tools {
  tool: Tool;
  rectangle: boolean;
  soft: boolean;
  /** As part of the shape's diagonal. */
  radius: number;
  mirror: Axis | null;
  snap: boolean;
  step: number;
  pivot: Pivot;
  axis: Axis | null;
  /** Along the axes of the lattice, not of the world. */
  local: boolean;
  /** Whether there are joints between patches, and others go along so that these stay smooth. */
  joints: boolean;
  smooth: boolean;
  take: Take;
  /** What there is to take. */
  takes: readonly Take[];
  /** What the axes of the lattice are called. */
  letters: readonly [string, string, string];
}

export class PointTools {
  readonly state = new Signal<Tools>({
    tool: "translate",
    rectangle: false,
    soft: false,
    radius: 0.2,
    mirror: null,
    snap: false,
    step: 0,
    pivot: "center",
    axis: null,
    local: false,
    joints: false,
    smooth: true,
    take: "point",
    takes: ["point"],
    letters: ["i", "j", "k"],
  });

  /** From the world's axes to those of the lattice; null where they are the same. */
  own: Quaternion | null = null;

  constructor(private readonly studio: Studio) {}

  get now(): Tools {
    return this.state.value;
  }

  change(part: Partial<Tools>): void {
    this.state.set({ ...this.now, ...part });
  }

  get diagonal(): number {
    return this.studio.scene?.mesh?.diagonal ?? 1;
  }

  get step(): number {
    return this.now.step || roundStep(this.diagonal / 50);
  }

  get softRadius(): number | null {
    return this.now.soft ? this.now.radius * this.diagonal : null;
  }

  /** Whether joints are kept smooth. */
  get smooth(): boolean {
    return this.now.joints && this.now.smooth;
  }

  /** How the axes in use are turned; null where they are the world's. */
  get turn(): Quaternion | null {
    return this.now.local ? this.own : null;
  }

  /** The direction that drags are locked to. */
  get along(): Vector3 | null {
    const { axis } = this.now;
    return axis === null ? null : new Vector3().setComponent(axis, 1).applyQuaternion(this.turn ?? new Quaternion());
  }

  /** A move as the lock and the snapping allow it. */
  restrained(move: Vector3): Vector3 {
    const { axis, snap } = this.now;
    const turn = this.turn ?? new Quaternion();
    const own = move.clone().applyQuaternion(turn.clone().invert());
    const kept = axis === null ? own : new Vector3().setComponent(axis, own.getComponent(axis));
    if (snap) kept.set(...(kept.toArray().map((value) => Math.round(value / this.step) * this.step) as [number, number, number]));
    return kept.applyQuaternion(turn);
  }

  /** What these control points let one take, what their axes are called, how these are turned; what has joints. */
  offer(takes: readonly Take[], boxed: boolean, own: Quaternion | null, joints: boolean): void {
    const turned = (own === null) !== (this.own === null);
    this.own = own;
    const letters = boxed ? (["i", "j", "k"] as const) : (["x", "y", "z"] as const);
    const same = String(takes) === String(this.now.takes) && letters[0] === this.now.letters[0];
    if (!turned && same && joints === this.now.joints) return;
    this.change({ takes, letters, joints, take: takes.includes(this.now.take) ? this.now.take : "point" });
  }
}
