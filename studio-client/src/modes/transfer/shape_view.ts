// One of the two shapes with its markers: spheres of the markers' colours, and their numbers.

import { Color, Vector3 } from "three";
import { Handles } from "../../view/handles";
import type { MeshView } from "../../view/mesh_view";
import { Tags } from "../../view/tags";
import type { Viewport } from "../../view/viewport";
import { markerColor } from "./state";

const NUMBERED = 20; // with more markers their numbers would hide the shape: only the one that is looked at has its own

export class ShapeView {
  private readonly handles: Handles;
  private readonly tags: Tags;
  private vertices: number[] = [];
  private pending: number | null = null;
  private lit: number | null = null;
  private facing = "";
  private readonly stop: () => void;

  constructor(
    readonly viewport: Viewport,
    readonly mesh: MeshView,
  ) {
    this.handles = new Handles(viewport);
    this.tags = new Tags(viewport);
    this.stop = viewport.drawn.onChange(() => this.paint(false));
  }

  /** The vertex nearest to a pixel; null where the shape is not. */
  pick(x: number, y: number): number | null {
    const hit = this.viewport.ray(x, y).intersectObject(this.mesh.target, false)[0];
    if (!hit?.face) return null;
    const { a, b, c } = hit.face;
    const away = (vertex: number): number => this.at(vertex).distanceTo(hit.point);
    return this.mesh.pointOf([a, b, c].reduce((best, each) => (away(each) < away(best) ? each : best)));
  }

  /** The marker at a pixel. */
  marker(x: number, y: number): number | null {
    const found = this.handles.pick(x, y);
    return found !== null && found < this.vertices.length ? found : null;
  }

  show(vertices: number[], pending: number | null, lit: number | null): void {
    this.vertices = vertices;
    this.pending = pending;
    this.lit = lit;
    this.handles.load(this.positions(this.all), new Uint32Array());
    this.paint(true);
    this.viewport.request();
  }

  /** The shape has moved, and its markers with it. */
  follow(): void {
    this.handles.replacePositions(this.positions(this.all));
    this.paint(true);
    this.viewport.request();
  }

  onPage(vertex: number): { x: number; y: number } {
    const box = this.viewport.canvas.getBoundingClientRect();
    const { x, y } = this.viewport.project(this.at(vertex));
    return { x: x + box.left, y: y + box.top };
  }

  dispose(): void {
    this.stop();
    this.handles.dispose();
    this.tags.dispose();
  }

  private get all(): number[] {
    return this.pending === null ? this.vertices : [...this.vertices, this.pending];
  }

  private at(vertex: number): Vector3 {
    return new Vector3().fromArray(this.mesh.positions, 3 * vertex);
  }

  private positions(vertices: number[]): Float64Array {
    return Float64Array.from(vertices.flatMap((vertex) => this.at(vertex).toArray()));
  }

  /** Markers that look away are small, and have no number. */
  private paint(always: boolean): void {
    const eye = this.viewport.cameras.direction();
    const all = this.all;
    const facing = all.map((vertex) => this.mesh.normalAt(vertex).dot(eye) < 0.15);
    if (!always && facing.join() === this.facing) return;
    this.facing = facing.join();
    const { vertices, lit } = this;
    const many = vertices.length > NUMBERED;
    const usual = many ? 0.75 : 1;
    this.handles.setColors(
      (i) => (i < vertices.length ? markerColor(i) : new Color("#ffffff")),
      (i) => (i === lit ? 1.7 : i >= vertices.length ? 1.35 : facing[i] ? usual : 0.5 * usual),
      new Color(),
    );
    const seen = [...vertices.keys()].filter((i) => (facing[i] && !many) || i === lit);
    this.tags.show(seen.map((i) => ({ at: this.at(vertices[i]!), text: String(i + 1), strong: i === lit })));
    this.viewport.request();
  }
}
