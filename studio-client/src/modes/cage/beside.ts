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
  private readonly title = h("span", { class: "side-title" });
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {}

  enter(): void {
    const { session, pointsMoved, meshLoaded, settings } = this.studio;
    this.stops = [
      session.scene.onChange(() => this.others.forEach((each) => each.follow(true))),
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

  /** What the coordinates of the cage itself are. */
  name(kind: string): void {
    this.title.textContent = tWord("coordinates_", kind);
  }

  /** The cage that they belong to. */
  show(points: ControlPoints | null): void {
    const other = points?.layer !== this.points?.layer || points?.count !== this.points?.count;
    this.points = points;
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
  private asked = false;

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
    this.follow();
  }

  /** The coordinates have been computed. */
  told(head: Record<string, unknown>): void {
    if (head["coordinates"] === this.kind && head["layer"] === this.layer) this.follow();
  }

  /** Show the present pose; in another scene, coordinates that are not there yet are computed. */
  follow(again = false): void {
    if (again) this.asked = false;
    this.latest.push(null);
  }

  draw(points: ControlPoints): void {
    this.handles.replacePositions(points.now);
    this.paint(points.selected);
  }

  paint(selected: ReadonlySet<number> = new Set()): void {
    const { palette, settings } = this.studio;
    this.mesh.apply(settings.now, palette);
    this.studio.placeGround(this.side.viewport);
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
    const which = { layer: this.layer, coordinates: this.kind };
    const answer = await this.studio.ask("cage.beside_at", which);
    if (this.closed || !answer) return;
    const { positions, normals } = answer.arrays;
    if (positions?.length === 3 * this.mesh.pointCount) this.mesh.move(null, positions, normals!);
    else if (!this.asked) {
      this.asked = true;
      await this.studio.ask("cage.beside", which);
    }
  }
}
