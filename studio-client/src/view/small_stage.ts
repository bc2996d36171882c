// Many small pictures by one renderer: each is drawn off the page and copied to a canvas of its own.

import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  HemisphereLight,
  Mesh,
  MeshPhongMaterial,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
  type Color,
} from "three";

/** A shape that moves: its moments, one after another, and how long they last. */
export class Motion {
  readonly geometry = new BufferGeometry();
  readonly box = new Box3();
  private readonly position: BufferAttribute;
  private readonly normal: BufferAttribute;
  private readonly size: number;

  constructor(
    private readonly positions: Float32Array,
    private readonly normals: Int8Array,
    triangles: Uint32Array,
    readonly moments: number,
    readonly period: number,
  ) {
    this.size = positions.length / moments;
    this.position = new BufferAttribute(new Float32Array(this.size), 3);
    this.normal = new BufferAttribute(new Int8Array(this.size), 3, true);
    this.geometry.setAttribute("position", this.position);
    this.geometry.setAttribute("normal", this.normal);
    this.geometry.setIndex(new BufferAttribute(triangles, 1));
    this.box.setFromArray(positions as unknown as number[]);
  }

  /** Take the shape of a time in seconds: between two moments it changes in proportion. */
  pose(time: number): void {
    const at = (((time / this.period) % 1) + 1) % 1 * this.moments;
    const [first, part] = [Math.floor(at) % this.moments, at % 1];
    const [from, to] = [first * this.size, ((first + 1) % this.moments) * this.size];
    const out = this.position.array;
    for (let i = 0; i < this.size; i++) {
      out[i] = this.positions[from + i]! + part * (this.positions[to + i]! - this.positions[from + i]!);
    }
    const nearest = part < 0.5 ? from : to;
    (this.normal.array as Int8Array).set(this.normals.subarray(nearest, nearest + this.size));
    this.position.needsUpdate = this.normal.needsUpdate = true;
  }
}

export class SmallStage {
  private readonly renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(28, 1, 0.01, 100);
  private readonly surface = new Mesh(new BufferGeometry(), new MeshPhongMaterial({ specular: 0x1c1f24, shininess: 30, side: 2 }));

  constructor(
    readonly width: number,
    readonly height: number,
    color: Color,
    private readonly from: Vector3,
    up: Vector3,
  ) {
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.up.copy(up);
    this.surface.material.color.copy(color);
    this.surface.frustumCulled = false;
    const key = new DirectionalLight(0xffffff, 2);
    key.position.set(-0.6, 0.9, 1);
    const eye = new PerspectiveCamera().add(key);
    this.camera.add(...eye.children, key.target);
    this.scene.add(this.surface, this.camera, new HemisphereLight(0xffffff, 0x8d94a3, 1));
  }

  /** Draw a motion at a time onto a canvas. */
  draw(motion: Motion, time: number, canvas: HTMLCanvasElement): void {
    motion.pose(time);
    this.surface.geometry = motion.geometry;
    const center = motion.box.getCenter(new Vector3());
    const radius = Math.max(motion.box.getSize(new Vector3()).length() / 2, 1e-9);
    const away = (0.86 * radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.camera.position.copy(center).addScaledVector(this.from, -away);
    this.camera.near = Math.max(away - 2 * radius, away / 100);
    this.camera.far = away + 2 * radius;
    this.camera.lookAt(center);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    const context = canvas.getContext("2d");
    context?.clearRect(0, 0, canvas.width, canvas.height);
    context?.drawImage(this.renderer.domElement, 0, 0, canvas.width, canvas.height);
  }

  dispose(): void {
    this.surface.material.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
