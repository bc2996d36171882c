// Surface editing: a region and a handle are picked on the mesh or on its skeleton; the handle is dragged, and the
// surface follows by one of three methods, which can be exchanged while it is dragged.

import { Box3, Matrix4, MOUSE, Plane, Vector3 } from "three";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import type { Numbers } from "../../transport/frame";
import { Gizmo } from "../../view/gizmo";
import { IN_HANDLE } from "../../view/marks";
import { LayerDrag } from "../layer_drag";
import { registerMode, type Mode, type Pointer } from "../mode";
import { Convergence } from "./convergence";
import { NodePicking } from "./node_picking";
import { SurfacePanel } from "./panel";
import { Picking, type Picked } from "./picking";
import { Region, type Merge, type Part } from "./region";
import { SkeletonShow } from "./skeleton_show";
import { METHODS, SurfaceToolbar, type Method } from "./tools";
import { surfaceTour } from "./tour";

const KINDS = ["laplacian-edit", "arap", "skeleton-edit"];

export class SurfaceMode implements Mode {
  readonly id = "surface";
  readonly icon = "surface";
  readonly title = "modeSurface";
  readonly hint = "hintSurface";
  readonly shortcut = "4";
  readonly tools = new SurfaceToolbar();
  private region: Region | null = null;
  /** The layer whose region this is; null where nobody has it yet. */
  private own: string | null = null;
  private asked: string | null = null;
  private readonly convergence = new Convergence();
  private readonly skeleton: SkeletonShow;
  private readonly nodes: NodePicking;
  private readonly side: SurfacePanel;
  private picking: Picking | null = null;
  private gizmos: Gizmo[] = [];
  private drag: LayerDrag | null = null;
  private matrix: Float64Array | null = null;
  private grab: { plane: Plane; at: Vector3 } | null = null;
  private axis: 0 | 1 | 2 | null = null;
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {
    const picked = this.picked();
    this.skeleton = new SkeletonShow(studio, this.onSkeleton(), () => this.makeGizmos());
    this.nodes = new NodePicking(this.skeleton, this.tools, picked);
    this.picking = null;
    this.side = new SurfacePanel(studio, this.tools, this.skeleton, this.convergence, {
      grow: (rings) => void this.grow(rings),
      clear: () => this.clear(),
      keep: (name) => void studio.ask("surface.keep", { name }, { index: this.region?.indices(this.tools.now.part) ?? new Uint32Array() }),
      forget: (name) => void studio.ask("surface.forget", { name }),
      recall: (name, part) => void this.recall(name, part),
      method: (method) => this.setMethod(method),
      give: () => void this.give(),
      back: () => void this.load(),
      skeleton: (part) => void this.skeleton.set(part).then(() => this.look()),
      mesh: (shown) => this.showMesh(shown),
    });
    studio.session.on("skeleton", (frame) => {
      this.skeleton.take(frame);
      this.look();
    });
  }

  enter(): void {
    const { studio } = this;
    this.picking = new Picking(studio, this.tools, this.picked());
    this.stops = [
      studio.meshLoaded.watch(() => this.begin()),
      studio.activeLayer.onChange(() => void this.load()),
      studio.session.scene.onChange(() => this.followScene()),
      studio.settings.all.onChange(() => this.look()),
      studio.pointsMoved.onChange(() => this.placeGizmos()),
      this.tools.state.onChange(() => this.followTools()),
    ];
    this.skeleton.place();
    this.makeGizmos();
    void this.skeleton.load();
    void this.load();
  }

  leave(): void {
    for (const stop of this.stops) stop();
    this.cancel();
    this.picking?.dispose();
    this.picking = null;
    this.skeleton.close();
    for (const gizmo of this.gizmos) gizmo.dispose();
    this.gizmos = [];
    this.studio.mesh.setMarks(null);
    this.showMesh(true);
    this.turnWith(MOUSE.PAN);
    this.studio.viewport.canvas.style.cursor = "";
  }

  toolbar(): HTMLElement {
    return this.tools.bar();
  }

  panel(): { title: "modeSurface"; body: HTMLElement } {
    return { title: "modeSurface", body: this.side.element };
  }

  readonly tour = surfaceTour;

  selectionBox(): Box3 | null {
    const chosen = this.region?.indices("region") ?? [];
    const box = new Box3();
    for (const i of chosen) box.expandByPoint(this.at(i));
    return box.isEmpty() ? null : box;
  }

  readonly probe = {
    count: (part: Part) => this.region?.count(part) ?? 0,
    indices: (part: Part) => [...(this.region?.indices(part) ?? [])],
    own: () => this.own,
    camera: () => [...this.studio.viewport.seeing],
    iterations: () => this.convergence.iterations,
    converged: () => this.convergence.converged,
    energies: () => [...this.convergence.energies],
    pivot: () => this.onPage(this.pivot()),
    node: (index: number) => this.nodeOnPage(index),
    nodes: () => [...this.skeleton.points],
    groups: () => [...this.skeleton.groups],
  };

  down(pointer: Pointer): boolean {
    const [gizmo] = this.gizmos;
    gizmo?.useCamera();
    if (gizmo?.hot) return false;
    const over = this.skeleton.choice.where === "over";
    if (over && this.nodes.down(pointer, this.studio.mesh.object.visible)) return true;
    if (this.tools.picker) return this.picking!.down(pointer);
    return this.take(pointer);
  }

  move(pointer: Pointer): void {
    if (this.nodes.move(pointer)) return;
    if (this.grab) this.pull(pointer);
    else this.picking?.move(pointer);
  }

  up(pointer: Pointer): void {
    if (this.nodes.up()) return;
    if (this.grab) {
      this.grab = null;
      void this.finish();
    } else this.picking?.up(pointer);
  }

  hover(pointer: Pointer): void {
    this.picking?.hover(pointer);
  }

  key(event: KeyboardEvent): boolean {
    const key = event.key.toLowerCase();
    const axis = "xyz".indexOf(key);
    if (axis >= 0 && this.tools.mover) {
      this.axis = this.axis === axis ? null : (axis as 0 | 1 | 2);
      this.followTools();
    } else if (key === "m") {
      const now = METHODS.findIndex(([name]) => name === this.tools.now.method);
      this.setMethod(METHODS[(now + 1) % METHODS.length]![0]);
    } else if (key === "k") {
      const next = { off: "over", over: "beside", beside: "off" } as const;
      void this.skeleton.set({ where: next[this.skeleton.choice.where] }).then(() => this.look());
    } else if (key === "+" || key === "=" || key === "-") void this.grow(key === "-" ? -1 : 1);
    else if (key === "escape") this.escape();
    else return this.tools.key(key);
    return true;
  }

  private get layer(): Layer | null {
    const { layer } = this.studio;
    return layer && KINDS.includes(layer.kind) ? layer : null;
  }

  /** Another shape: nothing is picked. */
  private begin(): void {
    const count = this.studio.mesh.pointCount;
    if (this.region?.marks.length !== count) {
      this.region = new Region(count);
      this.own = null;
    }
    this.skeleton.forget();
    void this.skeleton.load();
    void this.load();
  }

  /** What the active layer is made of, if it edits the surface. */
  private async load(): Promise<void> {
    const { layer } = this;
    this.asked = layer?.name ?? null;
    if (!layer || this.drag) {
      if (!layer) this.own = null;
      this.look();
      return;
    }
    const answer = await this.studio.ask("surface.region", { layer: layer.name });
    if (!answer || this.asked !== layer.name || this.drag) return;
    const count = this.studio.mesh.pointCount;
    this.region = Region.of(count, answer.arrays["region"] as Uint32Array, answer.arrays["handle"] as Uint32Array);
    this.own = layer.name;
    this.tools.change({ method: answer.head["method"] as Method });
    this.look();
  }

  private followScene(): void {
    if (!this.studio.scene?.mesh) return;
    void this.skeleton.load();
    if (this.own !== null && this.layer?.name === this.own) void this.load();
    else this.look();
  }

  private picked(): Picked {
    let before = new Uint8Array();
    let how: Merge = "only";
    const { tools } = this;
    return {
      begin: (wanted) => {
        how = wanted;
        before = this.region?.marks.slice() ?? before;
      },
      show: (indices) => {
        if (!this.region || before.length !== this.region.marks.length) return;
        this.region.marks.set(before);
        this.region.take(tools.now.part, indices, how);
        this.paint();
      },
      more: (indices) => {
        this.region?.take(tools.now.part, indices, how);
        this.paint();
      },
      end: () => this.changed(),
    };
  }

  /** What is picked is another thing now, and no layer's. */
  private changed(): void {
    this.own = null;
    this.look();
  }

  private async grow(rings: number): Promise<void> {
    const { part } = this.tools.now;
    const index = this.region?.indices(part);
    if (!index?.length) return;
    const answer = await this.studio.ask("surface.grow", { rings }, { index });
    if (!answer || !this.region) return;
    this.region.take(part, answer.arrays["index"] as Uint32Array, "only");
    this.changed();
  }

  private async recall(name: string, part: Part): Promise<void> {
    const answer = await this.studio.ask("surface.part", { part: name });
    if (!answer || !this.region) return;
    this.region.take(part, answer.arrays["index"] as Uint32Array, "only");
    this.changed();
  }

  private clear(): void {
    this.region?.clear("handle");
    if (this.tools.now.part === "region") this.region?.clear("region");
    this.changed();
  }

  private async give(): Promise<void> {
    const { layer, region } = this;
    if (!layer || !region) return;
    const arrays = { region: region.indices("region"), handle: region.indices("handle") };
    if (await this.studio.ask("surface.restructure", { layer: layer.name }, arrays)) await this.load();
  }

  private setMethod(method: Method): void {
    if (method === this.tools.now.method) return;
    this.tools.change({ method });
    this.convergence.begin();
    if (this.drag) this.send();
    else if (this.own !== null) void this.studio.ask("surface.method", { layer: this.own, method });
  }

  /** The pointer takes hold of the handle itself, to move it in the plane of the view. */
  private take(pointer: Pointer): boolean {
    const { mesh, viewport } = this.studio;
    const hit = mesh.object.visible && viewport.ray(pointer.x, pointer.y).intersectObject(mesh.target, false)[0];
    if (!hit || !hit.face || this.tools.mover !== "translate") return false;
    const { a, b, c } = hit.face;
    if (![a, b, c].some((vertex) => this.region!.marks[mesh.pointOf(vertex)]! & IN_HANDLE)) return false;
    const plane = new Plane().setFromNormalAndCoplanarPoint(viewport.cameras.direction(), hit.point);
    this.grab = { plane, at: hit.point };
    this.hold();
    return true;
  }

  private pull(pointer: Pointer): void {
    const { plane, at } = this.grab!;
    const to = this.studio.viewport.ray(pointer.x, pointer.y).ray.intersectPlane(plane, new Vector3());
    if (!to) return;
    const by = to.sub(at);
    if (this.axis !== null) by.set(...([0, 1, 2].map((i) => (i === this.axis ? by.getComponent(i) : 0)) as [number, number, number]));
    this.put(new Matrix4().makeTranslation(by));
  }

  private hold(): void {
    const { region, tools } = this;
    if (!region) return;
    this.convergence.begin();
    this.matrix = null;
    const structure = { region: region.indices("region"), handle: region.indices("handle") };
    this.drag = new LayerDrag(
      this.studio,
      "surface",
      { layer: this.own ?? "", method: tools.now.method },
      (arrays) => this.answered(arrays),
      this.own === null ? structure : {},
    );
  }

  private put(matrix: Matrix4): void {
    this.matrix = new Float64Array(matrix.elements);
    this.send();
  }

  private send(): void {
    const { method } = this.tools.now;
    this.drag?.move({ method }, this.matrix ? { matrix: this.matrix } : {});
  }

  /** What an answer says beside the points; where an iteration has not converged, it goes on. */
  private answered(arrays: Record<string, Numbers>): void {
    if (arrays["skeleton"]) this.skeleton.follow(arrays["skeleton"]);
    if (!arrays["energies"]) return;
    const converged = arrays["converged"]![0] === 1;
    this.convergence.add(arrays["energies"], converged);
    if (!converged && this.drag && this.matrix) this.send();
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.drag = null; // an iteration goes no further: the server finishes it
    if (!drag) return;
    const layer = (await drag.begun)?.head["layer"] as string | undefined;
    await drag.commit();
    if (layer !== undefined) this.own = layer;
    if (layer !== undefined) this.studio.activeLayer.set(layer);
    await this.load();
  }

  private cancel(): void {
    void this.drag?.cancel();
    this.drag = this.grab = null;
    for (const gizmo of this.gizmos) gizmo.cancel();
  }

  private escape(): void {
    if (this.drag) this.cancel();
    else if (!this.picking?.cancel()) this.clear();
    this.look();
  }

  private onSkeleton(): { down: (pointer: Pointer) => boolean; move: (pointer: Pointer) => void; up: () => void } {
    return {
      down: (pointer) => {
        const gizmo = this.gizmos[1];
        gizmo?.useCamera();
        return !gizmo?.hot && this.nodes.down(pointer, false);
      },
      move: (pointer) => void this.nodes.move(pointer),
      up: () => void this.nodes.up(),
    };
  }

  /** One in the main view, and one beside the skeleton. */
  private makeGizmos(): void {
    for (const gizmo of this.gizmos) gizmo.dispose();
    const views = [this.studio.viewport, this.skeleton.side?.viewport].filter((view) => view !== undefined);
    this.gizmos = views.map((view) => {
      const gizmo = new Gizmo(view);
      gizmo.onBegin = () => this.hold();
      gizmo.onMove = (matrix) => this.put(matrix);
      gizmo.onEnd = () => void this.finish();
      return gizmo;
    });
    this.followTools();
  }

  private followTools(): void {
    const { mover } = this.tools;
    for (const gizmo of this.gizmos) {
      if (mover) gizmo.setTool(mover);
      gizmo.setAxis(this.axis);
    }
    this.turnWith(mover ? MOUSE.PAN : MOUSE.ROTATE);
    this.studio.viewport.canvas.style.cursor = mover ? "" : "crosshair";
    this.look();
  }

  /** What the right button does: while the left one picks, it turns the view. */
  private turnWith(action: MOUSE): void {
    for (const view of [this.studio.viewport, this.skeleton.side?.viewport]) {
      if (view) view.cameras.controls.mouseButtons.RIGHT = action;
    }
  }

  private placeGizmos(): void {
    const at = this.tools.mover ? this.pivot() : null;
    for (const gizmo of this.gizmos) {
      gizmo.useCamera();
      gizmo.place(at);
    }
  }

  private pivot(): Vector3 | null {
    const chosen = this.region?.indices("handle");
    if (!chosen?.length) return null;
    const sum = new Vector3();
    for (const i of chosen) sum.add(this.at(i));
    return sum.divideScalar(chosen.length);
  }

  private at(vertex: number): Vector3 {
    return new Vector3().fromArray(this.studio.mesh.positions, 3 * vertex);
  }

  private showMesh(shown: boolean): void {
    this.studio.mesh.object.visible = shown;
    this.studio.viewport.request();
    this.look();
  }

  private paint(): void {
    if (!this.picking) return;
    this.studio.mesh.setMarks(this.region?.marks ?? null);
    this.skeleton.paint(this.region?.marks);
  }

  /** Colours, gizmo and panel follow what is picked. */
  private look(): void {
    if (!this.picking) return; // the mode is off
    this.paint();
    this.placeGizmos();
    const other = this.own === null ? (this.layer?.name ?? null) : null;
    this.side.show(this.region, this.own, other);
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
