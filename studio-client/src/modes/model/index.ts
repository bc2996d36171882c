// Shape models by hand: sliders, landmarks that are dragged, and the most likely shape that follows them.

import { Plane, Vector3, type Box3 } from "three";
import { t } from "../../core/strings";
import type { Studio } from "../../studio";
import { Handles } from "../../view/handles";
import { Latest } from "../../transport/latest";
import type { Numbers } from "../../transport/frame";
import type { Layer } from "../../transport/protocol";
import { LayerDrag } from "../layer_drag";
import { MODEL_KEYS } from "../key_lists";
import { registerMode, type Mode, type Pointer } from "../mode";
import { ModelPanel } from "./panel";
import { ModelState } from "./model_state";
import { RandomFieldPanel } from "./random_field";
import { CoefficientSliders } from "./sliders";
import { FitTarget } from "./target";
import { modelTour } from "./tour";

const KIND = "conditioned-model";
const SLOP = 3; // pixels that a click may wander

/** A landmark under the pointer, or one that is only being made. */
interface Grab {
  index: number | null;
  plane: Plane;
  offset: Vector3;
  from: Pointer;
  to: Pointer;
  moved: boolean;
  released: boolean;
}

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
    ready: () => this.model !== null && !this.grab && !this.drag,
  };
  private model: ModelState | null = null;
  private handles: Handles | null = null;
  private grab: Grab | null = null;
  private drag: LayerDrag | null = null;
  private hovered: number | null = null;
  private readonly selected = new Set<number>();
  private uncertainty = true;
  private painted = "";
  private mesh: number | null = null;
  private stops: (() => void)[] = [];
  private readonly latest = new Latest<null>(() => this.load());
  private readonly sliders: CoefficientSliders;
  private readonly target: FitTarget;
  private readonly field: RandomFieldPanel;
  private readonly side: ModelPanel;

  constructor(private readonly studio: Studio) {
    this.sliders = new CoefficientSliders(studio);
    this.target = new FitTarget(studio, () => this.model?.layer ?? null);
    this.field = new RandomFieldPanel(studio);
    this.side = new ModelPanel(
      studio,
      { sliders: this.sliders, target: this.target, field: this.field },
      {
        release: (all) => void this.release(all),
        uncertainty: (on) => {
          this.uncertainty = on;
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
    this.painted = "";
    this.studio.paint.set(null);
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
    if (!model || !handles || pointer.alt || this.grab) return false;
    const found = handles.pick(pointer.x, pointer.y, pointer.touch ? 26 : undefined);
    if (found !== null) {
      this.choose(found, pointer.shift);
      this.grab = this.newGrab(pointer, model.landmark(found), found);
      return true;
    }
    const hit = studio.viewport.ray(pointer.x, pointer.y).intersectObject(studio.mesh.target, false)[0];
    if (!hit?.face) {
      if (this.selected.size) this.choose(null, false);
      return false;
    }
    const vertex = this.nearest([hit.face.a, hit.face.b, hit.face.c], hit.point);
    const at = new Vector3().fromArray(studio.mesh.positions, 3 * vertex);
    this.grab = this.newGrab(pointer, at, null);
    void this.place(model, vertex, this.grab);
    return true;
  }

  move(pointer: Pointer): void {
    const { grab } = this;
    if (!grab) return;
    grab.to = pointer;
    grab.moved ||= Math.hypot(pointer.x - grab.from.x, pointer.y - grab.from.y) >= SLOP;
    if (grab.moved && grab.index !== null) this.pull(grab);
  }

  up(): void {
    const { grab } = this;
    if (!grab) return;
    grab.released = true;
    if (grab.index !== null) void this.finish();
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
    if (key === "escape" && this.drag) {
      void this.drag.cancel().then(() => this.latest.push(null));
      this.drag = this.grab = null;
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
    this.uncertainty = !this.uncertainty;
    this.latest.push(null);
    return true;
  }

  private newGrab(from: Pointer, at: Vector3, index: number | null): Grab {
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.studio.viewport.cameras.direction(), at);
    const under = this.studio.viewport.ray(from.x, from.y).ray.intersectPlane(plane, new Vector3()) ?? at;
    return { index, plane, offset: at.clone().sub(under), from, to: from, moved: false, released: false };
  }

  /** Make a vertex a landmark; what the pointer did meanwhile is made up for. */
  private async place(model: ModelState, vertex: number, grab: Grab): Promise<void> {
    const answer = await this.studio.ask("model.landmark", { layer: model.layer, vertex });
    if (this.grab !== grab) return;
    if (!answer) {
      this.grab = null;
      return;
    }
    await this.load();
    grab.index = answer.head["landmark"] as number;
    this.choose(grab.index, false);
    if (grab.moved) this.pull(grab);
    if (grab.released) await this.finish();
  }

  private pull(grab: Grab): void {
    const { model, studio } = this;
    const to = studio.viewport.ray(grab.to.x, grab.to.y).ray.intersectPlane(grab.plane, new Vector3());
    if (!model || !to || grab.index === null) return;
    this.drag ??= new LayerDrag(studio, "model", { layer: model.layer, label: "landmark" });
    const goal = to.add(grab.offset).toArray();
    model.positions.set(goal, 3 * grab.index);
    this.handles?.move();
    this.drag.move({}, { index: Uint32Array.of(grab.index), positions: new Float64Array(goal) });
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.grab = null;
    if (!drag) return;
    await drag.commit();
    this.drag = null;
    this.latest.push(null);
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
    if (this.drag || this.sliders.dragging) return;
    const answer = layer ? await studio.ask("model.get", { layer: layer.name }) : null;
    if (!this.handles || this.drag || this.sliders.dragging) return;
    this.model = layer && answer ? new ModelState(layer.name, answer) : null;
    for (const index of this.selected) if (index >= (this.model?.landmarks ?? 0)) this.selected.delete(index);
    this.handles.load(this.model?.positions ?? new Float64Array(), new Uint32Array());
    this.look();
    this.showPanel();
    await this.paint();
  }

  /** How sure the model is of each point, as colours; it depends on which landmarks there are, not on where. */
  private async paint(): Promise<void> {
    const { model, studio } = this;
    const key = model && this.uncertainty && model.landmarks ? model.knowledge : "";
    if (key === this.painted) return;
    this.painted = key;
    const answer = key ? await studio.ask("model.uncertainty", { layer: model!.layer }) : null;
    if (this.painted !== key) return;
    studio.paint.set(
      answer && {
        title: t("uncertainty"),
        unit: t("unitLength"),
        low: answer.head["low"] as number,
        high: answer.head["high"] as number,
        values: answer.arrays["values"] as Float32Array,
        table: answer.arrays["table"] as Numbers,
      },
    );
  }

  private showPanel(): void {
    if (!this.sliders.dragging) this.side.show(this.model, this.selected.size, this.uncertainty);
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
