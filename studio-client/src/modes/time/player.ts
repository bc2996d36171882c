// The playhead, and playing: by the clock, with the frames that the server has sent kept, so that a motion that was
// played once plays without it. Moments to come are asked for ahead of the clock, as early as answers take; where the
// server is slower than the clock, frames are left out; the pace is kept.

import { Signal } from "../../core/signal";
import { Latest } from "../../transport/latest";
import type { Frame } from "../../transport/frame";
import type { ClipState } from "../../transport/protocol";
import type { Studio } from "../../studio";
import { boundsOf } from "../../view/mesh_view";
import { ReadAhead } from "./read_ahead";

const ROOM = 256 * 2 ** 20; // bytes of frames that are kept

export class Player {
  /** In seconds, as this page shows it; the session's own follows where scrubbing and playing end. */
  readonly time = new Signal(0);
  readonly playing = new Signal(false);
  /** Frames a second that were shown lately. */
  readonly pace = new Signal(0);
  /** How many frames of the clock were not shown since playing began. */
  readonly leftOut = new Signal(0);
  /** How many frames are kept has changed. */
  readonly kept = new Signal(0);
  private readonly frames = new Map<number, Frame>();
  private readonly latest = new Latest<number>((time) => this.fetch(time));
  private bytes = 0;
  private state = "";
  private near = false; // what is shown is not what the session has told
  private shown: number[] = [];
  private now = -1; // the frame that was shown last while playing
  private start = 0; // and where it began
  private drawn = 0; // frames since then
  private readonly ahead = new ReadAhead(
    (count) => this.moment(count / this.fps),
    (frame) => this.has(frame),
    (frame) => this.frame(frame / this.fps),
    (answer) => this.draw(answer),
  );

  constructor(private readonly studio: Studio) {
    studio.session.scene.onChange(() => this.follow());
  }

  get clip(): ClipState | null {
    return this.studio.scene?.clip ?? null;
  }

  private get fps(): number {
    return this.clip?.fps ?? 24;
  }

  /** Whether a moment plays without the server. */
  has(frame: number): boolean {
    return this.frames.has(frame);
  }

  frameAt(time: number): number {
    return Math.round(time * this.fps);
  }

  /** Show a moment while somebody scrubs; `settle` ends that. */
  scrub(time: number): void {
    this.pause(false);
    this.show(time);
  }

  /** The session's playhead comes to where this page's is: exact points, panels and control points follow. */
  async settle(): Promise<void> {
    this.latest.clear();
    await this.latest.idle();
    const anew = this.near;
    this.near = false;
    await this.studio.ask("time.goto", { time: this.time.value, anew });
  }

  async goto(time: number): Promise<void> {
    this.pause(false);
    this.time.set(Math.min(Math.max(time, 0), this.clip?.duration ?? 0));
    await this.settle();
  }

  step(by: number): Promise<void> {
    return this.goto((this.frameAt(this.time.value) + by) / this.fps);
  }

  toggle(): void {
    if (this.playing.value) this.pause();
    else this.play();
  }

  play(): void {
    const { clip } = this;
    if (!clip || this.playing.value) return;
    const from = this.time.value >= clip.duration - 1e-9 ? 0 : this.time.value;
    this.time.set(from);
    this.playing.set(true);
    this.studio.viewport.helpers.visible = false;
    this.shown = [];
    this.drawn = 0;
    this.leftOut.set(0);
    this.now = -1;
    this.ahead.begin();
    this.start = this.frameAt(from);
    const began = performance.now() - 1000 * from;
    const tick = (): void => {
      if (!this.playing.value) return;
      if (!this.tick((performance.now() - began) / 1000)) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Stop; `settled` unless what stops it goes on to another moment. */
  pause(settled = true): void {
    if (!this.playing.value) return;
    this.playing.set(false);
    this.ahead.end();
    this.pace.set(0);
    this.studio.viewport.helpers.visible = true;
    if (settled) void this.settle();
  }

  /** False where the clip has ended. */
  private tick(elapsed: number): boolean {
    const { clip } = this;
    if (!clip) return false;
    const ended = clip.ending === "once" && elapsed >= clip.duration;
    const frame = this.moment(ended ? clip.duration : elapsed) ?? 0;
    if (frame !== this.now) {
      this.now = frame;
      this.time.set(frame / clip.fps);
      this.near = true;
      const known = this.frames.get(frame);
      if (known) this.draw(known);
    }
    const count = Math.floor(elapsed * clip.fps + 1e-6);
    this.ahead.follow(count, clip.fps);
    this.leftOut.set(Math.max(count - this.start - this.drawn, 0));
    return !ended;
  }

  /** The frame that is shown some seconds after the beginning; null where the clip has ended. */
  private moment(elapsed: number): number | null {
    const { clip } = this;
    if (!clip || (clip.ending === "once" && elapsed > clip.duration + 1e-6)) return null;
    return Math.min(Math.floor(folded(elapsed, clip) * clip.fps + 1e-6), Math.round(clip.duration * clip.fps));
  }

  private show(time: number): void {
    this.time.set(time);
    this.near = true;
    const known = this.frames.get(this.onFrame(time) ?? -1);
    if (known) this.draw(known);
    else this.latest.push(time);
  }

  /** The shape at a moment, as it is sent: kept, or asked for. */
  async frame(time: number): Promise<Frame | null> {
    const known = this.frames.get(this.onFrame(time) ?? -1);
    if (known) return known;
    const { state } = this;
    const answer = await this.studio.ask("time.frame", { time });
    if (!answer || state !== this.state) return null;
    this.keep(time, answer);
    return answer;
  }

  private async fetch(time: number): Promise<void> {
    const answer = await this.frame(time);
    if (answer) this.draw(answer);
  }

  private draw(frame: Frame): void {
    const { head, arrays } = frame;
    this.studio.mesh.move(null, arrays["positions"]!, arrays["normals"]!, boundsOf(head));
    this.count();
  }

  private keep(time: number, frame: Frame): void {
    const at = this.onFrame(time);
    if (at === null || this.frames.has(at) || this.bytes > ROOM) return;
    this.frames.set(at, frame);
    for (const array of Object.values(frame.arrays)) this.bytes += array.byteLength;
    this.kept.set(this.frames.size);
  }

  /** The frame that a time is, if it is one. */
  private onFrame(time: number): number | null {
    const { fps } = this;
    const frame = Math.round(time * fps);
    return Math.abs(frame / fps - time) < 1e-6 ? frame : null;
  }

  private count(): void {
    const now = performance.now();
    this.shown = [...this.shown.filter((when) => now - when < 1000), now];
    this.drawn++;
    if (this.playing.value) this.pace.set(this.shown.length);
  }

  /** Another scene, or an edit: frames that were kept show the one before. */
  private follow(): void {
    const { scene } = this.studio;
    const state = JSON.stringify([scene?.mesh?.id, scene?.revision]);
    if (state !== this.state) {
      this.state = state;
      this.frames.clear();
      this.bytes = 0;
      this.kept.set(0);
    }
    if (!this.clip) this.pause(false);
    if (!this.playing.value && !this.near) this.time.set(this.clip?.time ?? 0);
  }
}

/** A time in the clip's own count: it ends, begins anew, or goes back. */
function folded(time: number, clip: ClipState): number {
  if (clip.ending === "once") return Math.min(time, clip.duration);
  const moment = time % clip.period;
  return moment > clip.duration ? clip.period - moment : moment;
}
