// What the pointer holds: it stays under the pointer, in the plane of the view or along an axis.

import { Plane, Vector3 } from "three";
import type { Viewport } from "../view/viewport";
import type { Pointer } from "./mode";

const SLOP = 3; // pixels that a click may wander

export class Grip {
  private readonly plane: Plane;

  constructor(
    private readonly viewport: Viewport,
    private readonly at: Vector3,
    private readonly from: Pointer,
  ) {
    this.plane = new Plane().setFromNormalAndCoplanarPoint(viewport.cameras.direction(), at);
  }

  /** Whether the pointer has gone farther than a click wanders. */
  dragged(pointer: Pointer): boolean {
    return Math.hypot(pointer.x - this.from.x, pointer.y - this.from.y) >= SLOP;
  }

  /** How far the pointer has moved what it holds; null where it points beside the plane. */
  moved(pointer: Pointer, axis: Vector3 | null, reach: number): Vector3 | null {
    const [from, to] = [this.under(this.from, axis, reach), this.under(pointer, axis, reach)];
    return from && to && to.sub(from);
  }

  private under(pointer: Pointer, axis: Vector3 | null, reach: number): Vector3 | null {
    const { ray } = this.viewport.ray(pointer.x, pointer.y);
    if (axis === null) return ray.intersectPlane(this.plane, new Vector3());
    const along = axis.clone().multiplyScalar(1e6 * reach);
    const nearest = new Vector3();
    ray.distanceSqToSegment(this.at.clone().sub(along), this.at.clone().add(along), undefined, nearest);
    return nearest;
  }
}
