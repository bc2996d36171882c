// Picking on the skeleton: the tools that pick vertices of the mesh pick its points, and the vertices around them.

import { Outline } from "../../view/outline";
import type { Viewport } from "../../view/viewport";
import type { Pointer } from "../mode";
import type { Picked } from "./picking";
import type { SkeletonShow } from "./skeleton_show";
import type { SurfaceToolbar } from "./tools";

type Place = { x: number; y: number };

export class NodePicking {
  private active: { viewport: Viewport; outline: Outline; from: Pointer; places: Place[]; node: number | null } | null = null;

  constructor(
    private readonly show: SkeletonShow,
    private readonly tools: SurfaceToolbar,
    private readonly picked: Picked,
  ) {}

  /** True where a pick begins: at a point of the skeleton, or wherever an outline or a stroke is drawn. */
  down(pointer: Pointer, onlyNodes: boolean): boolean {
    const { viewport } = this.show;
    if (!viewport || !this.show.shown) return false;
    const node = this.show.pick(pointer.x, pointer.y);
    const { picker } = this.tools;
    if (node === null && (onlyNodes || picker === null || picker === "geodesic")) return false;
    this.active = { viewport, outline: new Outline(viewport), from: pointer, places: [pointer], node };
    this.picked.begin(pointer.alt ? "remove" : pointer.shift || picker === "brush" ? "add" : "only");
    this.update(pointer);
    return true;
  }

  move(pointer: Pointer): boolean {
    if (!this.active) return false;
    this.active.places.push(pointer);
    this.update(pointer);
    return true;
  }

  up(): boolean {
    if (!this.active) return false;
    this.active.outline.dispose();
    this.active = null;
    this.picked.end();
    return true;
  }

  /** Give a pick up; false where there is none. */
  cancel(): boolean {
    if (!this.active) return false;
    this.active.outline.dispose();
    this.active = null;
    this.picked.drop();
    return true;
  }

  private update(pointer: Pointer): void {
    const nodes = this.found(pointer);
    if (nodes) this.picked.show(this.show.vertices(nodes));
  }

  private found(pointer: Pointer): number[] | null {
    const { from, places, outline, node, viewport } = this.active!;
    const seen = this.show.seen();
    const where = (test: (place: Place) => boolean): number[] => [...seen.keys()].filter((i) => test(seen[i]!));
    const moved = Math.hypot(pointer.x - from.x, pointer.y - from.y);
    const { picker } = this.tools;
    if (node !== null && (moved < 4 || picker === null)) return [node];
    if (picker === "geodesic" && node !== null) {
      outline.circle(from.x, from.y, moved);
      return this.show.around(node, moved * viewport.pixel(viewport.cameras.target));
    }
    if (picker === "brush") {
      outline.circle(pointer.x, pointer.y, this.tools.now.brush);
      return where((at) => places.some((place) => Math.hypot(at.x - place.x, at.y - place.y) <= this.tools.now.brush));
    }
    if (moved < 4) return null;
    const polygon = picker === "lasso" ? places : rectangle(from, pointer);
    outline.polygon(polygon.flatMap(({ x, y }) => [x, y]));
    return where((at) => inside(at, polygon));
  }
}

const rectangle = (from: Place, to: Place): Place[] => [from, { x: to.x, y: from.y }, to, { x: from.x, y: to.y }];

/** Whether a polygon winds around a place an odd number of times. */
function inside({ x, y }: Place, polygon: readonly Place[]): boolean {
  let odd = false;
  polygon.forEach((from, i) => {
    const to = polygon[(i + 1) % polygon.length]!;
    if (from.y > y !== to.y > y && x < from.x + ((y - from.y) * (to.x - from.x)) / (to.y - from.y)) odd = !odd;
  });
  return odd;
}
