// The gizmo of the selected control points: where it stands, and how it follows the tools.

import { Vector3, type Matrix4 } from "three";
import type { Studio } from "../studio";
import { Gizmo } from "../view/gizmo";
import type { ControlPoints } from "./control_points";
import type { PointTools } from "./points_tools";

export interface GizmoActions {
  begin: () => void;
  move: (matrix: Matrix4) => void;
  end: () => void;
}

export class PointGizmo {
  private readonly gizmo: Gizmo;

  constructor(
    private readonly studio: Studio,
    private readonly tools: PointTools,
    actions: GizmoActions,
  ) {
    this.gizmo = new Gizmo(studio.viewport);
    this.gizmo.onBegin = actions.begin;
    this.gizmo.onMove = actions.move;
    this.gizmo.onEnd = actions.end;
  }

  /** Whether it takes what is clicked. */
  get hot(): boolean {
    this.gizmo.useCamera();
    return this.gizmo.hot;
  }

  set enabled(enabled: boolean) {
    this.gizmo.enabled = enabled;
  }

  followTools(): void {
    const { tool, snap, axis } = this.tools.now;
    this.gizmo.setTool(tool);
    this.gizmo.setAxis(axis);
    this.gizmo.setSnap(snap ? this.tools.step : null);
  }

  place(points: ControlPoints | null): void {
    this.gizmo.useCamera();
    this.gizmo.place(this.pivot(points), this.tools.turn);
  }

  /** How far its rings are from its middle, in pixels. */
  radius(points: ControlPoints | null): number {
    const pivot = this.pivot(points);
    return pivot ? this.gizmo.radius(pivot) / this.studio.viewport.pixel(pivot) : 0;
  }

  cancel(): void {
    this.gizmo.cancel();
  }

  dispose(): void {
    this.gizmo.dispose();
  }

  private pivot(points: ControlPoints | null): Vector3 | null {
    if (!points?.selected.size) return null;
    if (this.tools.now.pivot === "origin") return new Vector3();
    return this.tools.now.pivot === "last" && points.last !== null ? points.at(points.last) : points.center;
  }
}
