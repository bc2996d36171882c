// Cages: built by a budget or by planes, verified, dragged by vertices, edges and faces, under one of several coordinates.

import { h, replace } from "../../core/dom";
import type { IconName } from "../../core/icons";
import { t, tWord, type StringKey } from "../../core/strings";
import type { TourStep } from "../../panels/tour";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { CageFaces } from "../../view/cage_faces";
import type { ControlPoints } from "../control_points";
import { CAGE_KEYS } from "../key_lists";
import { registerMode, type Pointer } from "../mode";
import { PointsMode } from "../points";
import type { Take } from "../points_tools";
import { Beside } from "./beside";
import { BuildPanel } from "./build_panel";
import { CagePanel, type Report, type Row } from "./cage_panel";
import { pickEdge } from "./edge_picking";
import { Plans } from "./plan";
import { Planes } from "./planes";
import { cageTour } from "./tour";

class CageMode extends PointsMode {
  override readonly id = "cage";
  override readonly icon: IconName = "cage";
  override readonly title: StringKey = "modeCage";
  override readonly hint: StringKey = "hintCage";
  override readonly shortcut = "7";
  override readonly shortcuts = CAGE_KEYS;
  readonly probe = {
    screen: (index: number) => this.onPage(index),
    count: () => this.points?.count ?? 0,
    selected: () => [...(this.points?.selected ?? [])].sort((a, b) => a - b),
    cuts: () => this.plans.now.cuts,
    beside: (kind: string, vertex: number) => [...(this.beside.view(kind)?.mesh.positions.slice(3 * vertex, 3 * vertex + 3) ?? [])],
  };
  private readonly plans = new Plans();
  private readonly build = new BuildPanel(this.plans, { build: () => void this.start() });
  private readonly facts = new CagePanel({
    exchange: (coordinates) => void this.studio.ask("cage.coordinates", { layer: this.points?.layer ?? "", coordinates }),
    compare: () => void this.compare(),
    showOther: (kind) => void this.showOther(kind),
    beside: (kinds) => this.beside.choose(kinds),
  });
  private readonly planes: Planes;
  private readonly beside: Beside;
  private readonly body = h("div");
  private faces: CageFaces | null = null;
  private loaded = "";
  private rows: Row[] = [];
  private readonly leftOut = new Map<string, string[]>();
  private known: string[] | null = null;
  private ends: (() => void)[] = [];

  constructor(studio: Studio) {
    super(studio);
    this.planes = new Planes(studio, this.plans, (message) => this.build.tell(message));
    this.beside = new Beside(studio);
    studio.session.on("cage-report", ({ head }) => {
      if (head["layer"] === this.points?.layer) this.facts.setReport(head["report"] as Report);
    });
    studio.session.on("cage-planes", ({ head }) => {
      this.leftOut.set(head["layer"] as string, head["left_out"] as string[]);
      this.facts.setLeftOut(this.leftOut.get(this.points?.layer ?? "") ?? []);
    });
    studio.session.on("cage-comparison", ({ head }) => {
      this.rows = head["rows"] as Row[];
      this.facts.setRows(this.rows, null);
    });
  }

  override enter(): void {
    super.enter();
    const { studio } = this;
    this.faces = new CageFaces(studio.viewport);
    this.loaded = "";
    this.planes.enter();
    this.beside.enter();
    const other = studio.scene?.layers.findLast((layer) => layer.kind === "cage");
    if (other && studio.layer?.kind !== "cage") studio.activeLayer.set(other.name);
    this.ends = [
      this.plans.state.onChange(() => this.planes.show()),
      studio.meshLoaded.onChange(() => this.plans.change({ cuts: [] })),
      studio.session.scene.onChange(() => this.forgetComparison()),
      studio.session.scene.watch(() => this.takeNew()),
    ];
    this.planes.show();
  }

  override leave(): void {
    for (const end of this.ends) end();
    this.known = null;
    this.faces?.dispose();
    this.faces = null;
    this.planes.leave();
    this.beside.leave();
    this.facts.forgetBeside();
    this.studio.paint.set(null);
    super.leave();
  }

  override panel(): { title: StringKey; body: HTMLElement } {
    this.fill();
    return { title: "modeCage", body: this.body };
  }

  override tour(): TourStep[] {
    return cageTour();
  }

  override down(pointer: Pointer): boolean {
    if (this.drawsPlanes && !pointer.alt) {
      this.planes.begin(pointer);
      return true;
    }
    return super.down(pointer);
  }

  override move(pointer: Pointer): void {
    if (this.planes.drawing) this.planes.stretch(pointer);
    else super.move(pointer);
  }

  override up(pointer: Pointer): void {
    if (this.planes.drawing) void this.planes.end(pointer, t("planeMissed")).then(() => this.build.show());
    else super.up(pointer);
  }

  override key(event: KeyboardEvent): boolean {
    if (event.key === "Escape" && this.planes.drawing) {
      this.planes.cancel();
      return true;
    }
    return super.key(event);
  }

  protected override accepts(layer: Layer): boolean {
    return layer.kind === "cage";
  }

  protected override takes(): readonly Take[] {
    return ["point", "edge", "face"];
  }

  protected override find(pointer: Pointer): number[] | null {
    const { take } = this.tools.now;
    if (!this.points || this.drawsPlanes) return null;
    if (take === "edge") return pickEdge(this.studio.viewport, this.points, pointer.x, pointer.y);
    return take === "face" ? (this.faces?.pick(pointer.x, pointer.y) ?? null) : super.find(pointer);
  }

  protected override selectionChanged(): void {
    super.selectionChanged();
    const { points, faces, studio } = this;
    const key = points ? `${points.layer} ${points.count} ${studio.meshLoaded.value}` : "";
    if (key !== this.loaded) {
      this.loaded = key;
      this.fill();
      if (points) this.body.closest("section")?.scrollIntoView({ block: "start" }); // what is verified shall be seen
      this.planes.show(points === null);
      void this.fetch(points);
    }
    this.beside.show(points);
    if (points) faces?.move(points.now);
    faces?.setColors(studio.palette.lattice, studio.palette.selected);
    faces?.mark(points?.selected ?? new Set());
  }

  protected override moved(): void {
    if (this.points) this.faces?.move(this.points.now);
    this.beside.move();
  }

  private get drawsPlanes(): boolean {
    return this.points === null && this.plans.now.method === "cuts" && this.plans.now.drawing;
  }

  private onPage(index: number): { x: number; y: number } | null {
    const at = this.screen(index);
    const { left, top } = this.studio.viewport.canvas.getBoundingClientRect();
    return at && { x: at.x + left, y: at.y + top };
  }

  private fill(): void {
    if (this.points) replace(this.body, this.facts.element, this.numbers);
    else {
      this.build.show();
      replace(this.body, this.build.element);
    }
    this.studio.viewport.canvas.style.cursor = this.drawsPlanes ? "crosshair" : "";
  }

  /** The faces of another cage, and whether it is sound. */
  private async fetch(points: ControlPoints | null): Promise<void> {
    if (!points) {
      this.faces?.load({ corners: new Uint32Array(), offsets: new Uint32Array([0]) }, new Float64Array());
      return;
    }
    this.facts.setReport(null);
    this.facts.setLeftOut(this.leftOut.get(points.layer) ?? []);
    const answer = await this.studio.ask("cage.get", { layer: points.layer });
    if (!answer || points.layer !== this.points?.layer) return;
    this.call(answer.head["coordinates"] as string);
    const { faces, offsets } = answer.arrays;
    this.faces?.load({ corners: faces as Uint32Array, offsets: offsets as Uint32Array }, this.points.now);
    this.look();
    await this.studio.ask("cage.check", { layer: points.layer });
  }

  private async start(): Promise<void> {
    this.plans.change({ drawing: false });
    await this.studio.ask("cage.build", ...this.plans.asked);
    this.plans.change({ drawing: this.plans.now.method === "cuts" });
  }

  private async compare(): Promise<void> {
    const kinds = ["mean_value", "green", "harmonic", "maximum_entropy"];
    await this.studio.ask("cage.compare", { layer: this.points?.layer ?? "", kinds });
  }

  /** Colour the shape by its distance from what other coordinates make of it. */
  private async showOther(kind: string | null): Promise<void> {
    const answer = kind === null ? null : await this.studio.ask("cage.other", { coordinates: kind });
    this.facts.setRows(this.rows, answer && kind);
    this.studio.paint.set(
      answer && {
        title: tWord("coordinates_", kind!),
        unit: t("unitLength"),
        low: 0,
        high: (answer.head["high"] as number) || 1e-9,
        values: answer.arrays["values"] as Float32Array,
        table: answer.arrays["table"]!,
      },
    );
  }

  /** A cage that has just been built is the one to be dragged. */
  private takeNew(): void {
    const names = (this.studio.scene?.layers ?? []).filter((layer) => layer.kind === "cage").map((layer) => layer.name);
    const built = names.find((name) => !this.known?.includes(name));
    if (this.known && built !== undefined) this.studio.activeLayer.set(built);
    this.known = names;
  }

  /** Which coordinates the cage has. */
  private call(kind: string): void {
    this.facts.show(kind);
    this.beside.name(kind);
  }

  private forgetComparison(): void {
    this.call(String(this.studio.layer?.fields.find((field) => field.name === "coordinates")?.value ?? "mean_value"));
    if (!this.rows.length) return;
    this.rows = [];
    this.facts.setRows([], null);
    this.studio.paint.set(null);
  }
}

registerMode((studio) => new CageMode(studio));
