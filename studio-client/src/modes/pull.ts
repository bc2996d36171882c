// Direct manipulation: a point of the surface is dragged, and the control points follow.

import { Plane, Vector3 } from "three";
import type { TourStep } from "../panels/tour";
import type { Studio } from "../studio";
import { Handles } from "../view/handles";
import { LayerDrag } from "./layer_drag";
import { PULL_KEYS } from "./key_lists";
import { registerMode, type Mode, type Pointer } from "./mode";

class PullMode implements Mode {
  readonly id = "pull";
  readonly icon = "pull";
  readonly title = "modePull";
  readonly hint = "hintPull";
  readonly shortcut = "3";
  readonly shortcuts = PULL_KEYS;
  private handles: Handles | null = null;
  private drag: LayerDrag | null = null;
  private plane = new Plane();
  private offset = new Vector3();
  private goal = new Float64Array(3);
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {}

  enter(): void {
    this.handles = new Handles(this.studio.viewport);
    this.stops = [
      this.studio.session.scene.onChange(() => void this.load()),
      this.studio.activeLayer.onChange(() => void this.load()),
    ];
    this.studio.viewport.canvas.style.cursor = "crosshair";
    void this.load();
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.handles?.dispose();
    this.handles = null;
    this.studio.viewport.canvas.style.cursor = "";
    this.studio.viewport.request();
  }

  down(pointer: Pointer): boolean {
    const { layer, mesh, viewport } = this.studio;
    if (!layer?.linear) return false;
    const hit = viewport.ray(pointer.x, pointer.y).intersectObject(mesh.target, false)[0];
    if (!hit?.face) return false;
    const { a, b, c } = hit.face;
    this.plane.setFromNormalAndCoplanarPoint(viewport.cameras.direction(), hit.point);
    this.offset.copy(hit.point);
    this.goal = new Float64Array(hit.point.toArray());
    this.drag = new LayerDrag(
      this.studio,
      "pull",
      { layer: layer.name, triangle: [a, b, c].map((vertex) => mesh.pointOf(vertex)), point: hit.point.toArray() },
      (arrays) => {
        if (arrays["controls"]) this.showControls(arrays["controls"] as Float64Array);
      },
    );
    return true;
  }

  move(pointer: Pointer): void {
    const to = this.studio.viewport.ray(pointer.x, pointer.y).ray.intersectPlane(this.plane, new Vector3());
    if (!to || !this.drag) return;
    this.goal.set(to.toArray());
    this.drag.move({}, { goal: this.goal.slice() });
  }

  up(): void {
    const { drag } = this;
    this.drag = null;
    void drag?.commit();
  }

  key(event: KeyboardEvent): boolean {
    if (event.key !== "Escape" || !this.drag) return false;
    void this.drag.cancel();
    this.drag = null;
    return true;
  }

  tour(): TourStep[] {
    return [
      { title: "tourPullSurface", text: "tourPullSurfaceText" },
      { at: '[data-section="layers"]', title: "tourPullEscape", text: "tourPullEscapeText" },
    ];
  }

  private showControls(now: Float64Array): void {
    if (!this.handles) return;
    this.handles.replacePositions(now);
  }

  private async load(): Promise<void> {
    const { layer, palette } = this.studio;
    if (!layer?.points) {
      this.handles?.load(new Float64Array(), new Uint32Array());
      return;
    }
    const answer = await this.studio.ask("points.get", { layer: layer.name });
    if (!answer || !this.handles) return;
    this.handles.load(answer.arrays["points"] as Float64Array, answer.arrays["links"] as Uint32Array);
    this.handles.setColors(
      () => palette.handle,
      () => 0.7,
      palette.lattice,
    );
    this.studio.viewport.request();
  }
}

registerMode((studio) => new PullMode(studio));
