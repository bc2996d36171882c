// Barr and friends by hand: handles for the axis, its bounds and the numbers of a deformer, on the canvas.

import { Vector3, type Box3 } from "three";
import { tWord } from "../../core/strings";
import type { Studio } from "../../studio";
import { Latest } from "../../transport/latest";
import type { Numbers } from "../../transport/frame";
import { GhostLines } from "../../view/ghost_lines";
import { Handles } from "../../view/handles";
import { reveal } from "../../view/reveal";
import { Tags } from "../../view/tags";
import { LayerDrag } from "../layer_drag";
import { AXIAL_KEYS } from "../key_lists";
import { registerMode, type Mode, type Pointer } from "../mode";
import { addAxial, axialToolbar } from "./adding";
import { HandleSet, type Role } from "./handle_set";
import { axialPanel } from "./panel";
import { axialTour } from "./tour";

const SIZES: Record<Role, number> = { number: 1.3, bound: 0.95, origin: 1.1, direction: 1 };

class AxialMode implements Mode {
  readonly id = "axial";
  readonly icon = "twist";
  readonly title = "modeAxial";
  readonly hint = "hintAxial";
  readonly shortcut = "5";
  readonly shortcuts = AXIAL_KEYS;
  readonly probe = {
    names: () => this.set?.facts.map((each) => each.name) ?? [],
    screen: (name: string) => this.screen(name),
    adding: () => this.adding > 0,
    value: (name: string) => this.set?.values[this.set.index(name)] ?? null,
  };
  private set: HandleSet | null = null;
  private handles: Handles | null = null;
  private ghost: GhostLines | null = null;
  private tags: Tags | null = null;
  private drag: LayerDrag | null = null;
  private held: number | null = null;
  private offset = { x: 0, y: 0 };
  private hovered: number | null = null;
  private snap = false;
  private adding = 0; // layers that are being added
  private stops: (() => void)[] = [];
  private readonly latest = new Latest<null>(() => this.load());

  constructor(private readonly studio: Studio) {}

  enter(): void {
    const { studio } = this;
    this.handles = new Handles(studio.viewport);
    this.ghost = new GhostLines(studio.viewport);
    this.tags = new Tags(studio.viewport);
    this.stops = [
      studio.session.scene.onChange(() => this.latest.push(null)),
      studio.activeLayer.onChange(() => this.latest.push(null)),
      studio.pointsMoved.onChange(() => this.drag ?? this.latest.push(null)),
      studio.settings.all.onChange(() => this.look()),
    ];
    this.preferAxial();
    this.latest.push(null);
  }

  leave(): void {
    for (const stop of this.stops) stop();
    void this.drag?.cancel();
    this.drag = this.held = null;
    this.handles?.dispose();
    this.ghost?.dispose();
    this.tags?.dispose();
    this.handles = this.ghost = this.tags = this.set = null;
    this.studio.viewport.canvas.style.cursor = "";
  }

  toolbar(): HTMLElement {
    return axialToolbar(
      this.snap,
      (snap) => (this.snap = snap),
      (kind) => void this.add(kind),
    );
  }

  panel(): { title: "modeAxial"; body: HTMLElement } {
    return { title: "modeAxial", body: axialPanel(this.studio) };
  }

  tour = axialTour;

  /** The shape and the handles around it. */
  selectionBox(): Box3 | null {
    return this.set && this.set.box.union(this.studio.mesh.box);
  }

  down(pointer: Pointer): boolean {
    const { set, handles } = this;
    const found = handles?.pick(pointer.x, pointer.y, pointer.touch ? 26 : undefined) ?? null;
    if (!set || found === null) return false;
    const seen = this.studio.viewport.project(set.at(found));
    this.offset = { x: seen.x - pointer.x, y: seen.y - pointer.y };
    this.held = found;
    this.drag = new LayerDrag(
      this.studio,
      "axial",
      { layer: set.layer, handle: set.facts[found]!.name },
      (arrays) => this.follow(arrays),
    );
    this.look();
    return true;
  }

  move(pointer: Pointer): void {
    if (!this.drag) return;
    const { ray } = this.studio.viewport.ray(pointer.x + this.offset.x, pointer.y + this.offset.y);
    const values = [...ray.origin.toArray(), ...ray.direction.toArray()];
    this.drag.move({ ray: values, snap: this.snap !== pointer.ctrl }, {});
  }

  up(): void {
    const { drag } = this;
    this.held = null;
    void drag?.commit().then(() => {
      this.drag = null;
      this.latest.push(null);
    });
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
      this.drag = this.held = null;
      return true;
    }
    if (key !== "n") return false;
    document.querySelector<HTMLElement>(".axial-snap")?.click();
    return true;
  }

  private screen(name: string): { x: number; y: number } | null {
    const index = this.set?.index(name) ?? -1;
    if (!this.set || index < 0) return null;
    const { left, top } = this.studio.viewport.canvas.getBoundingClientRect();
    const { x, y } = this.studio.viewport.project(this.set.at(index));
    return { x: x + left, y: y + top };
  }

  /** Where the active layer has no axis, take the topmost that has. */
  private preferAxial(): void {
    if (this.studio.layer?.axial) return;
    const other = this.studio.scene?.layers.findLast((layer) => layer.axial);
    if (other) this.studio.activeLayer.set(other.name);
  }

  private async load(): Promise<void> {
    const { layer } = this.studio;
    if (this.drag) return;
    const answer = layer?.axial ? await this.studio.ask("axial.get", { layer: layer.name }) : null;
    if (!this.handles || this.drag) return;
    this.set = layer && answer ? new HandleSet(layer.name, answer) : null;
    this.handles.load(this.set?.positions ?? new Float64Array(), new Uint32Array());
    if (answer) this.showLines(answer.arrays);
    else this.ghost?.hide();
    this.look();
  }

  private async add(kind: string): Promise<void> {
    this.adding++;
    const layer = await addAxial(this.studio, kind);
    this.latest.push(null);
    await this.latest.idle();
    if (this.set && this.set.layer === layer) reveal(this.studio, this.set.positions);
    this.adding--;
  }

  private follow(arrays: Record<string, Numbers>): void {
    if (!this.set || !arrays["handles"]) return;
    this.set.follow(arrays);
    this.handles?.replacePositions(this.set.positions);
    this.showLines(arrays);
    this.look();
  }

  private showLines(arrays: Record<string, Numbers>): void {
    this.ghost?.show(arrays["before"] as Float32Array, arrays["after"] as Float32Array, arrays["offsets"]!);
  }

  private look(): void {
    const { set, studio } = this;
    const { palette } = studio;
    const colors = { number: palette.selected, bound: palette.locked, origin: palette.handle, direction: palette.grid };
    const role = (index: number): Role => set?.role(index) ?? "number";
    const hot = (index: number): boolean => index === this.held || (this.held === null && index === this.hovered);
    this.handles?.setColors(
      (index) => (hot(index) ? colors[role(index)].clone().lerp(palette.hovered, 0.45) : colors[role(index)]),
      (index) => SIZES[role(index)] * (hot(index) ? 1.3 : 1),
      palette.lattice,
    );
    this.ghost?.setColors(palette.lattice, palette.grid);
    const shown = set ? set.facts.map((_, index) => index).filter((index) => hot(index) || set.role(index) === "number") : [];
    this.tags?.show(
      shown.map((index) => ({
        at: new Vector3().copy(set!.at(index)),
        text: set!.text(index, tWord("handle_", set!.facts[index]!.name)),
        strong: hot(index),
      })),
    );
    studio.viewport.request();
  }
}

registerMode((studio) => new AxialMode(studio));
