// Control points by hand: of a lattice, of sites, of a cage: of any deformer whose controls are positions.

import { Vector3 } from "three";
import type { TourStep } from "../panels/tour";
import type { IconName } from "../core/icons";
import type { StringKey } from "../core/strings";
import type { Studio } from "../studio";
import type { Layer } from "../transport/protocol";
import { Handles } from "../view/handles";
import { ControlPoints } from "./control_points";
import { POINT_KEYS, type KeyLine } from "./key_lists";
import { registerMode, type Mode, type Pointer } from "./mode";
import { lockPoints, placeLast, resetPoints } from "./point_commands";
import { PointDrag } from "./point_drag";
import { paintPoints } from "./point_colors";
import { PointGizmo } from "./point_gizmo";
import { PointTaking } from "./point_taking";
import { pointToolbar } from "./point_toolbar";
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
  private gizmo: PointGizmo | null = null;
  private readonly side: PointsPanel;
  private readonly frame = new SelectionFrame();
  private readonly held: PointDrag;
  private readonly taking: PointTaking;
  private hovered: number | null = null;
  private stops: (() => void)[] = [];
  private asked = 0;

  constructor(protected readonly studio: Studio) {
    this.tools = new PointTools(studio);
    this.taking = new PointTaking(studio, this.tools);
    this.held = new PointDrag(studio, this.tools, () => this.follow());
    this.side = new PointsPanel({
      place: (position) => void placeLast(studio, this.points, position),
      reset: (all) => void resetPoints(studio, this.points, all),
      lock: (locked) => void lockPoints(studio, this.points, locked),
      chooseLayer: (axis, index) => this.chooseLayer(axis, index),
      chooseAll: () => this.chooseAll(),
    });
  }

  enter(): void {
    const { studio } = this;
    this.handles = new Handles(studio.viewport);
    this.gizmo = new PointGizmo(studio, this.tools, {
      begin: () => this.begin(),
      move: (matrix) => this.held.step((motion) => motion.transform(matrix)),
      end: () => void this.finish(),
    });
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
    return pointToolbar(this.tools);
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
    if (pointer.alt) points.choose(this.taking.layer(points, found), pointer.shift ? "add" : "only");
    else if (pointer.shift) points.choose(group, group.length > 1 ? "add" : "toggle");
    else if (!group.every((index) => points.selected.has(index))) points.choose(group, "only");
    else points.last = found;
    this.look();
    if (this.gizmo) this.gizmo.enabled = false;
    this.held.take(points.at(found), pointer);
    return true;
  }

  move(pointer: Pointer): void {
    if (this.frame.drawing) this.frame.stretch(pointer);
    const { held } = this;
    if (!held.pulls(pointer) || !this.points?.selected.size) return;
    if (!held.moving) this.begin();
    held.pull(pointer);
  }

  up(pointer: Pointer): void {
    if (this.frame.drawing) this.takeRectangle(pointer);
    this.held.letGo();
    if (this.gizmo) this.gizmo.enabled = true;
    if (this.held.moving) void this.finish();
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
      j: () => this.tools.change({ smooth: !this.tools.now.smooth }),
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
    return this.gizmo?.radius(this.points) ?? 0;
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
      this.held.step((motion) => motion.translate(by.clone().multiplyScalar(i)));
      await this.held.answers();
      await this.studio.viewport.settled();
    }
    await this.finish();
  }

  chooseLayer(axis: Axis, index: number): void {
    const { points } = this;
    if (!points?.arranged) return;
    const found = this.taking.numbered(points, axis, index);
    if (found.length) points.choose(found, "only");
    this.look();
  }

  /** What a click takes: the control points of the thing that is there, the nearest first. */
  protected find(pointer: Pointer): number[] | null {
    const found = this.handles?.pick(pointer.x, pointer.y, pointer.touch ? 26 : undefined) ?? null;
    return found === null || !this.points ? null : [found, ...this.taking.with(this.points, found).filter((each) => each !== found)];
  }

  /** What there is to take in these control points. */
  protected takes(points: ControlPoints): readonly Take[] {
    if (points.round) return ["point", "ring", "row", "layer"];
    return points.shape ? ["point", "layer"] : ["point"];
  }

  /** What the key for deleting does. */
  protected remove(): Promise<void> {
    return resetPoints(this.studio, this.points, false);
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

  private chooseAll(): void {
    const { points } = this;
    points?.choose(this.taking.all(points), "only");
    this.look();
  }

  private escape(): void {
    if (this.held.moving) {
      this.held.cancel();
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
    if (this.held.lasts) return; // the drag's end brings another scene
    const answer = await this.studio.ask("points.get", { layer: layer.name });
    if (!answer || ticket !== this.asked || this.held.lasts || !this.handles) return;
    const before = this.points;
    const middle = new Vector3(...(this.studio.scene!.mesh!.center as [number, number, number]));
    this.points = new ControlPoints(layer.name, layer.shape, answer, middle);
    if (before) this.points.keepSelection(before);
    this.handles.load(this.points.now, this.points.links);
    this.tools.offer(this.takes(this.points), this.points.shape !== null, this.points.turn, this.points.joints);
    this.look();
  }

  private begin(): void {
    if (this.points) this.held.begin(this.points);
    this.look();
  }

  /** Handles, gizmo and panel go along. */
  private follow(): void {
    const { points } = this;
    if (!points) return;
    this.handles?.move();
    this.moved();
    this.side.follow(points);
    this.gizmo?.place(points);
  }

  private async finish(): Promise<void> {
    if (await this.held.finish()) await this.load();
  }

  private takeRectangle(pointer: Pointer): void {
    const { left, top, right, bottom, shift } = this.frame.end(pointer);
    this.points?.choose(this.handles!.within(left, top, right, bottom), shift ? "add" : "only");
    this.look();
  }

  private followTools(): void {
    this.gizmo?.followTools();
    this.look();
  }

  /** Colours, gizmo and panel follow what is selected. */
  protected look(): void {
    if (this.handles) paintPoints(this.handles, this.studio.palette, this.points, this.held, this.hovered);
    this.gizmo?.place(this.points);
    this.selectionChanged();
    this.studio.viewport.request();
  }
}

registerMode((studio) => new PointsMode(studio));
