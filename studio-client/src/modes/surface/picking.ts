// Picking vertices: an outline, a stroke or a distance along the surface goes to the server, which knows the mesh.

import { Vector3 } from "three";
import type { Studio } from "../../studio";
import type { Numbers } from "../../transport/frame";
import { Latest } from "../../transport/latest";
import { Outline } from "../../view/outline";
import type { Pointer } from "../mode";
import type { Merge } from "./region";
import type { Picker, SurfaceToolbar } from "./tools";

const SLOP = 3; // pixels that a click may wander
const CLICKED = 0.06; // of the diagonal: the geodesic radius of a click

/** Where picked vertices go. */
export interface Picked {
  /** Picking begins: what is picked from now on changes this. */
  begin: (how: Merge) => void;
  /** These, in place of what this pick has found before. */
  show: (indices: Iterable<number>) => void;
  /** These too. */
  more: (indices: Iterable<number>) => void;
  end: () => void;
  /** It is given up: all is as it was before it began. */
  drop: () => void;
}

export class Picking {
  private readonly outline: Outline;
  private active: { tool: Picker; from: Pointer; places: number[]; how: Merge } | null = null;
  private round = 0; // answers to picks that were given up are of an earlier one
  private sent = 0; // places of the stroke that have been asked for
  private readonly strokes = new Latest<null>(() => this.stroke());
  private distances: Float32Array | null = null;
  private center: Vector3 | null = null;
  private radius = 0;

  constructor(
    private readonly studio: Studio,
    private readonly tools: SurfaceToolbar,
    private readonly picked: Picked,
  ) {
    this.outline = new Outline(studio.viewport);
  }

  dispose(): void {
    this.outline.dispose();
  }

  /** True where a pick begins. */
  down(pointer: Pointer): boolean {
    const tool = this.tools.picker;
    if (!tool) return false;
    const how = pointer.alt ? "remove" : pointer.shift || tool === "brush" ? "add" : "only";
    if (tool === "geodesic" && !this.measure(pointer)) return false;
    if (tool === "brush" && !this.hit(pointer)) return false;
    this.active = { tool, from: pointer, places: [pointer.x, pointer.y], how };
    this.sent = 0;
    if (tool === "brush" || tool === "geodesic") this.picked.begin(how);
    if (tool === "brush") this.strokes.push(null);
    return true;
  }

  move(pointer: Pointer): void {
    const { active } = this;
    if (!active) return;
    if (active.tool === "rectangle") active.places = corners(active.from, pointer);
    else active.places.push(pointer.x, pointer.y);
    if (active.tool === "brush") {
      this.ring(pointer);
      this.strokes.push(null);
    } else if (active.tool === "geodesic") this.reach(pointer, active.from);
    else this.outline.polygon(active.places);
  }

  up(pointer: Pointer): void {
    const { active } = this;
    if (!active) return;
    this.active = null;
    if (active.tool === "brush") void this.finishStroke(active.places);
    else if (active.tool === "geodesic") this.finishReach();
    else {
      this.outline.clear();
      const far = Math.hypot(pointer.x - active.from.x, pointer.y - active.from.y) > SLOP || active.places.length > 12;
      if (far) void this.within(active.places, active.how);
    }
  }

  hover(pointer: Pointer): void {
    if (this.tools.picker === "brush") this.ring(pointer);
    else this.outline.clear();
  }

  cancel(): boolean {
    const { active } = this;
    if (!active) return false;
    this.active = this.distances = null;
    this.round++;
    this.outline.clear();
    if (active.tool === "brush" || active.tool === "geodesic") this.picked.drop();
    return true;
  }

  private ring(pointer: Pointer): void {
    this.outline.circle(pointer.x, pointer.y, this.tools.now.brush);
  }

  private hit(pointer: Pointer): Vector3 | null {
    return this.studio.viewport.ray(pointer.x, pointer.y).intersectObject(this.studio.mesh.target, false)[0]?.point ?? null;
  }

  private async within(places: number[], how: Merge): Promise<void> {
    const outline = onScreen(this.studio, places);
    const found = await this.ask("surface.within", { visible: this.tools.now.visible }, { outline });
    if (!found) return;
    this.picked.begin(how);
    this.picked.show(found);
    this.picked.end();
  }

  /** What the stroke has passed since it was asked for last. */
  private async stroke(places = this.active?.places): Promise<void> {
    if (!places || this.sent >= places.length) return;
    const path = onScreen(this.studio, places.slice(Math.max(this.sent - 2, 0)));
    this.sent = places.length;
    const { width, height } = this.studio.viewport.size;
    const { brush, visible } = this.tools.now;
    const { round } = this;
    const found = await this.ask("surface.brush", { visible, wide: (2 * brush) / width, high: (2 * brush) / height }, { path });
    if (found && round === this.round) this.picked.more(found);
  }

  private async finishStroke(places: number[]): Promise<void> {
    await this.strokes.idle();
    await this.stroke(places);
    this.picked.end();
  }

  /** Ask how far everything is from the vertex under the pointer; false where there is none. */
  private measure(pointer: Pointer): boolean {
    const { mesh, viewport } = this.studio;
    const hit = viewport.ray(pointer.x, pointer.y).intersectObject(mesh.target, false)[0];
    if (!hit?.face) return false;
    const at = (vertex: number): Vector3 => new Vector3().fromArray(mesh.positions, 3 * vertex);
    const { a, b, c } = hit.face;
    const nearest = [a, b, c].reduce((best, each) => (at(each).distanceTo(hit.point) < at(best).distanceTo(hit.point) ? each : best));
    const start = mesh.pointOf(nearest);
    this.center = at(nearest);
    this.distances = null;
    this.radius = CLICKED * (this.studio.scene?.mesh?.diagonal ?? 1);
    const round = ++this.round;
    void this.studio.ask("surface.distances", {}, { index: Uint32Array.of(start) }).then((answer) => {
      if (round !== this.round) return;
      this.distances = (answer?.arrays["distances"] as Float32Array | undefined) ?? null;
      this.showReach();
      if (!this.active) this.finishReach();
    });
    return true;
  }

  private reach(pointer: Pointer, from: Pointer): void {
    const pixels = Math.hypot(pointer.x - from.x, pointer.y - from.y);
    if (pixels > SLOP) this.radius = pixels * this.studio.viewport.pixel(this.center!);
    this.outline.circle(from.x, from.y, pixels);
    this.showReach();
  }

  private showReach(): void {
    const { distances, radius } = this;
    if (!distances) return;
    const found: number[] = [];
    for (let i = 0; i < distances.length; i++) if (distances[i]! <= radius) found.push(i);
    this.picked.show(found);
  }

  private finishReach(): void {
    this.outline.clear();
    if (!this.distances) return; // its answer ends it
    this.distances = null;
    this.picked.end();
  }

  private async ask(command: string, values: Record<string, unknown>, arrays: Record<string, Numbers>): Promise<Uint32Array | null> {
    const answer = await this.studio.ask(command, values, { ...arrays, camera: this.studio.viewport.seeing });
    return (answer?.arrays["index"] as Uint32Array | undefined) ?? null;
  }
}

const corners = (from: Pointer, to: Pointer): number[] => [from.x, from.y, to.x, from.y, to.x, to.y, from.x, to.y];

/** Pixels as screen coordinates: from -1 to 1, upwards. */
function onScreen(studio: Studio, places: readonly number[]): Float64Array {
  const { width, height } = studio.viewport.size;
  return Float64Array.from(places, (value, i) => (i % 2 ? 1 - (2 * value) / height : (2 * value) / width - 1));
}
