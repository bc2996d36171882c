// Ghosts of other moments: those before the playhead in one colour, those after it in another, the fainter the farther.

import { BufferAttribute, BufferGeometry, Group, Mesh, MeshPhongMaterial, type Color } from "three";
import type { MeshView } from "./mesh_view";

/** Where a ghost lies on the shape itself, the shape is seen. */
const BEHIND = { polygonOffset: true, polygonOffsetFactor: 3, polygonOffsetUnits: 24 };

export interface Ghost {
  positions: Float32Array;
  normals: Int8Array;
  color: Color;
  opacity: number;
}

export class Onion {
  readonly object = new Group();
  private triangles: { of: BufferAttribute; index: BufferAttribute } | null = null;

  constructor(private readonly mesh: MeshView) {}

  get count(): number {
    return this.object.children.length;
  }

  show(ghosts: Ghost[]): void {
    this.clear();
    const index = this.index();
    if (!index) return;
    ghosts.forEach((ghost, i) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(ghost.positions, 3));
      geometry.setAttribute("normal", new BufferAttribute(ghost.normals, 3, true));
      geometry.setIndex(index);
      const { color, opacity } = ghost;
      const material = new MeshPhongMaterial({ color, opacity, transparent: true, depthWrite: false, shininess: 8, ...BEHIND });
      const surface = new Mesh(geometry, material);
      surface.frustumCulled = false;
      surface.renderOrder = -1 - i; // farther moments first
      this.object.add(surface);
    });
  }

  clear(): void {
    for (const each of [...this.object.children] as Mesh<BufferGeometry, MeshPhongMaterial>[]) {
      this.object.remove(each);
      each.geometry.dispose();
      each.material.dispose();
    }
  }

  /** The mesh's triangles on its points: what seams split further is one again. */
  private index(): BufferAttribute | null {
    const of = this.mesh.target.geometry.index;
    if (!of) return null;
    if (this.triangles?.of !== of) {
      this.triangles = { of, index: new BufferAttribute(Uint32Array.from(of.array, (vertex) => this.mesh.pointOf(vertex)), 1) };
    }
    return this.triangles.index;
  }
}
