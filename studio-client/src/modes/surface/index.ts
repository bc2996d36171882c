// Surface editing: a region and a handle are picked on the mesh or on its skeleton; the handle is dragged, and the
// surface follows by one of three methods, which can be exchanged while it is dragged.

import { MOUSE, type Box3, type Vector3 } from "three";
import type { Studio } from "../../studio";
import type { Taker } from "../input";
import { SURFACE_KEYS } from "../key_lists";
import { registerMode, type Mode, type Pointer } from "../mode";
import { Chosen } from "./chosen";
import { Convergence } from "./convergence";
import { HandleDrag } from "./handle_drag";
import { MethodSwitch } from "./method_switch";
import { NodePicking } from "./node_picking";
import { SurfacePanel } from "./panel";
import { Picking } from "./picking";
import type { Part } from "./region";
import { SkeletonShow } from "./skeleton_show";
import { METHODS, SurfaceToolbar, type Method } from "./tools";
import { surfaceTour } from "./tour";

export class SurfaceMode implements Mode {
  readonly id = "surface";
  readonly icon = "surface";
  readonly title = "modeSurface";
  readonly hint = "hintSurface";
  readonly shortcut = "4";
  readonly shortcuts = SURFACE_KEYS;
  readonly tour = surfaceTour;
  private readonly tools = new SurfaceToolbar();
  private readonly chosen: Chosen;
  private readonly switching: MethodSwitch;
  private readonly handle: HandleDrag;
  private readonly convergence = new Convergence();
  private readonly skeleton: SkeletonShow;
  private readonly nodes: NodePicking;
  private readonly side: SurfacePanel;
  private picking: Picking | null = null; // while the mode is on
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {
    this.switching = new MethodSwitch(studio, this.tools);
    this.chosen = new Chosen(studio, this.tools, () => this.paint(), () => this.look());
    this.handle = new HandleDrag(studio, this.tools, this.chosen, this.convergence, this.switching, (points) => this.skeleton.follow(points));
    this.switching.onEnd = () => this.switched();
    this.switching.job.onChange(() => this.look());
    this.chosen.waits = () => this.switching.waits;
    this.chosen.busy = () => this.handle.active;
    this.skeleton = new SkeletonShow(studio, this.onSkeleton(), () => this.showGizmos());
    this.nodes = new NodePicking(this.skeleton, this.tools, this.chosen.picked());
    const { chosen } = this;
    this.side = new SurfacePanel(studio, this.tools, this.skeleton, this.convergence, this.switching, {
      grow: (rings) => void chosen.grow(rings),
      clear: () => chosen.clear(),
      keep: (name) => void studio.ask("surface.keep", { name }, { index: chosen.region.indices(this.tools.now.part) }),
      forget: (name) => void studio.ask("surface.forget", { name }),
      recall: (name, part) => void chosen.recall(name, part),
      method: (method) => this.setMethod(method),
      give: () => void chosen.give(),
      back: () => void chosen.load(),
      skeleton: (part) => void this.skeleton.set(part).then(() => this.look()),
      mesh: (shown) => this.showMesh(shown),
    });
    studio.session.on("skeleton", (frame) => {
      this.skeleton.take(frame);
      this.look();
    });
  }

  readonly probe = {
    count: (part: Part) => this.chosen.region.count(part),
    indices: (part: Part) => [...this.chosen.region.indices(part)],
    own: () => this.chosen.own,
    camera: () => [...this.studio.viewport.seeing],
    iterations: () => this.convergence.iterations,
    converged: () => this.convergence.converged,
    energies: () => [...this.convergence.energies],
    pivot: () => this.onPage(this.chosen.pivot),
    joint: () => this.onPage(this.chosen.joint),
    ring: () => this.onPage(this.handle.ring),
    node: (index: number) => this.nodeOnPage(index),
    nodes: () => [...this.skeleton.points],
    groups: () => [...this.skeleton.groups],
  };

  enter(): void {
    const { studio } = this;
    this.picking = new Picking(studio, this.tools, this.chosen.picked());
    this.skeleton.place();
    this.stops = [
      studio.meshLoaded.watch(() => this.begin()),
      studio.activeLayer.onChange(() => void this.chosen.load()),
      studio.session.scene.onChange(() => this.followScene()),
      studio.settings.all.onChange(() => this.look()),
      studio.pointsMoved.onChange(() => this.handle.place()),
      this.tools.state.onChange(() => this.followTools()),
    ];
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.handle.dispose();
    this.picking?.dispose();
    this.picking = null;
    this.turnWith(MOUSE.PAN);
    this.skeleton.close();
    this.studio.mesh.setMarks(null);
    this.showMesh(true);
    this.studio.viewport.canvas.style.cursor = "";
  }

  toolbar(): HTMLElement {
    return this.tools.bar();
  }

  panel(): { title: "modeSurface"; body: HTMLElement } {
    return { title: "modeSurface", body: this.side.element };
  }

  selectionBox(): Box3 | null {
    return this.chosen.box;
  }

  down(pointer: Pointer): boolean {
    const [gizmo] = this.handle.gizmos;
    gizmo?.useCamera();
    if (!this.studio.scene?.mesh?.faces || gizmo?.hot) return false;
    const over = this.skeleton.choice.where === "over";
    if (over && this.nodes.down(pointer, this.studio.mesh.object.visible)) return true;
    return this.tools.picker ? this.picking!.down(pointer) : this.handle.take(pointer);
  }

  move(pointer: Pointer): void {
    if (this.nodes.move(pointer)) return;
    if (this.handle.grabbed) this.handle.pull(pointer);
    else this.picking?.move(pointer);
  }

  up(pointer: Pointer): void {
    if (this.nodes.up()) return;
    if (this.handle.grabbed) this.handle.release();
    else this.picking?.up(pointer);
  }

  hover(pointer: Pointer): void {
    this.picking?.hover(pointer);
  }

  key(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    const axis = "xyz".indexOf(key);
    if (axis >= 0 && this.tools.mover) {
      this.handle.axis = this.handle.axis === axis ? null : (axis as 0 | 1 | 2);
      this.followTools();
    } else if (key === "m") this.setMethod(this.nextMethod());
    else if (key === "k") this.nextPlace();
    else if (key === "+" || key === "=" || key === "-") void this.chosen.grow(key === "-" ? -1 : 1);
    else if (key === "escape") this.escape();
    else return this.tools.key(key);
    return true;
  }

  private begin(): void {
    this.convergence.begin();
    this.chosen.begin();
    this.skeleton.forget();
    void this.skeleton.load();
    void this.chosen.load();
  }

  private followScene(): void {
    if (!this.studio.scene?.mesh) return;
    void this.skeleton.load();
    if (this.chosen.own !== null && this.chosen.layer?.name === this.chosen.own) void this.chosen.load();
    else this.look();
  }

  private nextMethod(): Method {
    const now = METHODS.findIndex(([name]) => name === this.tools.now.method);
    return METHODS[(now + 1) % METHODS.length]![0];
  }

  /** While the handle is held, on this very drag; else the layer's. */
  private setMethod(method: Method): void {
    if (method === this.tools.now.method) return;
    this.tools.change({ method });
    this.convergence.begin();
    if (method === "skeleton") this.skeleton.prepare();
    if (this.handle.active) this.handle.send();
    else if (this.chosen.own !== null) void this.switching.exchange(this.chosen.own, method);
    else this.look();
  }

  /** Another method is there, or given up: the drag asks again, or the layer tells which it has. */
  private switched(): void {
    if (this.handle.active) this.handle.send();
    else if (this.picking && this.chosen.own !== null) void this.chosen.load();
  }

  private nextPlace(): void {
    const next = { off: "over", over: "beside", beside: "off" } as const;
    void this.skeleton.set({ where: next[this.skeleton.choice.where] }).then(() => this.look());
  }

  private escape(): void {
    if (this.handle.active) this.handle.cancel();
    else if (!this.nodes.cancel() && !this.picking?.cancel()) this.chosen.clear();
    this.look();
  }

  private onSkeleton(): Taker {
    return {
      down: (pointer) => {
        const gizmo = this.handle.gizmos[1];
        gizmo?.useCamera();
        return !gizmo?.hot && this.nodes.down(pointer, false);
      },
      move: (pointer) => void this.nodes.move(pointer),
      up: () => void this.nodes.up(),
    };
  }

  /** One in the main view, and one beside the skeleton. */
  private showGizmos(): void {
    this.handle.showIn([this.studio.viewport, this.skeleton.side?.viewport].filter((view) => view !== undefined));
    this.followTools();
  }

  private followTools(): void {
    const { mover } = this.tools;
    this.handle.followTools();
    this.turnWith(mover ? MOUSE.PAN : MOUSE.ROTATE);
    this.studio.viewport.canvas.style.cursor = mover ? "" : "crosshair";
    if (this.tools.picker === "geodesic" && this.studio.scene?.mesh?.faces) void this.studio.ask("surface.measure");
    this.look();
  }

  /** What the right button does: while the left one picks, it turns the view. */
  private turnWith(action: MOUSE): void {
    for (const view of [this.studio.viewport, this.skeleton.side?.viewport]) {
      if (view) view.cameras.controls.mouseButtons.RIGHT = action;
    }
  }

  private showMesh(shown: boolean): void {
    this.studio.mesh.object.visible = shown;
    this.studio.viewport.request();
    this.look();
  }

  private paint(): void {
    if (!this.picking) return;
    this.studio.mesh.setMarks(this.chosen.region.marks);
    this.skeleton.paint(this.chosen.region.marks);
    this.side.count(this.chosen.region);
  }

  /** Colours, gizmo and panel follow what is picked. */
  private look(): void {
    if (!this.picking) return;
    this.paint();
    this.handle.place();
    if (this.chosen.own === null && !this.handle.active) this.convergence.begin();
    const other = this.chosen.own === null ? (this.chosen.layer?.name ?? null) : null;
    const { own, unseen, region } = this.chosen;
    this.side.show(region, { own, other, unseen: unseen !== null, torn: own === null && this.chosen.torn });
    this.studio.viewport.request();
  }

  private onPage(at: Vector3 | null): { x: number; y: number } | null {
    if (!at) return null;
    const box = this.studio.viewport.canvas.getBoundingClientRect();
    const { x, y } = this.studio.viewport.project(at);
    return { x: x + box.left, y: y + box.top };
  }

  private nodeOnPage(index: number): { x: number; y: number } | null {
    const place = this.skeleton.seen()[index];
    const box = this.skeleton.viewport?.canvas.getBoundingClientRect();
    return place && box ? { x: place.x + box.left, y: place.y + box.top } : null;
  }
}

registerMode((studio) => new SurfaceMode(studio));
