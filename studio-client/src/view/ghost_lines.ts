// Lines around a tool, before the deformation and after: the former faint, both seen through the shape a little.

import { BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments } from "three";
import type { Viewport } from "./viewport";

interface Look {
  opacity: number;
  behind: number;
}

export class GhostLines {
  private readonly object = new Group();
  private readonly before = pair({ opacity: 0.5, behind: 0.1 });
  private readonly after = pair({ opacity: 1, behind: 0.28 });

  constructor(private readonly viewport: Viewport) {
    this.object.add(...this.before, ...this.after);
    viewport.helpers.add(this.object);
  }

  /** Polylines: their points one after another, and where each begins, with the end. */
  show(before: Float32Array, after: Float32Array, offsets: ArrayLike<number>): void {
    const index = segmentsOf(offsets);
    for (const [[front, behind], points] of [[this.before, before], [this.after, after]] as const) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(points, 3));
      geometry.setIndex(new BufferAttribute(index, 1));
      front.geometry.dispose();
      front.geometry = behind.geometry = geometry;
    }
    this.object.visible = true;
    this.viewport.request();
  }

  hide(): void {
    this.object.visible = false;
    this.viewport.request();
  }

  setColors(before: Color, after: Color): void {
    for (const each of this.before) each.material.color.copy(before);
    for (const each of this.after) each.material.color.copy(after);
  }

  dispose(): void {
    this.viewport.helpers.remove(this.object);
    for (const each of [...this.before, ...this.after]) {
      each.geometry.dispose();
      each.material.dispose();
    }
    this.viewport.request();
  }
}

type Lines = LineSegments<BufferGeometry, LineBasicMaterial>;

/** The same lines twice: in front of the shape, and fainter behind it. */
function pair({ opacity, behind }: Look): [Lines, Lines] {
  const front = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity }));
  const hidden = new LineSegments(
    front.geometry,
    new LineBasicMaterial({ transparent: true, opacity: behind, depthTest: false, depthWrite: false }),
  );
  hidden.renderOrder = 2;
  front.frustumCulled = hidden.frustumCulled = false;
  return [front, hidden];
}

/** Pairs of neighbours along polylines. */
export function segmentsOf(offsets: ArrayLike<number>): Uint32Array {
  const found: number[] = [];
  for (let line = 0; line + 1 < offsets.length; line++) {
    for (let i = offsets[line]!; i + 1 < offsets[line + 1]!; i++) found.push(i, i + 1);
  }
  return Uint32Array.from(found);
}
