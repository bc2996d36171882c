// Many small points on the surface, of the same size on the screen: shown, never picked.

import { BufferAttribute, BufferGeometry, Points, PointsMaterial, type Color } from "three";
import type { Viewport } from "./viewport";

const SIZE = 4.5; // pixels

export class Dots {
  private readonly points: Points<BufferGeometry, PointsMaterial>;

  constructor(private readonly viewport: Viewport) {
    const material = new PointsMaterial({ size: SIZE * Math.min(devicePixelRatio, 3), sizeAttenuation: false });
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <clipping_planes_fragment>",
        "#include <clipping_planes_fragment>\nif (length(gl_PointCoord - 0.5) > 0.5) discard;",
      );
    };
    this.points = new Points(new BufferGeometry(), material);
    this.points.frustumCulled = this.points.visible = false;
    viewport.helpers.add(this.points);
  }

  /** (n, 3) places; null = none. */
  show(places: Float32Array | null, color: Color): void {
    this.points.visible = places !== null;
    if (places) this.points.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.points.material.color.copy(color);
    this.viewport.request();
  }

  get visible(): boolean {
    return this.points.visible;
  }

  dispose(): void {
    this.viewport.helpers.remove(this.points);
    this.points.geometry.dispose();
    this.viewport.request();
  }
}
