// Control points as spheres of the same size on the screen, and the lines between neighbours.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DynamicDrawUsage,
  Group,
  IcosahedronGeometry,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  MeshBasicMaterial,
  Vector3,
} from "three";
import type { Viewport } from "./viewport";

const RADIUS = 5.5; // pixels
const FINGER = 14; // pixels: how near a click must be
const SOLID = `
  #include <color_fragment>
  float facing = normalize(vNormalSeen).z;
  diffuseColor.rgb = mix(diffuseColor.rgb * 0.62, diffuseColor.rgb * 1.08, smoothstep(0.0, 0.9, facing));`;

export class Handles {
  readonly object = new Group();
  private spheres: InstancedMesh | null = null;
  private readonly lines: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly behind: LineSegments<BufferGeometry, LineBasicMaterial>;
  private positions: Float64Array = new Float64Array();
  private sizes = new Float32Array();
  private readonly unwatch: () => void;

  constructor(private readonly viewport: Viewport) {
    const material = new LineBasicMaterial({ transparent: true, opacity: 0.85 });
    const faint = new LineBasicMaterial({ transparent: true, opacity: 0.22, depthTest: false, depthWrite: false });
    this.lines = new LineSegments(new BufferGeometry(), material);
    this.behind = new LineSegments(this.lines.geometry, faint);
    this.lines.frustumCulled = this.behind.frustumCulled = false;
    this.behind.renderOrder = 2;
    this.object.add(this.behind, this.lines);
    viewport.helpers.add(this.object);
    this.unwatch = viewport.cameras.controls ? this.followCamera() : () => undefined;
  }

  dispose(): void {
    this.unwatch();
    this.viewport.helpers.remove(this.object);
    this.spheres?.dispose();
    this.lines.geometry.dispose();
  }

  /** Take control points and which of them are joined by a line. */
  load(positions: Float64Array, links: Uint32Array): void {
    const count = positions.length / 3;
    this.positions = positions;
    this.sizes = new Float32Array(count).fill(1);
    if (this.spheres) {
      this.object.remove(this.spheres);
      this.spheres.dispose();
    }
    const material = new MeshBasicMaterial({ depthTest: false, transparent: true });
    shade(material);
    this.spheres = new InstancedMesh(new IcosahedronGeometry(1, 2), material, Math.max(count, 1));
    this.spheres.count = count;
    this.spheres.instanceMatrix.setUsage(DynamicDrawUsage);
    this.spheres.frustumCulled = false;
    this.spheres.renderOrder = 4;
    this.object.add(this.spheres);
    const at = new BufferAttribute(new Float32Array(positions), 3);
    at.setUsage(DynamicDrawUsage);
    this.lines.geometry.setAttribute("position", at);
    this.lines.geometry.setIndex(new BufferAttribute(links, 1));
    this.place();
  }

  setColors(color: (index: number) => Color, size: (index: number) => number, line: Color): void {
    if (!this.spheres) return;
    for (let i = 0; i < this.sizes.length; i++) {
      this.spheres.setColorAt(i, color(i));
      this.sizes[i] = size(i);
    }
    if (this.spheres.instanceColor) this.spheres.instanceColor.needsUpdate = true;
    this.lines.material.color.copy(line);
    this.behind.material.color.copy(line);
    this.place();
  }

  /** Follow the positions, which are changed in place. */
  move(): void {
    const at = this.lines.geometry.getAttribute("position") as BufferAttribute;
    (at.array as Float32Array).set(this.positions);
    at.needsUpdate = true;
    this.place();
    this.viewport.request();
  }

  replacePositions(positions: Float64Array): void {
    this.positions = positions;
    this.move();
  }

  /** The control point nearest to a pixel, within a finger's width; the one in front where several are. */
  pick(x: number, y: number, reach = FINGER): number | null {
    let best: number | null = null;
    let least = Infinity;
    const place = new Vector3();
    for (let i = 0; i < this.sizes.length; i++) {
      const seen = this.viewport.project(place.fromArray(this.positions, 3 * i));
      const away = Math.hypot(seen.x - x, seen.y - y);
      if (away > reach || Math.abs(seen.depth) > 1) continue;
      const rank = Math.max(away - RADIUS, 0) + 40 * seen.depth;
      if (rank < least) [best, least] = [i, rank];
    }
    return best;
  }

  /** All control points within a rectangle of pixels. */
  within(left: number, top: number, right: number, bottom: number): number[] {
    const found: number[] = [];
    const place = new Vector3();
    for (let i = 0; i < this.sizes.length; i++) {
      const { x, y } = this.viewport.project(place.fromArray(this.positions, 3 * i));
      if (x >= left && x <= right && y >= top && y <= bottom) found.push(i);
    }
    return found;
  }

  /** Spheres keep their size on the screen: they are scaled before each drawing. */
  private place(): void {
    if (!this.spheres) return;
    const matrix = new Matrix4();
    const at = new Vector3();
    for (let i = 0; i < this.sizes.length; i++) {
      at.fromArray(this.positions, 3 * i);
      const size = this.viewport.pixel(at) * RADIUS * this.sizes[i]!;
      matrix.makeScale(size, size, size).setPosition(at);
      this.spheres.setMatrixAt(i, matrix);
    }
    this.spheres.instanceMatrix.needsUpdate = true;
    this.spheres.boundingSphere = null;
  }

  private followCamera(): () => void {
    const before = this.viewport.scene.onBeforeRender;
    let last = "";
    this.viewport.scene.onBeforeRender = (...context) => {
      before.apply(this.viewport.scene, context);
      const key = `${this.viewport.camera.matrixWorld.elements.join()},${this.viewport.camera.projectionMatrix.elements.join()},${this.viewport.size.height}`;
      if (key !== last) {
        last = key;
        this.place();
      }
    };
    return () => {
      this.viewport.scene.onBeforeRender = before;
    };
  }
}

/** A little roundness without lights, so that a colour means the same everywhere. */
function shade(material: MeshBasicMaterial): void {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vNormalSeen;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvNormalSeen = normalMatrix * normal;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying vec3 vNormalSeen;")
      .replace("#include <color_fragment>", SOLID);
  };
}
