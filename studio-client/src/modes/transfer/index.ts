// Deformation transfer: a source and its poses on the left, the scene's shape on the right; markers are clicked in
// pairs, one on each, in whichever order.

import { Vector3 } from "three";
import { pickFiles, save, upload } from "../../core/files";
import { h } from "../../core/dom";
import { t } from "../../core/strings";
import { handOver } from "../../panels/export_dialog";
import type { Studio } from "../../studio";
import type { Numbers } from "../../transport/frame";
import { onClick } from "../../view/clicks";
import { MeshView } from "../../view/mesh_view";
import { SideView } from "../../view/side_view";
import { TRANSFER_KEYS } from "../key_lists";
import { registerMode, type Mode, type Pointer } from "../mode";
import { MarkerPast } from "./marker_past";
import { TransferPanel, type Keys } from "./panel";
import { Player } from "./player";
import { ShapeView } from "./shape_view";
import { NOTHING, type TransferState } from "./state";
import { transferTour } from "./tour";

class TransferMode implements Mode {
  readonly id = "transfer";
  readonly icon = "transfer";
  readonly title = "modeTransfer";
  readonly hint = "hintTransfer";
  readonly shortcut = "8";
  readonly shortcuts = TRANSFER_KEYS;
  readonly tour = transferTour;
  private state: TransferState = NOTHING;
  private keys: Keys | null = null;
  private pending: { source: number | null; target: number | null } = { source: null, target: null };
  private lit: number | null = null;
  private shown: string | null = null;
  private side: SideView | null = null;
  private source: ShapeView | null = null;
  private target: ShapeView | null = null;
  private readonly player: Player;
  private readonly past: MarkerPast;
  private readonly inspector: TransferPanel;
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {
    this.past = new MarkerPast(studio);
    this.player = new Player(
      studio,
      (arrays) => this.moveSource(arrays),
      (weights) => this.inspector.follow(weights),
    );
    this.inspector = new TransferPanel({
      load: () => this.send("transfer.source"),
      poses: () => this.send("transfer.poses"),
      example: () => void studio.ask("transfer.example"),
      dropPose: (name) => void studio.ask("transfer.drop_pose", { name }),
      unmark: (index) => void studio.ask("transfer.unmark", { index: index ?? -1 }),
      light: (index) => this.light(index),
      saveMarkers: () => save(new Blob([JSON.stringify({ markers: this.state.markers })]), `${this.state.name ?? ""}-markers.json`),
      loadMarkers: () => this.loadMarkers(),
      compute: () => void studio.ask("transfer.compute"),
      weight: (index, value, done) => void this.weigh(index, value, done),
      only: (index) => void this.only(index),
      play: () => void this.toggle(),
      exportPoses: () => void this.exportPoses(),
    });
    studio.session.on("transfer", ({ head }) => void this.take(head["state"] as TransferState));
  }

  readonly probe = {
    state: () => this.state,
    pending: () => this.pending,
    weights: () => this.player.weights,
    playing: () => this.player.playing,
    sourceVertex: (vertex: number) => this.source?.onPage(vertex) ?? null,
    targetVertex: (vertex: number) => this.target?.onPage(vertex) ?? null,
    sourcePosition: (vertex: number) => [...(this.source?.mesh.positions.slice(3 * vertex, 3 * vertex + 3) ?? [])],
    sourcePixels: (x: number, y: number) => {
      const box = this.side!.viewport.canvas.getBoundingClientRect();
      return this.side!.viewport.read(x - box.left, y - box.top, 1, 1);
    },
    lookAtSource: (x: number, y: number, z: number) => this.frameSource(new Vector3(x, y, z)),
  };

  enter(): void {
    const { studio } = this;
    const hover = ({ x, y }: Pointer): void => this.light(this.source?.marker(x, y) ?? null);
    this.side = new SideView(studio, t("sourceShape"), { hover }, "left");
    const mesh = new MeshView(() => this.side?.viewport.request());
    this.side.viewport.shape.add(mesh.object);
    this.source = new ShapeView(this.side.viewport, mesh);
    this.target = new ShapeView(studio.viewport, studio.mesh);
    this.stops = [
      onClick(this.side.viewport, (x, y) => this.click("source", x, y)),
      onClick(studio.viewport, (x, y) => this.click("target", x, y)),
      studio.session.scene.onChange(() => void this.loadKeys()),
      studio.activeLayer.onChange(() => void this.loadKeys()),
      studio.meshLoaded.onChange(() => void this.load()),
      studio.pointsMoved.onChange(() => this.target?.follow()),
      studio.settings.all.watch((settings) => {
        mesh.apply(settings, studio.palette);
        this.look();
      }),
    ];
    void this.load();
  }

  leave(): void {
    void this.player.stop();
    for (const stop of this.stops) stop();
    this.source?.dispose();
    this.target?.dispose();
    this.side?.close();
    this.side = this.source = this.target = null;
    this.shown = null;
  }

  hover({ x, y }: Pointer): void {
    this.light(this.target?.marker(x, y) ?? null);
  }

  panel(): { title: "modeTransfer"; body: HTMLElement } {
    return { title: "modeTransfer", body: this.inspector.element };
  }

  undo(): boolean {
    return this.past.undo();
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === "Escape" && this.player.moving) {
      void this.player.cancel().then(() => this.loadKeys());
      return true;
    }
    if (event.key === "Escape" && (this.pending.source !== null || this.pending.target !== null)) {
      this.pending = { source: null, target: null };
      this.look();
      return true;
    }
    if (event.key === " " && this.keys) void this.toggle();
    else return false;
    return true;
  }

  private async load(): Promise<void> {
    const answer = await this.studio.ask("transfer.state");
    if (answer) await this.take(answer.head["state"] as TransferState);
    await this.loadKeys();
  }

  private async take(state: TransferState): Promise<void> {
    const known = `${state.name}/${state.points}`;
    this.past.follow(state);
    this.state = state;
    if (this.side && state.name === null) this.source?.mesh.clear();
    if (this.side && state.name !== null && this.shown !== known) {
      this.shown = known;
      await this.loadSource();
      await this.loadKeys();
    } else if (state.name === null) this.shown = null;
    this.look();
  }

  private async loadSource(): Promise<void> {
    const answer = await this.studio.ask("transfer.mesh");
    if (!answer || !this.source || !this.side) return;
    const { arrays } = answer;
    const positions = arrays["positions"] as Float32Array;
    this.source.mesh.load({
      count: positions.length / 3,
      positions,
      normals: arrays["normals"] as Int8Array,
      triangles: arrays["triangles"] as Uint32Array,
      twins: new Uint32Array(),
      uvs: null,
      parts: [],
      materials: [],
    });
    this.source.mesh.apply(this.studio.settings.now, this.studio.palette);
    this.pending = { source: null, target: null };
    requestAnimationFrame(() => this.frameSource());
  }

  private frameSource(from?: Vector3): void {
    const { cameras } = this.studio.viewport;
    const direction = from ?? cameras.active.position.clone().sub(cameras.target);
    if (this.side && this.source) this.side.viewport.frame(this.source.mesh.box, direction);
  }

  /** The poses of the active layer, or of the one that came out last. */
  private async loadKeys(): Promise<void> {
    const layers = (this.studio.scene?.layers ?? []).filter((layer) => layer.kind === "shape-keys");
    const names = [this.studio.activeLayer.value, this.state.layer];
    const layer = names.find((name) => layers.some((each) => each.name === name)) ?? layers.at(-1)?.name;
    const answer = layer === undefined ? null : await this.studio.ask("transfer.keys", { layer });
    this.keys = answer && { layer: layer!, names: answer.head["names"] as string[], weights: answer.head["weights"] as number[] };
    if (this.keys && !this.player.playing) {
      this.player.weights = [...this.keys.weights];
      this.moveSource(answer!.arrays);
    }
    this.look();
  }

  private click(which: "source" | "target", x: number, y: number): void {
    const view = this[which];
    if (!view || this.state.name === null) return;
    const vertex = view.pick(x, y);
    if (vertex === null) return;
    this.pending = { ...this.pending, [which]: vertex };
    const { source, target } = this.pending;
    if (source !== null && target !== null) {
      this.pending = { source: null, target: null };
      void this.studio.ask("transfer.mark", { source, target });
    }
    this.look();
  }

  private light(index: number | null): void {
    if (index === this.lit) return;
    this.lit = index;
    this.look(false);
  }

  private send(command: string): void {
    pickFiles((files) => void this.deliver(command, files));
  }

  private async deliver(command: string, files: File[]): Promise<void> {
    const name = await upload(this.studio, files, () => undefined);
    if (name !== null) await this.studio.ask(command, { upload: name });
  }

  private loadMarkers(): void {
    pickFiles((files) => {
      void Promise.all(files.map((file) => file.text())).then((texts) => this.studio.ask("transfer.load", { texts }));
    });
  }

  private async weigh(index: number, value: number, done: boolean): Promise<void> {
    if (!this.keys) return;
    this.player.playing = false;
    this.player.put(
      this.keys.layer,
      this.player.weights.map((old, i) => (i === index ? value : old)),
    );
    if (done) await this.player.stop();
  }

  private async only(index: number): Promise<void> {
    if (!this.keys) return;
    this.player.playing = false;
    this.player.put(
      this.keys.layer,
      this.keys.names.map((_, i) => (i === index ? 1 : 0)),
    );
    await this.player.stop();
  }

  private async toggle(): Promise<void> {
    if (!this.keys) return;
    if (this.player.playing) await this.player.stop();
    else this.player.play(this.keys.layer, this.keys.names.length);
    this.look();
  }

  private moveSource(arrays: Record<string, Numbers>): void {
    if (!arrays["source"] || !this.source || arrays["source"].length !== 3 * this.source.mesh.pointCount) return;
    this.source.mesh.move(null, arrays["source"], arrays["source_normals"]!);
    this.source.follow();
  }

  private async exportPoses(): Promise<void> {
    if (!this.keys) return;
    const answer = await this.studio.ask("transfer.export", { layer: this.keys.layer, suffix: ".obj" });
    const report = h("div");
    if (answer) handOver(answer, report);
    if (answer) this.studio.toasts.info(report.textContent);
  }

  /** Markers in both views, and the panel. */
  private look(panel = true): void {
    if (!this.side) return;
    this.side.setTitle(this.state.name === null ? t("sourceShape") : `${t("sourceShape")}: ${this.state.name}`);
    const markers = this.player.playing ? [] : this.state.markers; // nothing stands before what plays
    const fits = (which: 0 | 1, count: number): number[] => markers.map((pair) => pair[which]).filter((vertex) => vertex < count);
    this.source?.show(this.source.mesh.pointCount ? fits(0, this.source.mesh.pointCount) : [], this.pending.source, this.lit);
    this.target?.show(fits(1, this.studio.mesh.pointCount), this.pending.target, this.lit);
    if (panel) this.inspector.show(this.state, this.keys, this.player.playing);
  }
}

registerMode((studio) => new TransferMode(studio));
