// The contour skeleton over the mesh or beside it: its points stand for the groups of vertices around them.

import { Vector3 } from "three";
import { t } from "../../core/strings";
import type { Studio } from "../../studio";
import type { Frame, Numbers } from "../../transport/frame";
import { Handles } from "../../view/handles";
import { IN_HANDLE, IN_REGION } from "../../view/marks";
import { SideView } from "../../view/side_view";
import type { Viewport } from "../../view/viewport";
import type { Taker } from "../input";

export type Where = "off" | "over" | "beside";

export interface SkeletonChoice {
  where: Where;
  contours: number;
  eigenvectors: number;
}

export class SkeletonShow {
  choice: SkeletonChoice = { where: "off", contours: 30, eigenvectors: 10 };
  points = new Float64Array();
  links = new Uint32Array();
  groups = new Int32Array();
  side: SideView | null = null;
  private handles: Handles | null = null;
  private marks: Uint8Array = new Uint8Array();

  constructor(
    private readonly studio: Studio,
    private readonly taker: Taker,
    private readonly moved: () => void,
  ) {}

  /** Where its points are drawn, and picked. */
  get viewport(): Viewport | null {
    return this.choice.where === "off" ? null : (this.side?.viewport ?? this.studio.viewport);
  }

  get shown(): boolean {
    return this.viewport !== null && this.points.length > 0;
  }

  async set(part: Partial<SkeletonChoice>): Promise<void> {
    const before = this.choice.where;
    this.choice = { ...this.choice, ...part };
    if (this.choice.where !== before) this.place();
    await this.load();
  }

  /** Fetch it as the shape is now; where it is not known yet, an event brings it. */
  async load(): Promise<void> {
    const { where, contours, eigenvectors } = this.choice;
    if (where === "off" || !this.studio.scene?.mesh?.faces) return;
    const answer = await this.studio.ask("surface.skeleton", { contours, eigenvectors });
    if (answer?.head["known"]) this.take(answer);
  }

  /** Let the server know it before it is needed: beside other work, and with progress. */
  prepare(): void {
    const { where, contours, eigenvectors } = this.choice;
    if (where === "off") void this.studio.ask("surface.skeleton", { contours, eigenvectors });
  }

  take({ arrays }: Frame): void {
    this.points = arrays["points"] as Float64Array<ArrayBuffer>;
    this.links = arrays["links"] as Uint32Array<ArrayBuffer>;
    this.groups = arrays["groups"] as Int32Array<ArrayBuffer>;
    this.draw();
  }

  /** The shape has moved, and the skeleton with it. */
  follow(points: Numbers): void {
    if (points.length !== this.points.length) return;
    this.points = points as Float64Array<ArrayBuffer>;
    this.handles?.replacePositions(this.points);
    this.viewport?.request();
  }

  /** The shape is another one: what is shown is no longer its skeleton. */
  forget(): void {
    this.points = new Float64Array();
    this.groups = new Int32Array();
    this.handles?.load(this.points, new Uint32Array());
  }

  /** Colour its points by what their vertices are in, mostly. */
  paint(marks: Uint8Array = this.marks): void {
    this.marks = marks;
    this.side?.setTitle(t("skeleton"));
    const count = this.points.length / 3;
    if (!this.handles || !count) return;
    const totals = new Uint32Array(count);
    const region = new Uint32Array(count);
    const handle = new Uint32Array(count);
    this.groups.forEach((group, vertex) => {
      if (group < 0) return;
      totals[group]!++;
      if (marks[vertex]! & IN_REGION) region[group]!++;
      if (marks[vertex]! & IN_HANDLE) handle[group]!++;
    });
    const { palette } = this.studio;
    const most = (part: Uint32Array, i: number): boolean => 2 * part[i]! > totals[i]!;
    this.handles.setColors(
      (i) => (most(handle, i) ? palette.selected : most(region, i) ? palette.region : palette.handle),
      (i) => (most(handle, i) ? 1.15 : 0.85),
      palette.lattice,
    );
    this.viewport?.request();
  }

  /** All vertices of some of its points. */
  vertices(nodes: Iterable<number>): number[] {
    const wanted = new Set(nodes);
    const found: number[] = [];
    this.groups.forEach((group, vertex) => {
      if (wanted.has(group)) found.push(vertex);
    });
    return found;
  }

  pick(x: number, y: number): number | null {
    return this.shown ? (this.handles?.pick(x, y) ?? null) : null;
  }

  /** Where its points are on the canvas. */
  seen(): { x: number; y: number }[] {
    const { viewport, points } = this;
    if (!viewport) return [];
    return Array.from({ length: points.length / 3 }, (_, i) => viewport.project(new Vector3().fromArray(points, 3 * i)));
  }

  /** Its points within a length of one, along its links. */
  around(start: number, radius: number): number[] {
    const away = new Map([[start, 0]]);
    const at = (i: number): Vector3 => new Vector3().fromArray(this.points, 3 * i);
    const open = [start];
    while (open.length) {
      const here = open.pop()!;
      for (let k = 0; k < this.links.length; k += 2) {
        const [a, b] = [this.links[k]!, this.links[k + 1]!];
        if (a !== here && b !== here) continue;
        const next = a === here ? b : a;
        const length = away.get(here)! + at(here).distanceTo(at(next));
        if (length <= radius && length < (away.get(next) ?? Infinity)) {
          away.set(next, length);
          open.push(next);
        }
      }
    }
    return [...away.keys()];
  }

  close(): void {
    this.handles?.dispose();
    this.handles = null;
    this.side?.close();
    this.side = null;
  }

  /** Draw it anew, after the mode was left. */
  place(): void {
    this.close();
    const { where } = this.choice;
    if (where === "beside") {
      this.side = new SideView(this.studio, t("skeleton"), this.taker);
      this.side.link();
    }
    if (where !== "off") this.handles = new Handles(this.viewport!);
    this.draw();
    this.moved();
  }

  private draw(): void {
    this.handles?.load(this.points, this.links);
    this.paint();
  }
}
