// The canvas: what is drawn, from where, and when. It draws after something changed, never in a loop.

import {
  AmbientLight,
  Box3,
  DirectionalLight,
  Group,
  HemisphereLight,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Camera,
} from "three";
import { h } from "../core/dom";
import { Signal } from "../core/signal";
import { Cameras } from "./cameras";
import { Ground } from "./ground";

export class Viewport {
  readonly element = h("div", { class: "viewport" });
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  /** What belongs to the shape, and what helps to edit it: pictures and comparisons leave the latter out. */
  readonly shape = new Group();
  readonly helpers = new Group();
  readonly ground = new Ground();
  readonly cameras: Cameras;
  readonly drawn = new Signal(0);
  /** Before | after: where the divide stands, as part of the width; null = no comparison. */
  divide: number | null = null;
  beforeDraw: ((side: "before" | "after") => void) | null = null;
  /** Skip the draw calls, so that what leads up to them can be timed without a graphics card. */
  skipDrawing = false;

  private readonly lights = new Group();
  private readonly sizes = new ResizeObserver(() => this.resize());
  private asked = false;
  private frames = 0;

  constructor(antialias: boolean) {
    this.renderer = new WebGLRenderer({ antialias, alpha: true, preserveDrawingBuffer: false });
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "3-D view");
    this.element.append(canvas);
    this.cameras = new Cameras(canvas, () => this.request());
    this.cameras.perspective.position.set(1.6, -2.6, 1.4);
    this.cameras.perspective.up.set(0, 0, 1);
    this.cameras.parallel.up.set(0, 0, 1);
    this.addLights();
    this.scene.add(this.ground.object, this.shape, this.helpers);
    this.sizes.observe(this.element);
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  get camera(): Camera {
    return this.cameras.active;
  }

  get size(): { width: number; height: number } {
    return { width: this.element.clientWidth, height: this.element.clientHeight };
  }

  /** Whether a drawing has been asked for. */
  get waiting(): boolean {
    return this.asked;
  }

  /** Draw at the next opportunity. */
  request(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.draw();
    });
  }

  /** When what has been asked for is drawn. */
  settled(): Promise<void> {
    if (!this.asked) return Promise.resolve();
    return new Promise((resolve) => {
      const stop = this.drawn.onChange(() => {
        stop();
        resolve();
      });
    });
  }

  draw(): void {
    this.cameras.active.updateMatrixWorld();
    this.lights.quaternion.copy(this.cameras.active.quaternion);
    this.lights.updateMatrixWorld();
    if (!this.skipDrawing) {
      if (this.divide === null) this.drawWhole();
      else this.drawDivided(this.divide);
    }
    this.drawn.set(++this.frames);
  }

  /** A place of the scene in CSS pixels from the canvas's upper left corner, and its depth. */
  project(at: Vector3): { x: number; y: number; depth: number } {
    const { width, height } = this.size;
    if (this.asked) this.camera.updateMatrixWorld(); // it has moved, and is not drawn yet
    const seen = at.clone().project(this.camera);
    return { x: ((seen.x + 1) / 2) * width, y: ((1 - seen.y) / 2) * height, depth: seen.z };
  }

  ray(x: number, y: number): Raycaster {
    const { width, height } = this.size;
    const caster = new Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(new Vector2((x / width) * 2 - 1, 1 - (y / height) * 2), this.cameras.active);
    return caster;
  }

  pixel(at: Vector3): number {
    return this.cameras.pixel(at, Math.max(this.size.height, 1));
  }

  frame(box: Box3, from?: Vector3): void {
    this.cameras.setReach(Math.max(box.getSize(new Vector3()).length(), this.cameras.target.length() * 1e-6));
    this.cameras.frame(box, from);
  }

  /** Colours of a rectangle as it is drawn now: rows from below, four bytes a pixel. */
  read(x: number, y: number, width: number, height: number): number[] {
    this.draw();
    const ratio = this.renderer.getPixelRatio();
    const gl = this.renderer.getContext();
    const bytes = new Uint8Array(4 * width * height);
    const below = gl.drawingBufferHeight - Math.round(ratio * y) - height;
    gl.readPixels(Math.round(ratio * x), below, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return [...bytes];
  }

  /** The view as a picture of any size. */
  async picture(width: number, height: number, background: string | null, helpers: boolean): Promise<Blob> {
    const { renderer } = this;
    const ratio = renderer.getPixelRatio();
    const hidden = this.helpers.visible;
    this.helpers.visible = helpers;
    const ground = this.ground.object.visible;
    this.ground.object.visible = ground && background !== null;
    renderer.setPixelRatio(1);
    renderer.setSize(width, height, false);
    this.cameras.resize(width, height);
    this.draw();
    const sheet = document.createElement("canvas");
    sheet.width = width;
    sheet.height = height;
    const context = sheet.getContext("2d")!;
    if (background) {
      context.fillStyle = background;
      context.fillRect(0, 0, width, height);
    }
    context.drawImage(renderer.domElement, 0, 0);
    this.helpers.visible = hidden;
    this.ground.object.visible = ground;
    renderer.setPixelRatio(ratio);
    this.resize();
    this.draw();
    return new Promise((resolve, reject) =>
      sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("this picture is too large"))), "image/png"),
    );
  }

  /** Projection times view, column by column: what selections on the screen need. */
  get seeing(): Float64Array {
    const { active } = this.cameras;
    active.updateMatrixWorld();
    return new Float64Array(active.projectionMatrix.clone().multiply(active.matrixWorldInverse).elements);
  }

  dispose(): void {
    this.sizes.disconnect();
    this.cameras.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private drawWhole(): void {
    this.beforeDraw?.("after");
    this.renderer.setScissorTest(false);
    this.renderer.render(this.scene, this.camera);
  }

  private drawDivided(at: number): void {
    const { width, height } = this.size;
    const left = Math.round(width * at);
    this.renderer.setScissorTest(true);
    this.renderer.setScissor(0, 0, left, height);
    this.beforeDraw?.("before");
    this.renderer.render(this.scene, this.camera);
    this.renderer.setScissor(left, 0, width - left, height);
    this.beforeDraw?.("after");
    this.renderer.render(this.scene, this.camera);
    this.renderer.setScissorTest(false);
  }

  private resize(): void {
    const { width, height } = this.size;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 3));
    this.renderer.setSize(width, height, false);
    this.cameras.resize(width, height);
    this.draw();
  }

  /** A key light over the viewer's left shoulder, a fill from the right, and a little sky: they move with the eye. */
  private addLights(): void {
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(-0.6, 0.9, 1);
    const fill = new DirectionalLight(0xdfe8ff, 0.55);
    fill.position.set(0.9, -0.2, 0.6);
    this.lights.add(key, fill, key.target, fill.target);
    this.scene.add(this.lights, new HemisphereLight(0xffffff, 0x8d94a3, 0.9), new AmbientLight(0xffffff, 0.25));
  }
}
