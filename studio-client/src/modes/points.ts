// Control points by hand: of a lattice, of sites, of a cage: of any deformer whose controls are positions.

import { Vector3 } from "three";
import type { TourStep } from "../panels/tour";
import type { IconName } from "../core/icons";
import type { StringKey } from "../core/strings";
import type { Studio } from "../studio";
import type { Layer } from "../transport/protocol";
import { Gizmo } from "../view/gizmo";
import { Handles } from "../view/handles";
import { ControlPoints, PointMotion } from "./control_points";
import { Grip } from "./grip";
import { LayerDrag } from "./layer_drag";
import { POINT_KEYS, type KeyLine } from "./key_lists";
import { registerMode, type Mode, type Pointer } from "./mode";
import { PointsPanel } from "./points_panel";
import { SelectionFrame } from "./selection_frame";
import { PointTools, type Axis, type Take } from "./points_tools";

export class PointsMode implements Mode {
  readonly id: string = "points";
  readonly icon: IconName = "points";
  readonly title: StringKey = "modePoints";
  readonly hint: StringKey = "hintPoints";
  readonly shortcut: string = "2";
  readonly shortcuts: readonly KeyLine[] = POINT_KEYS;
  points: ControlPoints | null = null;
  readonly tools: PointTools;
  protected handles: Handles | null = null;
  private gizmo: Gizmo | null = null;
  private readonly side: PointsPanel;
  private readonly frame = new SelectionFrame();
  private grip: Grip | null = null;
  private drag: LayerDrag | null = null;
  private motion: PointMotion | null = null;
  private hovered: number | null = null;
  private stops: (() => void)[] = [];
  private asked = 0;

  constructor(protected readonly studio: Studio) {
    this.tools = new PointTools(studio);
    this.side = new PointsPanel({
      place: (position) => void this.placeLast(position),
      reset: (all) => void this.reset(all),
      lock: (locked) => void this.lock(locked),
      chooseLayer: (axis, index) => this.chooseLayer(axis, index),
      chooseAll: () => this.chooseAll(),
    });
  }

  enter(): void {
    const { studio } = this;
    this.handles = new Handles(studio.viewport);
    this.gizmo = new Gizmo(studio.viewport);
    this.gizmo.onBegin = () => this.begin();
    this.gizmo.onMove = (matrix) => this.step((motion) => motion.transform(matrix));
    this.gizmo.onEnd = () => void this.finish();
    studio.viewport.element.append(this.frame.element);
    this.stops = [
      studio.session.scene.onChange(() => void this.load()),
      studio.activeLayer.onChange(() => void this.load()),
      studio.settings.all.onChange(() => this.look()),
      this.tools.state.watch(() => this.followTools()),
    ];
    void this.load();
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.handles?.dispose();
    this.gizmo?.dispose();
    this.frame.element.remove();
    this.points = this.handles = this.gizmo = null;
    this.studio.viewport.request();
  }

  toolbar(): HTMLElement {
    return this.tools.bar();
  }

  panel(): { title: StringKey; body: HTMLElement } {
    return { title: "selection", body: this.side.element };
  }

  /** Whether the gizmo takes what is clicked. */
  protected get overGizmo(): boolean {
    return this.gizmo?.hot ?? false;
  }

  /** The selected control points in numbers. */
  protected get numbers(): HTMLElement {
    return this.side.element;
  }

  tour(): TourStep[] {
    return [
      { title: "tourPointsDrag", text: "tourPointsDragText" },
      { at: ".stage-top .toolbar", title: "tourPointsTools", text: "tourPointsToolsText" },
      { at: '[data-section="layers"]', title: "tourPointsLayers", text: "tourPointsLayersText" },
      { at: '[data-section="history"]', title: "tourPointsHistory", text: "tourPointsHistoryText" },
    ];
  }

  selectionBox(): import("three").Box3 | null {
    return this.points?.selected.size ? this.points.box : null;
  }

  down(pointer: Pointer): boolean {
    this.gizmo?.useCamera();
    if (this.gizmo?.hot) return false;
    const { points, handles } = this;
    if (!points || !handles) return false;
    const group = this.find(pointer);
    const found = group?.[0];
    if (!group || found === undefined) {
      if (!this.tools.now.rectangle && !pointer.shift) return false;
      this.frame.begin(pointer);
      return true;
    }
    if (pointer.alt) points.choose(this.wholeLayer(found), pointer.shift ? "add" : "only");
    else if (pointer.shift) points.choose(group, group.length > 1 ? "add" : "toggle");
    else if (!group.every((index) => points.selected.has(index))) points.choose(group, "only");
    else points.last = found;
    this.look();
    if (this.gizmo) this.gizmo.enabled = false;
    this.grip = new Grip(this.studio.viewport, points.at(found), pointer);
    return true;
  }

  move(pointer: Pointer): void {
    if (this.frame.drawing) this.frame.stretch(pointer);
    const { grip } = this;
    if (!grip) return;
    if (!this.motion) {
      if (!grip.dragged(pointer) || !this.points?.selected.size) return;
      this.begin();
    }
    const by = grip.moved(pointer, this.tools.along, this.tools.diagonal);
    if (by) this.step((motion) => motion.translate(this.tools.restrained(by)));
  }

  up(pointer: Pointer): void {
    if (this.frame.drawing) this.takeRectangle(pointer);
    this.grip = null;
    if (this.gizmo) this.gizmo.enabled = true;
    if (this.motion) void this.finish();
  }

  hover(pointer: Pointer): void {
    const found = this.find(pointer)?.[0] ?? null;
    if (found === this.hovered) return;
    this.hovered = found;
    this.studio.viewport.canvas.style.cursor = found === null ? "" : "grab";
    this.look();
  }

  key(event: KeyboardEvent): boolean {
    const axis = "xyz".indexOf(event.key.toLowerCase());
    const keys: Record<string, () => void> = {
      g: () => this.tools.change({ tool: "translate" }),
      r: () => this.tools.change({ tool: "rotate" }),
      s: () => this.tools.change({ tool: "scale" }),
      b: () => this.tools.change({ rectangle: !this.tools.now.rectangle }),
      o: () => this.tools.change({ soft: !this.tools.now.soft }),
      n: () => this.tools.change({ snap: !this.tools.now.snap }),
      l: () => this.tools.change({ local: !this.tools.now.local }),
      a: () => this.chooseAll(),
      delete: () => void this.remove(),
      backspace: () => void this.remove(),
      escape: () => this.escape(),
    };
    if (axis >= 0) this.tools.change({ axis: this.tools.now.axis === axis ? null : (axis as Axis) });
    else if (keys[event.key.toLowerCase()]) keys[event.key.toLowerCase()]!();
    else return false;
    return true;
  }

  /** How far its rings are from the middle of the gizmo, in pixels. */
  get gizmoRadius(): number {
    const pivot = this.pivot();
    return pivot && this.gizmo ? this.gizmo.radius(pivot) / this.studio.viewport.pixel(pivot) : 0;
  }

  /** Where a control point is on the screen. */
  screen(index: number): { x: number; y: number } | null {
    return this.points ? this.studio.viewport.project(this.points.at(index)) : null;
  }

  /** Move a control point by equal steps, as fast as the answers come: what benchmarks measure. */
  async dragBySteps(index: number, moves: number, by: Vector3): Promise<void> {
    if (!this.points) return;
    this.points.choose([index], "only");
    this.begin();
    for (let i = 1; i <= moves; i++) {
      this.step((motion) => motion.translate(by.clone().multiplyScalar(i)));
      await this.drag?.answered();
      await this.studio.viewport.settled();
    }
    await this.finish();
  }

  chooseLayer(axis: Axis, index: number): void {
    const { points } = this;
    if (!points?.arranged) return;
    const wanted = Math.min(Math.max(index, 0), points.layers(axis) - 1);
    const first = [...Array(points.count).keys()].find((each) => points.place(each)![axis] === wanted);
    if (first !== undefined) points.choose(points.layerOf(first, axis), "only");
    this.look();
  }

  /** What a click takes: the control points of the thing that is there, the nearest first. */
  protected find(pointer: Pointer): number[] | null {
    const found = this.handles?.pick(pointer.x, pointer.y, pointer.touch ? 26 : undefined) ?? null;
    return found === null || !this.points ? null : [found, ...this.taken(found).filter((each) => each !== found)];
  }

  /** What there is to take in these control points. */
  protected takes(points: ControlPoints): readonly Take[] {
    if (points.round) return ["point", "ring", "row", "layer"];
    return points.shape ? ["point", "layer"] : ["point"];
  }

  /** What the key for deleting does. */
  protected remove(): Promise<void> {
    return this.reset(false);
  }

  /** Whether the mode is for a layer. */
  protected accepts(layer: Layer): boolean {
    return layer.points > 0;
  }

  /** The selection, or what is loaded, is another. */
  protected selectionChanged(): void {
    this.side.show(this.points);
  }

  /** The control points are elsewhere. */
  protected moved(): void {}

  private taken(index: number): number[] {
    const points = this.points!;
    const { take } = this.tools.now;
    if (take === "ring") return points.rowOf(index, 0);
    if (take === "row") return points.rowOf(index, 1);
    return take === "layer" ? this.wholeLayer(index) : [index];
  }

  /** A layer across the axis of a round lattice; of a box, the one that faces the eye. */
  private wholeLayer(index: number): number[] {
    const points = this.points!;
    return points.layerOf(index, points.round ? 2 : this.facingAxis());
  }

  private chooseAll(): void {
    const { points } = this;
    if (!points) return;
    const all = points.selected.size === points.count;
    points.choose(all ? [] : [...Array(points.count).keys()], "only");
    this.look();
  }

  private escape(): void {
    if (this.motion) {
      this.motion.undo();
      this.motion = this.grip = null;
      void this.drag?.cancel();
      this.drag = null;
      this.gizmo?.cancel();
      this.handles?.move();
    } else this.points?.choose([], "only");
    this.look();
  }

  /** Fetch the control points of the active layer. */
  protected async load(): Promise<void> {
    const { layer } = this.studio;
    const ticket = ++this.asked;
    if (!layer || !this.accepts(layer)) {
      this.points = null;
      this.handles?.load(new Float64Array(), new Uint32Array());
      this.look();
      return;
    }
    if (this.drag) return; // the drag's end brings another scene
    const answer = await this.studio.ask("points.get", { layer: layer.name });
    if (!answer || ticket !== this.asked || this.drag || !this.handles) return;
    const before = this.points;
    const middle = new Vector3(...(this.studio.scene!.mesh!.center as [number, number, number]));
    this.points = new ControlPoints(layer.name, layer.shape, answer, middle);
    if (before) this.points.keepSelection(before);
    this.handles.load(this.points.now, this.points.links);
    this.tools.offer(this.takes(this.points), this.points.shape !== null, this.points.turn);
    this.look();
  }

  private begin(): void {
    const { points, tools } = this;
    if (!points) return;
    this.motion = new PointMotion(points, tools.softRadius, tools.now.mirror);
    this.drag = new LayerDrag(this.studio, "drag", { layer: points.layer });
    this.look();
  }

  private step(apply: (motion: PointMotion) => void): void {
    const { motion, points } = this;
    if (!motion || !points) return;
    apply(motion);
    this.handles?.move();
    this.moved();
    this.side.follow(points);
    this.drag?.move({}, { index: motion.indices, positions: motion.positions });
    if (!this.gizmo?.dragging) this.gizmo?.place(this.pivot(), this.tools.turn);
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.motion = null;
    if (!drag) return;
    await drag.commit();
    this.drag = null;
    await this.load();
  }

  private async placeLast(position: Float64Array): Promise<void> {
    const { points } = this;
    if (!points || points.last === null) return;
    await this.studio.ask("points.set", { layer: points.layer }, { index: Uint32Array.of(points.last), positions: position });
  }

  protected async reset(all: boolean): Promise<void> {
    const { points } = this;
    if (!points || (!all && !points.selected.size)) return;
    const index = all ? {} : { index: Uint32Array.from(points.selected) };
    await this.studio.ask("points.reset", { layer: points.layer }, index);
  }

  private async lock(locked: boolean): Promise<void> {
    const { points } = this;
    if (!points) return;
    await this.studio.ask("points.lock", { layer: points.layer, locked }, { index: Uint32Array.from(points.selected) });
  }

  private takeRectangle(pointer: Pointer): void {
    const { left, top, right, bottom, shift } = this.frame.end(pointer);
    this.points?.choose(this.handles!.within(left, top, right, bottom), shift ? "add" : "only");
    this.look();
  }

  /** The lattice axis that looks most towards the eye: its layers are what Alt-click takes. */
  private facingAxis(): Axis {
    const eye = this.studio.viewport.cameras.direction();
    const facing = this.points!.axes.map((axis) => Math.abs(axis.dot(eye)));
    return facing.indexOf(Math.max(...facing)) as Axis;
  }

  private pivot(): Vector3 | null {
    const { points } = this;
    if (!points?.selected.size) return null;
    if (this.tools.now.pivot === "origin") return new Vector3();
    return this.tools.now.pivot === "last" && points.last !== null ? points.at(points.last) : points.center;
  }

  private followTools(): void {
    const { tool, snap, axis } = this.tools.now;
    this.gizmo?.setTool(tool);
    this.gizmo?.setAxis(axis);
    this.gizmo?.setSnap(snap ? this.tools.step : null);
    this.look();
  }

  /** Colours, gizmo and panel follow what is selected. */
  protected look(): void {
    const { points, handles, motion } = this;
    const palette = this.studio.palette;
    handles?.setColors(
      (index) => {
        if (points?.selected.has(index)) return palette.selected;
        if (points?.locked.has(index)) return palette.locked;
        const weight = motion?.weight(index) ?? 0;
        if (weight > 0) return palette.handle.clone().lerp(palette.selected, weight);
        return index === this.hovered ? palette.hovered : palette.handle;
      },
      (index) => (index === this.hovered ? 1.35 : points?.selected.has(index) ? 1.2 : 1),
      palette.lattice,
    );
    this.gizmo?.useCamera();
    this.gizmo?.place(this.pivot(), this.tools.turn);
    this.selectionChanged();
    this.studio.viewport.request();
  }
}

registerMode((studio) => new PointsMode(studio));
