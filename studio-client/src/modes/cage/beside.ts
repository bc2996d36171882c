// The same cage in the same pose under other coordinates, in views beside the main one: live while it is dragged.

import { h } from "../../core/dom";
import { tWord } from "../../core/strings";
import type { Studio } from "../../studio";
import { Latest } from "../../transport/latest";
import { Handles } from "../../view/handles";
import { MeshView } from "../../view/mesh_view";
import { SideView } from "../../view/side_view";
import type { ControlPoints } from "../control_points";

const PLACES = ["right", "left"] as const;

export class Beside {
  private others: Other[] = [];
  private points: ControlPoints | null = null;
  private kinds: string[] = [];
  private now = "";
  private readonly title = h("span", { class: "side-title" });
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {}

  enter(): void {
    const { session, pointsMoved, meshLoaded, settings } = this.studio;
    this.stops = [
      session.scene.onChange(() => this.others.forEach((each) => each.bind())),
      pointsMoved.onChange(() => this.others.forEach((each) => each.follow())),
      meshLoaded.onChange(() => this.place()),
      settings.all.onChange(() => this.others.forEach((each) => each.paint())),
      session.on("cage-beside", ({ head }) => this.others.forEach((each) => each.told(head))),
    ];
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.kinds = [];
    this.show(null);
  }

  get chosen(): readonly string[] {
    return this.kinds;
  }

  /** Which coordinates are shown beside those of the layer. */
  choose(kinds: string[]): void {
    this.kinds = kinds;
    this.place();
  }

  /** The cage that they belong to, and its own coordinates. */
  show(points: ControlPoints | null, now = this.now): void {
    const other = points?.layer !== this.points?.layer || points?.count !== this.points?.count;
    this.points = points;
    this.now = now;
    this.title.textContent = tWord("coordinates_", now);
    if (other) this.place();
    else this.move();
  }

  /** The cage is elsewhere. */
  move(): void {
    if (this.points) for (const each of this.others) each.draw(this.points);
  }

  view(kind: string): Other | undefined {
    return this.others.find((each) => each.kind === kind);
  }

  private place(): void {
    for (const each of this.others) each.close();
    this.title.remove();
    const { points } = this;
    this.others = points ? this.kinds.map((kind, at) => new Other(this.studio, kind, PLACES[at]!, points)) : [];
    if (this.others.length) this.studio.viewport.element.append(this.title);
  }
}

export class Other {
  readonly mesh: MeshView;
  private readonly side: SideView;
  private readonly handles: Handles;
  private readonly layer: string;
  private readonly latest = new Latest<null>(() => this.fetch());
  private closed = false;

  constructor(
    private readonly studio: Studio,
    readonly kind: string,
    place: "left" | "right",
    points: ControlPoints,
  ) {
    this.layer = points.layer;
    this.side = new SideView(studio, tWord("coordinates_", kind), {}, place);
    this.side.link();
    const { viewport } = this.side;
    this.mesh = new MeshView(() => viewport.request(), studio.mesh);
    viewport.shape.add(this.mesh.object);
    this.handles = new Handles(viewport);
    this.handles.load(points.now, points.links);
    this.paint();
    this.bind();
  }

  /** Have the coordinates computed, in the background. */
  bind(): void {
    void this.studio.ask("cage.beside", { layer: this.layer, coordinates: this.kind });
  }

  /** They have been computed. */
  told(head: Record<string, unknown>): void {
    if (head["coordinates"] === this.kind && head["layer"] === this.layer) this.follow();
  }

  follow(): void {
    this.latest.push(null);
  }

  draw(points: ControlPoints): void {
    this.handles.replacePositions(points.now);
    this.paint(points.selected);
  }

  paint(selected: ReadonlySet<number> = new Set()): void {
    const { palette, settings } = this.studio;
    this.mesh.apply(settings.now, palette);
    this.handles.setColors((at) => (selected.has(at) ? palette.selected : palette.handle), () => 0.6, palette.lattice);
    this.side.viewport.request();
  }

  close(): void {
    this.closed = true;
    this.handles.dispose();
    this.mesh.clear();
    this.side.close();
  }

  private async fetch(): Promise<void> {
    const answer = await this.studio.ask("cage.beside_at", { layer: this.layer, coordinates: this.kind });
    if (this.closed || !answer?.arrays["positions"]) return;
    this.mesh.move(null, answer.arrays["positions"], answer.arrays["normals"]!);
  }
}
