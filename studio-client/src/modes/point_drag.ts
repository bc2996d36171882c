// Control points in hand, by the gizmo or by the pointer: what moves goes to the server as often as it answers.

import type { Vector3 } from "three";
import type { Studio } from "../studio";
import type { Numbers } from "../transport/frame";
import { PointMotion, type ControlPoints } from "./control_points";
import { Grip } from "./grip";
import { LayerDrag } from "./layer_drag";
import type { Pointer } from "./mode";
import type { PointTools } from "./points_tools";

export class PointDrag {
  private motion: PointMotion | null = null;
  private drag: LayerDrag | null = null;
  private grip: Grip | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly tools: PointTools,
    /** The control points are elsewhere. */
    private readonly moved: () => void,
  ) {}

  /** Whether something moves. */
  get moving(): boolean {
    return this.motion !== null;
  }

  /** Whether the server has not answered the end of it yet. */
  get lasts(): boolean {
    return this.drag !== null;
  }

  /** How strongly a control point follows. */
  weight(index: number): number {
    return this.motion?.weight(index) ?? 0;
  }

  /** The pointer is down on a control point: it may become a drag. */
  take(at: Vector3, pointer: Pointer): void {
    this.grip = new Grip(this.studio.viewport, at, pointer);
  }

  /** Whether the pointer has gone so far that what it holds shall move. */
  pulls(pointer: Pointer): boolean {
    return this.grip !== null && (this.moving || this.grip.dragged(pointer));
  }

  pull(pointer: Pointer): void {
    const { tools } = this;
    const by = this.grip?.moved(pointer, tools.along, tools.diagonal);
    if (by) this.step((motion) => motion.translate(tools.restrained(by)));
  }

  letGo(): void {
    this.grip = null;
  }

  begin(points: ControlPoints): void {
    this.motion = new PointMotion(points, this.tools.softRadius, this.tools.now.mirror);
    this.drag = new LayerDrag(this.studio, "drag", { layer: points.layer }, (arrays) => this.answered(arrays));
  }

  step(apply: (motion: PointMotion) => void): void {
    const { motion } = this;
    if (!motion) return;
    apply(motion);
    this.moved();
    this.drag?.move({ smooth: this.tools.smooth }, { index: motion.indices, positions: motion.positions });
  }

  /** When the last step has been answered. */
  async answers(): Promise<void> {
    await this.drag?.answered();
  }

  /** Keep it; whether there was anything to keep. */
  async finish(): Promise<boolean> {
    const { drag } = this;
    this.motion = null;
    if (!drag) return false;
    await drag.commit();
    this.drag = null;
    return true;
  }

  /** Give it up. */
  cancel(): void {
    this.motion?.undo();
    this.motion = this.grip = null;
    void this.drag?.cancel();
    this.drag = null;
  }

  /** Where joints are kept smooth, the server takes others along. */
  private answered(arrays: Record<string, Numbers>): void {
    if (!arrays["controls"] || !this.motion) return;
    this.motion.takeAlong(arrays["controls"]);
    this.moved();
  }
}
