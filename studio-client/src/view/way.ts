// The way of a tool over the object: a line, with a dot at each key.

import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, type Color } from "three";
import { Handles } from "./handles";
import type { Viewport } from "./viewport";

export class Way {
  private readonly line = new Line(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.9, depthTest: false }));
  private readonly keys: Handles;

  constructor(private readonly viewport: Viewport) {
    this.keys = new Handles(viewport);
    this.line.frustumCulled = false;
    this.line.renderOrder = 3;
    viewport.helpers.add(this.line);
  }

  show(along: Float64Array, keys: Float64Array, color: Color): void {
    this.line.geometry.dispose();
    this.line.geometry = new BufferGeometry();
    this.line.geometry.setAttribute("position", new BufferAttribute(new Float32Array(along), 3));
    this.line.visible = along.length > 3;
    this.line.material.color.copy(color);
    this.keys.load(keys, new Uint32Array());
    this.keys.setColors(() => color, () => 0.8, color);
    this.viewport.request();
  }

  dispose(): void {
    this.viewport.helpers.remove(this.line);
    this.line.geometry.dispose();
    this.keys.dispose();
  }
}
