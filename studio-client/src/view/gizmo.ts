// The gizmo that moves, turns and scales what is selected, about a pivot.

import { Matrix4, Object3D, OrthographicCamera, Quaternion, Vector3 } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Viewport } from "./viewport";

export type Tool = "translate" | "rotate" | "scale";

export class Gizmo {
  onBegin: () => void = () => undefined;
  onMove: (matrix: Matrix4) => void = () => undefined;
  onEnd: () => void = () => undefined;
  private readonly controls: TransformControls;
  private readonly anchor = new Object3D();
  private pivot = new Matrix4();

  constructor(private readonly viewport: Viewport) {
    const { controls, anchor } = this.make();
    this.controls = controls;
    viewport.helpers.add(anchor, controls.getHelper());
  }

  /** Whether the pointer is over an arrow or a ring, which then takes the click. */
  get hot(): boolean {
    return this.controls.enabled && this.controls.object !== undefined && this.controls.axis !== null;
  }

  /** Whether it takes clicks: not while something else is held, where an arrow may point at the eye. */
  set enabled(enabled: boolean) {
    this.controls.enabled = enabled;
  }

  get dragging(): boolean {
    return this.controls.dragging;
  }

  setTool(tool: Tool): void {
    this.controls.setMode(tool);
    this.viewport.request();
  }

  setAxis(axis: 0 | 1 | 2 | null): void {
    this.controls.showX = axis === null || axis === 0;
    this.controls.showY = axis === null || axis === 1;
    this.controls.showZ = axis === null || axis === 2;
    this.viewport.request();
  }

  setSnap(step: number | null): void {
    this.controls.setTranslationSnap(step);
    this.controls.setRotationSnap(step === null ? null : Math.PI / 12);
    this.controls.setScaleSnap(step === null ? null : 0.1);
  }

  /** To a place, along axes of its own or those of the world. */
  place(at: Vector3 | null, turn: Quaternion | null = null): void {
    if (this.controls.dragging) return;
    if (at === null) this.controls.detach();
    else {
      this.anchor.position.copy(at);
      this.anchor.quaternion.copy(turn ?? new Quaternion());
      this.controls.setSpace(turn ? "local" : "world");
      this.anchor.scale.setScalar(1);
      this.anchor.updateMatrixWorld();
      this.controls.attach(this.anchor);
    }
    this.viewport.request();
  }

  /** The radius of its rings at a place, in the scene's unit: as the controls scale themselves. */
  radius(at: Vector3): number {
    const camera = this.viewport.cameras.active;
    const size = this.controls.size / 4;
    if (camera instanceof OrthographicCamera) return (0.5 * size * (camera.top - camera.bottom)) / camera.zoom;
    const reach = 1.9 * Math.tan((Math.PI * camera.fov) / 360) / camera.zoom;
    return 0.5 * size * at.distanceTo(camera.position) * Math.min(reach, 7);
  }

  /** Let go without finishing. */
  cancel(): void {
    const { controls } = this;
    if (!controls.dragging) return;
    controls.reset();
    controls.dragging = false;
    controls.axis = null;
    const orbit = this.viewport.cameras.controls;
    orbit.enabled = false; // the button is still down: it does not go on with turning the view
    addEventListener("pointerup", () => (orbit.enabled = true), { once: true });
  }

  dispose(): void {
    this.controls.detach();
    this.viewport.helpers.remove(this.anchor, this.controls.getHelper());
    this.controls.dispose();
  }

  private make(): { controls: TransformControls; anchor: Object3D } {
    const controls = new TransformControls(this.viewport.cameras.active, this.viewport.canvas);
    controls.setSize(0.85);
    controls.setColors("#d93a50", "#2f9a4a", "#2f6be0", "#f2a53c");
    controls.addEventListener("change", () => this.viewport.request());
    controls.addEventListener("objectChange", () => {
      if (controls.mode === "scale" && controls.axis === "XYZ") this.anchor.scale.setScalar(this.swelling());
      this.onMove(this.matrix());
    });
    controls.addEventListener("dragging-changed", (event) => {
      this.viewport.cameras.controls.enabled = !event.value;
      if (event.value) {
        this.pivot = this.anchor.matrixWorld.clone();
        this.onBegin();
      } else this.onEnd();
    });
    return { controls, anchor: this.anchor };
  }

  /** Follow the camera that is in use. */
  useCamera(): void {
    this.controls.camera = this.viewport.cameras.active;
  }

  /** By its middle it doubles a ring's radius to the right or above, and halves as far to the left or below. */
  private swelling(): number {
    const { pointStart, pointEnd } = this.controls as unknown as { pointStart: Vector3; pointEnd: Vector3 };
    const { x, y } = pointEnd.clone().sub(pointStart).applyQuaternion(this.viewport.cameras.active.quaternion.clone().invert());
    return 2 ** ((x + y) / this.radius(this.anchor.position));
  }

  /** What has happened to the anchor since the drag began, as a map of space. */
  private matrix(): Matrix4 {
    const { position, quaternion, scale } = this.anchor;
    const kept = new Vector3(...scale.toArray().map((s) => (Math.abs(s) < 1e-3 ? Math.sign(s || 1) * 1e-3 : s)));
    const now = new Matrix4().compose(position, new Quaternion().copy(quaternion), kept);
    return now.multiply(this.pivot.clone().invert());
  }
}
