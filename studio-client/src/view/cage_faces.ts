// The faces of a cage: hardly there, and the selected ones well.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Group, Mesh, MeshBasicMaterial } from "three";
import type { Viewport } from "./viewport";

/** A polygon mesh's faces: corners one after another, and where each face begins, with the end. */
export interface Faces {
  corners: Uint32Array;
  offsets: Uint32Array;
}

export class CageFaces {
  readonly object = new Group();
  private readonly all = plain(0.07);
  private readonly chosen = plain(0.42);
  private faces: Faces = { corners: new Uint32Array(), offsets: new Uint32Array([0]) };

  constructor(private readonly viewport: Viewport) {
    this.all.renderOrder = 1;
    this.chosen.renderOrder = 2;
    this.object.add(this.all, this.chosen);
    viewport.helpers.add(this.object);
  }

  load(faces: Faces, positions: Float64Array): void {
    this.faces = faces;
    const at = new BufferAttribute(new Float32Array(positions), 3);
    at.setUsage(DynamicDrawUsage);
    for (const each of [this.all, this.chosen]) each.geometry.setAttribute("position", at);
    this.all.geometry.setIndex(new BufferAttribute(this.triangles(this.every), 1));
    this.chosen.geometry.setIndex(new BufferAttribute(new Uint32Array(), 1));
  }

  move(positions: Float64Array): void {
    const at = this.all.geometry.getAttribute("position") as BufferAttribute | undefined;
    if (!at || at.array.length !== positions.length) return;
    (at.array as Float32Array).set(positions);
    at.needsUpdate = true;
    this.all.geometry.boundingSphere = this.all.geometry.boundingBox = null;
  }

  /** Mark the faces all of whose corners are selected. */
  mark(selected: ReadonlySet<number>): void {
    const marked = this.every.filter((face) => this.cornersOf(face).every((corner) => selected.has(corner)));
    this.chosen.geometry.setIndex(new BufferAttribute(this.triangles(marked), 1));
  }

  setColors(all: Color, chosen: Color): void {
    this.all.material.color.copy(all);
    this.chosen.material.color.copy(chosen);
  }

  /** The corners of the face under a pixel, of those that look at the eye the nearest. */
  pick(x: number, y: number): number[] | null {
    const hit = this.viewport.ray(x, y).intersectObject(this.all, false)[0];
    if (hit?.faceIndex === undefined || hit.faceIndex === null) return null;
    let left = hit.faceIndex;
    const face = this.every.find((each) => (left -= this.cornersOf(each).length - 2) < 0);
    return face === undefined ? null : this.cornersOf(face);
  }

  dispose(): void {
    this.viewport.helpers.remove(this.object);
    for (const each of [this.all, this.chosen]) {
      each.geometry.dispose();
      each.material.dispose();
    }
  }

  private get every(): number[] {
    return [...Array(Math.max(this.faces.offsets.length - 1, 0)).keys()];
  }

  private cornersOf(face: number): number[] {
    return [...this.faces.corners.subarray(this.faces.offsets[face]!, this.faces.offsets[face + 1]!)];
  }

  /** Fans of triangles. */
  private triangles(faces: number[]): Uint32Array {
    const found: number[] = [];
    for (const face of faces) {
      const corners = this.cornersOf(face);
      for (let i = 1; i + 1 < corners.length; i++) found.push(corners[0]!, corners[i]!, corners[i + 1]!);
    }
    return Uint32Array.from(found);
  }
}

function plain(opacity: number): Mesh<BufferGeometry, MeshBasicMaterial> {
  const material = new MeshBasicMaterial({ transparent: true, opacity, side: DoubleSide, depthWrite: false });
  const mesh = new Mesh(new BufferGeometry(), material);
  mesh.frustumCulled = false;
  return mesh;
}
