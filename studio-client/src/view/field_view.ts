// The deformation of space: lines of a warped grid, arrows, and the place where it folds.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  ConeGeometry,
  CylinderGeometry,
  Group,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  SRGBColorSpace,
  Vector3,
} from "three";

const UP = new Vector3(0, 1, 0);
const HEAD = 0.3; // of an arrow's length

export class FieldView {
  readonly object = new Group();
  private readonly lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.75 }));
  private readonly preview = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({ color: 0xe0305a, transparent: true, opacity: 0.8, depthTest: false }),
  );
  private readonly arrows = new Group();
  private readonly mark = new Group();
  private readonly arrowMaterial = new MeshLambertMaterial({ color: 0xffffff });

  constructor() {
    this.lines.frustumCulled = false;
    this.lines.visible = this.mark.visible = false;
    this.preview.frustumCulled = this.preview.visible = false;
    this.preview.renderOrder = 3;
    this.object.add(this.lines, this.preview, this.arrows, this.mark);
    this.addMark();
  }

  setColor(color: Color): void {
    this.lines.material.color.copy(color);
  }

  /** Polylines: their points one after another, and where each begins. */
  setLines(points: Float32Array | null, offsets: Uint32Array): void {
    this.lines.visible = points !== null;
    if (!points) return;
    const segments = new Uint32Array(Math.max(2 * (points.length / 3 - (offsets.length - 1)), 0));
    let at = 0;
    for (let line = 0; line + 1 < offsets.length; line++) {
      for (let i = offsets[line]!; i + 1 < offsets[line + 1]!; i++) {
        segments[at++] = i;
        segments[at++] = i + 1;
      }
    }
    const geometry = this.lines.geometry;
    geometry.setAttribute("position", new BufferAttribute(points, 3));
    geometry.setIndex(new BufferAttribute(segments.subarray(0, at), 1));
  }

  /** Arrows from positions along vectors, (n, 3) each, coloured by their length from a table. */
  setArrows(positions: Float32Array | null, vectors: Float32Array, thickness: number, colors: ArrayLike<number>): void {
    this.clearArrows();
    if (!positions) return;
    const shown: number[] = [];
    let longest = 0;
    for (let i = 0; i < vectors.length / 3; i++) {
      const length = Math.hypot(vectors[3 * i]!, vectors[3 * i + 1]!, vectors[3 * i + 2]!);
      if (length > thickness * 0.5) shown.push(i);
      longest = Math.max(longest, length);
    }
    const shafts = new InstancedMesh(new CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0), this.arrowMaterial, shown.length);
    const heads = new InstancedMesh(new ConeGeometry(1, 1, 12).translate(0, 0.5, 0), this.arrowMaterial, shown.length);
    const [start, vector, turn, matrix, color] = [new Vector3(), new Vector3(), new Quaternion(), new Matrix4(), new Color()];
    shown.forEach((i, at) => {
      start.fromArray(positions, 3 * i);
      vector.fromArray(vectors, 3 * i);
      const length = vector.length();
      const wide = Math.min(thickness, length * 0.12);
      turn.setFromUnitVectors(UP, vector.clone().divideScalar(length));
      shafts.setMatrixAt(at, matrix.compose(start, turn, new Vector3(wide, length * (1 - HEAD), wide)));
      start.addScaledVector(vector, 1 - HEAD);
      heads.setMatrixAt(at, matrix.compose(start, turn, new Vector3(wide * 2.6, length * HEAD, wide * 2.6)));
      const row = Math.round((255 * length) / (longest || 1));
      color.setRGB(colors[4 * row]! / 255, colors[4 * row + 1]! / 255, colors[4 * row + 2]! / 255, SRGBColorSpace);
      shafts.setColorAt(at, color);
      heads.setColorAt(at, color);
    });
    for (const each of [shafts, heads]) {
      each.frustumCulled = false;
      this.arrows.add(each);
    }
  }

  /** A lattice that is only being considered. */
  setPreview(points: Float32Array | null, links: Uint32Array): void {
    this.preview.visible = points !== null;
    if (!points) return;
    this.preview.geometry.setAttribute("position", new BufferAttribute(points, 3));
    this.preview.geometry.setIndex(new BufferAttribute(links, 1));
  }

  /** Where a fold was found. */
  setMark(at: Vector3 | null, size: number): void {
    this.mark.visible = at !== null;
    if (at) {
      this.mark.position.copy(at);
      this.mark.scale.setScalar(size);
    }
  }

  private clearArrows(): void {
    for (const child of [...this.arrows.children]) {
      this.arrows.remove(child);
      if (child instanceof InstancedMesh) {
        child.geometry.dispose();
        child.dispose();
      }
    }
  }

  private addMark(): void {
    const core = new Mesh(new SphereGeometry(0.35, 24, 16), new MeshBasicMaterial({ color: 0xe0305a, depthTest: false }));
    const halo = new Mesh(
      new SphereGeometry(1, 24, 16),
      new MeshBasicMaterial({ color: 0xe0305a, depthTest: false, transparent: true, opacity: 0.22 }),
    );
    core.renderOrder = halo.renderOrder = 6;
    this.mark.add(halo, core);
  }
}
