// One point of view, seen in perspective or parallel.

import { Box3, OrthographicCamera, PerspectiveCamera, Sphere, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { MOUSE } from "three";

const FIELD_OF_VIEW = 32;
const ROOM = 1.12; // around what is framed

export class Cameras {
  readonly perspective = new PerspectiveCamera(FIELD_OF_VIEW);
  readonly parallel = new OrthographicCamera();
  controls: OrbitControls;
  private orthographic = false;
  private aspect = 1;
  private reach = 1; // how large the scene is: what near and far follow

  constructor(
    private readonly canvas: HTMLElement,
    private readonly changed: () => void,
  ) {
    this.controls = this.newControls();
  }

  get active(): PerspectiveCamera | OrthographicCamera {
    return this.orthographic ? this.parallel : this.perspective;
  }

  get target(): Vector3 {
    return this.controls.target;
  }

  resize(width: number, height: number): void {
    this.aspect = width / Math.max(height, 1);
    this.update();
  }

  /** The length of a pixel at a place, in the scene's unit. */
  pixel(at: Vector3, height: number): number {
    if (this.orthographic) return (this.parallel.top - this.parallel.bottom) / this.parallel.zoom / height;
    const depth = Math.abs(at.clone().sub(this.perspective.position).dot(this.direction()));
    return (2 * Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * depth) / height;
  }

  /** Look from where others look. */
  copy(others: Cameras): void {
    this.reach = others.reach;
    this.target.copy(others.target);
    this.active.up.copy(others.active.up);
    this.active.position.copy(others.active.position);
    this.active.zoom = others.active.zoom;
    this.update();
    this.controls.update();
  }

  direction(): Vector3 {
    return this.active.getWorldDirection(new Vector3());
  }

  setOrthographic(wanted: boolean): void {
    if (wanted === this.orthographic) return;
    const from = this.active;
    this.orthographic = wanted;
    const to = this.active;
    const distance = from.position.distanceTo(this.target);
    to.up.copy(from.up);
    if (wanted) {
      this.parallel.zoom = 1 / (distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
      to.position.copy(from.position);
    } else {
      const away = 1 / (this.parallel.zoom * Math.tan((FIELD_OF_VIEW * Math.PI) / 360));
      to.position.copy(this.target).addScaledVector(from.position.clone().sub(this.target).normalize(), away);
    }
    this.controls.object = to;
    this.update();
    this.controls.update();
  }

  setUp(axis: "y" | "z"): void {
    const up = axis === "z" ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
    if (this.active.up.equals(up)) return;
    this.perspective.up.copy(up);
    this.parallel.up.copy(up);
    const target = this.target.clone();
    this.controls.dispose();
    this.controls = this.newControls();
    this.controls.target.copy(target);
    this.controls.update();
  }

  /** Look at a box from a direction; the present one by default. */
  frame(box: Box3, from?: Vector3): void {
    if (box.isEmpty()) return;
    const sphere = box.getBoundingSphere(new Sphere());
    const radius = Math.max(sphere.radius, 1e-9) * ROOM;
    const away = (from ?? this.active.position.clone().sub(this.target)).clone().normalize();
    const half = (FIELD_OF_VIEW * Math.PI) / 360;
    const narrow = Math.atan(Math.tan(half) * Math.min(this.aspect, 1));
    const distance = radius / Math.sin(narrow);
    this.target.copy(sphere.center);
    this.active.position.copy(sphere.center).addScaledVector(away, distance);
    this.parallel.zoom = 1 / (distance * Math.tan(half));
    this.update();
    this.controls.update();
    this.changed();
  }

  setReach(reach: number): void {
    this.reach = Math.max(reach, 1e-9);
    this.update();
  }

  /** Turn about the target to look from a direction, keeping the distance. */
  lookFrom(direction: Vector3): void {
    const distance = this.active.position.distanceTo(this.target);
    const start = this.active.position.clone().sub(this.target).normalize();
    const goal = steady(direction.clone().normalize(), this.active.up);
    const began = performance.now();
    const step = (now: number): void => {
      const part = Math.min((now - began) / 260, 1);
      const eased = 1 - (1 - part) ** 3;
      const at = start.clone().lerp(goal, eased);
      if (at.length() < 1e-3) at.set(goal.y, goal.z, goal.x);
      this.active.position.copy(this.target).addScaledVector(at.normalize(), distance);
      this.controls.update();
      this.update();
      this.changed();
      if (part < 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  update(): void {
    const distance = this.active.position.distanceTo(this.target);
    this.perspective.aspect = this.aspect;
    this.perspective.near = Math.max(distance - 4 * this.reach, distance / 500, 1e-6 * this.reach);
    this.perspective.far = distance + 8 * this.reach;
    this.perspective.updateProjectionMatrix();
    this.parallel.left = -this.aspect;
    this.parallel.right = this.aspect;
    this.parallel.top = 1;
    this.parallel.bottom = -1;
    this.parallel.near = -8 * this.reach;
    this.parallel.far = distance + 8 * this.reach;
    this.parallel.updateProjectionMatrix();
  }

  private newControls(): OrbitControls {
    const controls = new OrbitControls(this.active, this.canvas);
    controls.enableDamping = false;
    controls.zoomToCursor = true;
    controls.rotateSpeed = 0.9;
    controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    controls.addEventListener("change", () => {
      this.update();
      this.changed();
    });
    return controls;
  }
}

/** A direction that is not quite along the up axis, where orbiting would lose its bearings. */
function steady(direction: Vector3, up: Vector3): Vector3 {
  if (Math.abs(direction.dot(up)) < 0.9999) return direction;
  const aside = Math.abs(up.z) > 0.5 ? new Vector3(0, -1, 0) : new Vector3(0, 0, 1);
  return direction.addScaledVector(aside, 1e-3).normalize();
}
