// A second shape beside the one that is edited: translucent, never picked.

import { Box3, BufferAttribute, BufferGeometry, Mesh, MeshPhongMaterial, Points, PointsMaterial, type Color } from "three";
import type { Frame } from "../transport/frame";
import type { Viewport } from "./viewport";

export class GhostMesh {
  private readonly surface = new Mesh(
    new BufferGeometry(),
    new MeshPhongMaterial({ transparent: true, opacity: 0.38, depthWrite: false, shininess: 12 }),
  );
  private readonly dots = new Points(new BufferGeometry(), new PointsMaterial({ size: 2.5, sizeAttenuation: false }));

  constructor(private readonly viewport: Viewport) {
    this.surface.frustumCulled = this.dots.frustumCulled = false;
    this.surface.visible = this.dots.visible = false;
    this.surface.renderOrder = 2;
    viewport.shape.add(this.surface, this.dots);
  }

  get visible(): boolean {
    return this.surface.visible || this.dots.visible;
  }

  /** Around what is shown; null where nothing is. */
  get box(): Box3 | null {
    const shown = [this.surface, this.dots].find((each) => each.visible);
    return shown ? new Box3().setFromObject(shown) : null;
  }

  /** Show the mesh of an answer: its positions, normals and triangles; bare points where it has none. */
  show({ arrays }: Frame, color: Color): void {
    const triangles = arrays["triangles"] as Uint32Array;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(arrays["positions"] as Float32Array, 3));
    if (triangles.length) {
      geometry.setAttribute("normal", new BufferAttribute(arrays["normals"] as Int8Array, 3, true));
      geometry.setIndex(new BufferAttribute(triangles, 1));
    }
    const [shown, other] = triangles.length ? [this.surface, this.dots] : [this.dots, this.surface];
    shown.geometry.dispose();
    shown.geometry = geometry;
    shown.visible = true;
    other.visible = false;
    this.setColor(color);
  }

  hide(): void {
    this.surface.visible = this.dots.visible = false;
    this.viewport.request();
  }

  setColor(color: Color): void {
    this.surface.material.color.copy(color);
    this.dots.material.color.copy(color);
    this.viewport.request();
  }

  dispose(): void {
    this.viewport.shape.remove(this.surface, this.dots);
    for (const each of [this.surface, this.dots]) each.geometry.dispose();
    this.viewport.request();
  }
}
