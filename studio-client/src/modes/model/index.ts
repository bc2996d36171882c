// Shape models by hand: sliders, landmarks that are dragged, and the most likely shape that follows them.

import { Vector3, type Box3 } from "three";
import type { Studio } from "../../studio";
import { Handles } from "../../view/handles";
import { Latest } from "../../transport/latest";
import type { Layer } from "../../transport/protocol";
import { MODEL_KEYS } from "../key_lists";
import { registerMode, type Mode, type Pointer } from "../mode";
import { LandmarkGrip } from "./landmark_grip";
import { ModelPanel } from "./panel";
import { ModelState } from "./model_state";
import { RandomFieldPanel } from "./random_field";
import { CoefficientSliders } from "./sliders";
import { FitTarget } from "./target";
import { modelTour } from "./tour";
import { Uncertainty } from "./uncertainty";

const KIND = "conditioned-model";
class ModelMode implements Mode {
  readonly id = "model";
  readonly icon = "model";
  readonly title = "modeModel";
  readonly hint = "hintModel";
  readonly shortcut = "m";
  readonly shortcuts = MODEL_KEYS;
  readonly tour = modelTour;
  readonly probe = {
    landmarks: () => [...(this.model?.vertices ?? [])],
    screen: (index: number) => (this.model && index < this.model.landmarks ? this.onPage(this.model.landmark(index)) : null),
    project: (at: [number, number, number]) => this.onPage(new Vector3(...at)),
    coefficients: () => [...(this.model?.coefficients ?? [])],
    painted: () => this.studio.paint.value !== null,
    target: () => this.target.shown,
    field: () => this.field.facts,
    ready: () => this.model !== null && !this.grip.holds && !this.grip.drags,
  };
  private model: ModelState | null = null;
  private handles: Handles | null = null;
  private readonly grip: LandmarkGrip;
  private hovered: number | null = null;
  private readonly selected = new Set<number>();
  private readonly uncertainty: Uncertainty;
  private mesh: number | null = null;
  private stops: (() => void)[] = [];
  private readonly latest = new Latest<null>(() => this.load());
  private readonly sliders: CoefficientSliders;
  private readonly target: FitTarget;
  private readonly field: RandomFieldPanel;
  private readonly side: ModelPanel;

  constructor(private readonly studio: Studio) {
    this.uncertainty = new Uncertainty(studio);
    this.grip = new LandmarkGrip(studio, {
      model: () => this.model,
      load: () => this.load(),
      choose: (landmark) => this.choose(landmark, false),
      moved: () => this.handles?.move(),
      ended: () => this.latest.push(null),
    });
    this.sliders = new CoefficientSliders(studio);
    this.target = new FitTarget(studio, () => this.model?.layer ?? null);
    this.field = new RandomFieldPanel(studio);
    this.side = new ModelPanel(
      studio,
      { sliders: this.sliders, target: this.target, field: this.field },
      {
        release: (all) => void this.release(all),
        uncertainty: (on) => {
          this.uncertainty.shown = on;
          this.latest.push(null);
        },
      },
    );
  }

  enter(): void {
    const { studio } = this;
    this.handles = new Handles(studio.viewport);
    this.target.enter();
    this.field.enter();
    this.mesh = studio.scene?.mesh?.id ?? null;
    this.stops = [
      studio.session.scene.onChange(() => this.follow()),
      studio.activeLayer.onChange(() => this.latest.push(null)),
      studio.settings.all.onChange(() => this.look()),
    ];
    this.follow();
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.handles?.dispose();
    this.target.leave();
    this.field.leave();
    this.handles = this.model = null;
    this.uncertainty.clear();
    this.studio.viewport.canvas.style.cursor = "";
    this.studio.viewport.request();
  }

  panel(): { title: "modeModel"; body: HTMLElement } {
    this.showPanel();
    return { title: "modeModel", body: this.side.element };
  }

  /** The shape and what it shall become. */
  selectionBox(): Box3 | null {
    return this.target.box?.union(this.studio.mesh.box) ?? null;
  }

  down(pointer: Pointer): boolean {
    const { model, handles, studio } = this;
    if (!model || !handles || pointer.alt || this.grip.holds) return false;
    const found = handles.pick(pointer.x, pointer.y, pointer.touch ? 26 : undefined);
    if (found !== null) {
      this.choose(found, pointer.shift);
      this.grip.take(pointer, model, found);
      return true;
    }
    const hit = studio.viewport.ray(pointer.x, pointer.y).intersectObject(studio.mesh.target, false)[0];
    if (!hit?.face) {
      if (this.selected.size) this.choose(null, false);
      return false;
    }
    const vertex = this.nearest([hit.face.a, hit.face.b, hit.face.c], hit.point);
    void this.grip.place(pointer, model, vertex);
    return true;
  }

  move(pointer: Pointer): void {
    this.grip.move(pointer);
  }

  up(): void {
    this.grip.letGo();
  }

  hover(pointer: Pointer): void {
    const found = this.handles?.pick(pointer.x, pointer.y) ?? null;
    if (found === this.hovered) return;
    this.hovered = found;
    this.studio.viewport.canvas.style.cursor = found === null ? "" : "grab";
    this.look();
  }

  key(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    if (key === "escape" && this.grip.drags) {
      this.grip.cancel();
      return true;
    }
    if (key === "escape" && this.selected.size) {
      this.choose(null, false);
      return true;
    }
    if ((key === "delete" || key === "backspace") && this.selected.size) {
      void this.release(false);
      return true;
    }
    if (key !== "u" || !this.model) return false;
    this.uncertainty.shown = !this.uncertainty.shown;
    this.latest.push(null);
    return true;
  }

  private async release(all: boolean): Promise<void> {
    const { model } = this;
    if (!model) return;
    const index = Uint32Array.from(all ? model.vertices.keys() : this.selected);
    this.selected.clear();
    await this.studio.ask("model.release", { layer: model.layer }, { index });
  }

  private choose(index: number | null, more: boolean): void {
    if (!more) this.selected.clear();
    if (index !== null) this.selected.add(index);
    this.look();
    this.showPanel();
  }

  private nearest(corners: number[], point: Vector3): number {
    const { mesh } = this.studio;
    const away = corners.map((vertex) => new Vector3().fromArray(mesh.positions, 3 * vertex).distanceTo(point));
    return mesh.pointOf(corners[away.indexOf(Math.min(...away))]!);
  }

  private onPage(at: Vector3): { x: number; y: number } {
    const { left, top } = this.studio.viewport.canvas.getBoundingClientRect();
    const { x, y } = this.studio.viewport.project(at);
    return { x: x + left, y: y + top };
  }

  /** Another scene, or another state of it. */
  private follow(): void {
    const id = this.studio.scene?.mesh?.id ?? null;
    if (id !== this.mesh) {
      this.mesh = id;
      this.selected.clear();
      this.target.refresh();
    }
    if (this.field.shown) this.field.refresh();
    this.latest.push(null);
  }

  /** The model by hand: the active layer's, or the topmost. */
  private get layer(): Layer | null {
    const { layer, scene } = this.studio;
    return layer?.kind === KIND ? layer : (scene?.layers.findLast((each) => each.kind === KIND) ?? null);
  }

  private async load(): Promise<void> {
    const { layer, studio } = this;
    if (this.grip.drags || this.sliders.dragging) return;
    const answer = layer ? await studio.ask("model.get", { layer: layer.name }) : null;
    if (!this.handles || this.grip.drags || this.sliders.dragging) return;
    this.model = layer && answer ? new ModelState(layer.name, answer) : null;
    for (const index of this.selected) if (index >= (this.model?.landmarks ?? 0)) this.selected.delete(index);
    this.handles.load(this.model?.positions ?? new Float64Array(), new Uint32Array());
    this.look();
    this.showPanel();
    await this.uncertainty.paint(this.model);
  }

  private showPanel(): void {
    if (!this.sliders.dragging) this.side.show(this.model, this.selected.size, this.uncertainty.shown);
  }

  private look(): void {
    const { palette } = this.studio;
    this.target.look();
    this.handles?.setColors(
      (index) => (this.selected.has(index) ? palette.selected : index === this.hovered ? palette.hovered : palette.grid),
      (index) => (index === this.hovered || this.selected.has(index) ? 1.35 : 1.1),
      palette.lattice,
    );
    this.studio.viewport.request();
  }
}

registerMode((studio) => new ModelMode(studio));
