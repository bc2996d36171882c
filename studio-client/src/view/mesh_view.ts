// The mesh: its buffers, updated in place, and the ways to paint it.

import {
  BufferAttribute,
  BufferGeometry,
  Box3,
  DynamicDrawUsage,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  Points,
  PointsMaterial,
  Sphere,
  Vector3,
  type Material,
} from "three";
import type { Numbers } from "../transport/frame";
import { ColorMap } from "./color_map";
import { MaterialSet, type MaterialFacts } from "./materials";
import type { Palette } from "./colors";
import { markBytes } from "./marks";
import type { Settings } from "../core/settings";

export interface DrawnMesh {
  /** Points of the mesh; those that seams split further are appended as twins of these. */
  count: number;
  positions: Float32Array;
  normals: Int8Array;
  triangles: Uint32Array;
  twins: Uint32Array;
  uvs: Float32Array | null;
  parts: { material: number; start: number; count: number }[];
  materials: MaterialFacts[];
}

/** Where positions lie: each is so many steps from the low corner. */
export interface Bounds {
  low: readonly number[];
  high: readonly number[];
  steps: number;
}

const PLAIN: Bounds = { low: [0, 0, 0], high: [1, 1, 1], steps: 1 };

/** The box of positions that were sent as 16 bits a coordinate. */
export const boundsOf = (head: Record<string, unknown>): Bounds => ({
  low: head["low"] as number[],
  high: head["high"] as number[],
  steps: 65535,
});

export class MeshView {
  readonly object = new Group();
  readonly colorMap = new ColorMap();
  readonly materials: MaterialSet;
  private geometry = new BufferGeometry();
  private restGeometry: BufferGeometry | null = null;
  private surface = new Mesh<BufferGeometry, Material | Material[]>();
  private readonly wires = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({ transparent: true, opacity: 0.42, depthWrite: false }),
  );
  private readonly dots = new Points(new BufferGeometry(), new PointsMaterial({ size: 3, sizeAttenuation: false }));
  private twins = new Uint32Array();
  private count = 0;
  private colored = false;
  private parts: DrawnMesh["parts"] = [];

  /** A view of a mesh; with `twin`, of the same mesh in the same materials, with points of its own. */
  constructor(
    private readonly redraw: () => void,
    twin?: MeshView,
  ) {
    this.materials = twin?.materials ?? new MaterialSet();
    this.wires.renderOrder = 1;
    this.object.add(this.surface, this.wires, this.dots);
    this.wires.visible = this.dots.visible = false;
    if (twin) this.copy(twin);
    else this.materials.onChange = redraw;
  }

  /** (n, 3) positions as they are drawn; the first `count` are the mesh's points. */
  get positions(): Float32Array {
    return this.position.array as Float32Array;
  }

  get pointCount(): number {
    return this.count;
  }

  /** The mesh's point that a drawn vertex stands for. */
  pointOf(vertex: number): number {
    return vertex < this.count ? vertex : this.twins[vertex - this.count]!;
  }

  /** The normal at a point, as it is drawn. */
  normalAt(point: number): Vector3 {
    return new Vector3().fromArray(this.normal.array as Int8Array, 4 * point).normalize();
  }

  get target(): Mesh {
    return this.surface;
  }

  get hasEdges(): boolean {
    return this.wires.geometry.index !== null;
  }

  get box(): Box3 {
    return this.count ? new Box3().setFromBufferAttribute(this.position) : new Box3();
  }

  load(mesh: DrawnMesh): void {
    this.clear();
    this.count = mesh.count;
    this.twins = mesh.twins as Uint32Array<ArrayBuffer>;
    this.parts = mesh.parts;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", dynamic(this.spread(mesh.positions, 3, Float32Array), 3));
    geometry.setAttribute("normal", dynamic(this.spread(mesh.normals, 4, Int8Array), 4, true));
    if (mesh.uvs) geometry.setAttribute("uv", new BufferAttribute(mesh.uvs, 2));
    geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
    mesh.parts.forEach((part) => geometry.addGroup(part.start, part.count, part.material));
    this.geometry = geometry;
    this.surface.geometry = geometry;
    this.surface.frustumCulled = false;
    this.materials.load(mesh.materials, mesh.uvs !== null);
    this.dots.geometry.setAttribute("position", this.position);
    this.dots.visible = mesh.triangles.length === 0;
    this.dots.frustumCulled = false;
    this.paint();
  }

  private copy(twin: MeshView): void {
    this.count = twin.count;
    this.twins = twin.twins;
    this.parts = twin.parts;
    this.geometry = twin.geometry.clone();
    this.geometry.deleteAttribute("scalar");
    this.geometry.deleteAttribute("mark");
    this.surface.geometry = this.geometry;
    this.surface.frustumCulled = this.dots.frustumCulled = false;
    this.dots.geometry.setAttribute("position", this.position);
    this.dots.visible = twin.dots.visible;
    this.paint();
  }

  clear(): void {
    this.geometry.dispose();
    this.restGeometry?.dispose();
    this.restGeometry = null;
    this.wires.geometry.dispose();
    this.wires.geometry = new BufferGeometry();
    this.surface.geometry = this.geometry = new BufferGeometry();
    this.dots.visible = false;
    this.count = 0;
    this.colored = false;
  }

  /** Edges of the polygons, drawn from the same positions. */
  setEdges(edges: Uint32Array): void {
    this.wires.geometry.setAttribute("position", this.position);
    this.wires.geometry.setIndex(new BufferAttribute(edges, 1));
    this.wires.frustumCulled = false;
  }

  /** The shape before the deformation, for comparisons. */
  setRest(positions: Float32Array, normals: Int8Array): void {
    const rest = this.geometry.clone();
    rest.setAttribute("position", new BufferAttribute(this.spread(positions, 3, Float32Array), 3));
    rest.setAttribute("normal", new BufferAttribute(this.spread(normals, 4, Int8Array), 4, true));
    rest.deleteAttribute("scalar");
    rest.deleteAttribute("mark");
    this.restGeometry = rest;
  }

  get hasRest(): boolean {
    return this.restGeometry !== null;
  }

  showSide(side: "before" | "after"): void {
    const before = side === "before" && this.restGeometry !== null;
    this.surface.geometry = before ? this.restGeometry! : this.geometry;
    this.wires.userData["hidden"] = before;
    this.surface.material = this.painting(before);
  }

  /** Move some points, or all: positions and normals of `index`, in place; as parts of a box where they are 16 bits. */
  move(index: Numbers | null, positions: ArrayLike<number>, normals: ArrayLike<number>, box: Bounds = PLAIN): void {
    const to = this.positions;
    const bend = this.normal.array as Int8Array;
    const count = index ? index.length : this.count;
    const [x, y, z] = box.low as [number, number, number];
    const [dx, dy, dz] = box.low.map((low, k) => (box.high[k]! - low) / box.steps) as [number, number, number];
    let low = this.count;
    let high = -1;
    for (let i = 0; i < count; i++) {
      const at = index ? index[i]! : i;
      to[3 * at] = x + dx * positions[3 * i]!;
      to[3 * at + 1] = y + dy * positions[3 * i + 1]!;
      to[3 * at + 2] = z + dz * positions[3 * i + 2]!;
      bend[4 * at] = normals[3 * i]!;
      bend[4 * at + 1] = normals[3 * i + 1]!;
      bend[4 * at + 2] = normals[3 * i + 2]!;
      if (at < low) low = at;
      if (at > high) high = at;
    }
    if (high < low) return;
    this.follow();
    this.upload(low, high);
    this.redraw();
  }

  setScalars(values: Float32Array | null): void {
    this.colored = values !== null;
    if (values) {
      const existing = this.geometry.getAttribute("scalar") as BufferAttribute | undefined;
      const spread = this.spread(values, 1, Float32Array);
      if (existing) {
        existing.array.set(spread);
        existing.needsUpdate = true;
      } else this.geometry.setAttribute("scalar", dynamic(spread, 1));
    }
    this.paint();
    this.redraw();
  }

  /** Mark points as parts of a region and of its handle, (n,) bits of both; null = none. */
  setMarks(marks: Uint8Array | null): void {
    if (marks === null) this.geometry.deleteAttribute("mark");
    else {
      const existing = this.geometry.getAttribute("mark") as BufferAttribute | undefined;
      const spread = this.spread(markBytes(marks), 4, Uint8Array);
      if (existing) {
        existing.array.set(spread);
        existing.needsUpdate = true;
      } else this.geometry.setAttribute("mark", dynamic(spread, 4, true));
    }
    this.redraw();
  }

  apply(settings: Settings, palette: Palette): void {
    this.materials.apply(settings, palette);
    this.colorMap.setFlat(settings.shading === "flat");
    this.wires.visible = settings.wireframe && this.hasEdges;
    this.wires.material.color.copy(palette.wire);
    this.dots.material.color.copy(palette.handle);
    this.paint();
    this.redraw();
  }

  private paint(): void {
    this.surface.material = this.painting(false);
  }

  private painting(before: boolean): Material | Material[] {
    if (this.colored && !before) return this.colorMap.material;
    return this.parts.length ? this.materials.list : this.materials.list[0]!;
  }

  private get position(): BufferAttribute {
    return this.geometry.getAttribute("position") as BufferAttribute;
  }

  private get normal(): BufferAttribute {
    return this.geometry.getAttribute("normal") as BufferAttribute;
  }

  /** Values of points, with those of twins appended. */
  private spread<T extends Float32Array | Int8Array | Uint8Array>(
    values: ArrayLike<number>,
    size: number,
    type: new (length: number) => T,
  ): T {
    const given = values.length / this.count === size ? size : Math.round(values.length / this.count);
    const out = new type((this.count + this.twins.length) * size);
    for (let i = 0; i < this.count + this.twins.length; i++) {
      const from = i < this.count ? i : this.twins[i - this.count]!;
      for (let k = 0; k < given; k++) out[size * i + k] = values[given * from + k]!;
    }
    return out;
  }

  private follow(): void {
    const to = this.positions;
    const bend = this.normal.array as Int8Array;
    for (let i = 0, at = this.count; i < this.twins.length; i++, at++) {
      const from = this.twins[i]!;
      for (let k = 0; k < 3; k++) {
        to[3 * at + k] = to[3 * from + k]!;
        bend[4 * at + k] = bend[4 * from + k]!;
      }
    }
  }

  private upload(low: number, high: number): void {
    for (const attribute of [this.position, this.normal]) {
      const size = attribute.itemSize;
      attribute.addUpdateRange(low * size, (high - low + 1) * size);
      if (this.twins.length) attribute.addUpdateRange(this.count * size, this.twins.length * size);
      attribute.needsUpdate = true;
    }
    const middle = this.geometry.boundingSphere?.center; // what is drawn is sorted by it; rays look at every triangle
    this.geometry.boundingSphere = new Sphere(middle, Infinity);
    this.geometry.boundingBox = null;
  }
}

function dynamic(array: Float32Array | Int8Array | Uint8Array, size: number, normalized = false): BufferAttribute {
  const attribute = new BufferAttribute(array, size, normalized);
  attribute.setUsage(DynamicDrawUsage);
  return attribute;
}
