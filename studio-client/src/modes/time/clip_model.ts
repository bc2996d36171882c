// What the parts of the timeline share: the player, the keys that are selected, the stretch of time on view, and what
// can be done with keys.

import { Signal } from "../../core/signal";
import type { Studio } from "../../studio";
import type { ClipKey, ClipState, TrackState } from "../../transport/protocol";
import { LayerDrag } from "../layer_drag";
import { Player } from "./player";
import { KeySelection, type KeyName } from "./selection";
import { Span } from "./span";

export type Easing = ClipKey["easing"];

export class ClipModel {
  readonly player: Player;
  readonly selection = new KeySelection();
  readonly span = new Span();
  /** The span has changed, or tracks are previewed. */
  readonly redraw = new Signal(0);
  /** Whether keys are set on whole frames. */
  snap = true;
  private previewed: TrackState[] | null = null;
  private drag: LayerDrag | null = null;
  private length = 0;

  constructor(readonly studio: Studio) {
    this.player = new Player(studio);
    studio.session.scene.watch((scene) => {
      this.previewed = null;
      if (scene?.clip && scene.clip.duration !== this.length) {
        this.length = scene.clip.duration;
        this.span.fit(this.length);
      }
      this.selection.prune(scene?.clip ?? null);
      this.touch();
    });
  }

  get clip(): ClipState | null {
    return this.studio.scene?.clip ?? null;
  }

  /** The tracks as they are, or as a drag would leave them. */
  get tracks(): TrackState[] {
    return this.previewed ?? this.clip?.tracks ?? [];
  }

  touch(): void {
    this.redraw.set(this.redraw.value + 1);
  }

  /** A time on a whole frame, where that is wanted. */
  snapped(time: number, free = false): number {
    const { fps, duration } = this.clip ?? { fps: 24, duration: 1 };
    const kept = Math.min(Math.max(time, 0), duration);
    return free || !this.snap ? kept : Math.min(Math.round(kept * fps) / fps, duration);
  }

  async setKey(layer: string, fields: string[], time = this.player.time.value): Promise<void> {
    if (time !== this.clip?.time) await this.player.goto(time);
    const answer = await this.studio.ask("time.key", { layer, fields, time });
    if (answer) this.selection.choose(fields.map((field) => [layer, field, time]));
  }

  async removeSelected(): Promise<void> {
    if (this.selection.size) await this.studio.ask("time.remove", { keys: this.selection.list });
  }

  async double(): Promise<void> {
    const { list } = this.selection;
    if (!list.length) return;
    const first = Math.min(...list.map(([, , time]) => time));
    const by = this.player.time.value - first;
    const answer = await this.studio.ask("time.double", { keys: list, time: this.player.time.value });
    if (answer) this.selectMoved(list, by);
  }

  ease(easing: Easing): void {
    if (this.selection.size) void this.studio.ask("time.ease", { keys: this.selection.list, easing });
  }

  /** Move the playhead to the nearest key before or after it. */
  toKey(direction: 1 | -1): void {
    const now = this.player.time.value;
    const times = this.tracks.flatMap((track) => track.keys.map((key) => key.time));
    const beyond = times.filter((time) => (direction > 0 ? time > now + 1e-9 : time < now - 1e-9));
    if (beyond.length) void this.player.goto(direction > 0 ? Math.min(...beyond) : Math.max(...beyond));
  }

  /** Take hold of the selected keys. */
  beginDrag(): void {
    this.drag = new LayerDrag(this.studio, "keys", { keys: this.selection.list }, (_, head) => {
      this.previewed = head["tracks"] as TrackState[];
      this.touch();
    });
  }

  moveDrag(values: Record<string, unknown>): void {
    this.drag?.move(values, {});
  }

  /** Keep what the drag did; the keys that it moved stay selected. */
  async endDrag(by: number): Promise<void> {
    const { drag, selection } = this;
    const names = selection.list;
    this.drag = null;
    await drag?.commit();
    if (by) this.selectMoved(names, Math.max(by, -Math.min(...names.map(([, , time]) => time))));
  }

  async cancelDrag(): Promise<void> {
    const { drag } = this;
    this.drag = this.previewed = null;
    await drag?.cancel();
    this.touch();
  }

  private selectMoved(names: KeyName[], by: number): void {
    const near = (track: TrackState, [layer, field, time]: KeyName): KeyName[] =>
      track.layer === layer && track.field === field
        ? track.keys.filter((key) => Math.abs(key.time - time - by) < 1e-6).map((key) => [layer, field, key.time])
        : [];
    this.selection.choose((this.clip?.tracks ?? []).flatMap((track) => names.flatMap((name) => near(track, name))));
  }
}
