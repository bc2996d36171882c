// Sites: control points that are put onto the surface by a click, and dragged (Dirichlet free-form deformation).

import { h, replace } from "../../core/dom";
import type { IconName } from "../../core/icons";
import type { StringKey } from "../../core/strings";
import type { TourStep } from "../../panels/tour";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { Handles } from "../../view/handles";
import { listenClicks } from "../click";
import type { ControlPoints } from "../control_points";
import { Influence } from "../influence";
import { SITE_KEYS } from "../key_lists";
import { registerMode } from "../mode";
import { PointsMode } from "../points";
import { SitesPanel } from "./panel";
import { sitesTour } from "./tour";

const KIND = "dirichlet-ffd";

class SitesMode extends PointsMode {
  override readonly id = "sites";
  override readonly icon: IconName = "sites";
  override readonly title: StringKey = "modeSites";
  override readonly hint: StringKey = "hintSites";
  override readonly shortcut = "6";
  override readonly shortcuts = SITE_KEYS;
  readonly probe = {
    screen: (index: number) => this.onPage(index),
    count: () => this.points?.count ?? this.waiting.length / 3,
    moved: (index: number) => this.points?.displacement(index).length() ?? 0,
    selected: () => [...(this.points?.selected ?? [])],
  };
  private readonly influence: Influence;
  private readonly sites: SitesPanel;
  private pins: Handles | null = null;
  /** Places of a new layer's sites, as long as there are too few. */
  private waiting = new Float64Array();
  private ends: (() => void)[] = [];
  /** Clicks are done one after another: a site goes where the one before it has led. */
  private queue: Promise<void> = Promise.resolve();

  constructor(studio: Studio) {
    super(studio);
    this.influence = new Influence(studio);
    this.sites = new SitesPanel(studio, {
      scatter: (count) => void this.began("sites.scatter", { count }),
      mirror: (axis) => void studio.ask("sites.mirror", { layer: this.points?.layer ?? "", axis }),
      remove: () => void this.remove(),
      begin: () => studio.activeLayer.set(""),
    });
  }

  override enter(): void {
    super.enter();
    const { studio } = this;
    this.pins = new Handles(studio.viewport);
    this.preferSites();
    this.ends = [
      listenClicks(studio.viewport, (x, y) => this.click(x, y)),
      studio.meshLoaded.onChange(() => this.wait(new Float64Array())),
    ];
  }

  override leave(): void {
    for (const end of this.ends) end();
    this.pins?.dispose();
    this.pins = null;
    super.leave();
    this.influence.show(null);
  }

  override panel(): { title: StringKey; body: HTMLElement } {
    const body = h("div");
    replace(body, this.sites.element, this.numbers);
    return { title: "modeSites", body };
  }

  override tour(): TourStep[] {
    return sitesTour();
  }

  protected override accepts(layer: Layer): boolean {
    return layer.kind === KIND;
  }

  protected override async remove(): Promise<void> {
    const { points } = this;
    if (!points?.selected.size) return;
    const index = Uint32Array.from(points.selected);
    points.selected.clear();
    await this.studio.ask("sites.remove", { layer: points.layer }, { index });
  }

  protected override selectionChanged(): void {
    super.selectionChanged();
    this.sites.show(this.points);
    this.influence.show(this.points);
  }

  private onPage(index: number): { x: number; y: number } | null {
    const at = this.screen(index);
    const { left, top } = this.studio.viewport.canvas.getBoundingClientRect();
    return at && { x: at.x + left, y: at.y + top };
  }

  private preferSites(): void {
    const other = this.studio.scene?.layers.findLast((layer) => layer.kind === KIND);
    if (other && this.studio.layer?.kind !== KIND) this.studio.activeLayer.set(other.name);
  }

  /** Put a site where the surface was clicked. */
  private click(x: number, y: number): void {
    const { studio } = this;
    const taken = this.overGizmo || this.find({ x, y, shift: false, alt: false, ctrl: false, touch: false });
    const hit = taken ? null : studio.viewport.ray(x, y).intersectObject(studio.mesh.target, false)[0];
    if (!hit?.face || !hit.barycoord) return;
    const { a, b, c } = hit.face;
    const mirror = this.tools.now.mirror;
    const place = {
      triangle: [a, b, c].map((vertex) => studio.mesh.pointOf(vertex)),
      weights: hit.barycoord.toArray(),
      ...(mirror === null ? {} : { mirror }),
    };
    this.queue = this.queue.then(() => this.began("sites.place", { layer: this.points?.layer ?? "", ...place }));
  }

  /** What makes sites: they are shown, and the new one is selected. */
  private async began(command: string, values: Record<string, unknown>): Promise<void> {
    const { studio } = this;
    const answer = await studio.ask(command, values);
    if (!answer) return;
    this.wait((answer.arrays["waiting"] as Float64Array | undefined) ?? new Float64Array());
    const { layer, site } = answer.head as { layer: string; site: number };
    if (!layer) return;
    studio.activeLayer.set(layer);
    await this.load();
    if (command === "sites.place") this.choose(site);
  }

  private choose(site: number): void {
    const points: ControlPoints | null = this.points;
    if (!points || site >= points.count) return;
    points.choose([site], "only");
    this.look();
  }

  private wait(places: Float64Array): void {
    this.waiting = places as Float64Array<ArrayBuffer>;
    const { palette } = this.studio;
    this.pins?.load(places, new Uint32Array());
    this.pins?.setColors(
      () => palette.soft,
      () => 1,
      palette.lattice,
    );
    this.studio.viewport.request();
  }
}

registerMode((studio) => new SitesMode(studio));
