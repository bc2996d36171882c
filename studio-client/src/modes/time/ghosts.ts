// Onion skin: which other moments are shown, and when.

import { Signal } from "../../core/signal";
import { Latest } from "../../transport/latest";
import type { Frame } from "../../transport/frame";
import { Onion, type Ghost } from "../../view/onion";
import { widened } from "../layer_drag";
import type { ClipModel } from "./clip_model";

export interface OnionChoice {
  on: boolean;
  /** How many before the playhead, and as many after it. */
  count: number;
  /** Frames from one to the next; 0 = at the keys. */
  every: number;
}

const STRONGEST = 0.27;

export class Ghosts {
  readonly choice = new Signal<OnionChoice>({ on: false, count: 2, every: 4 });
  private readonly onion: Onion;
  private readonly latest = new Latest<number>(() => this.load());
  private active = false;

  constructor(private readonly model: ClipModel) {
    this.onion = new Onion(model.studio.mesh);
    this.choice.onChange(() => this.refresh());
    model.redraw.onChange(() => this.refresh());
    model.player.playing.onChange(() => this.refresh());
  }

  get count(): number {
    return this.onion.count;
  }

  change(part: Partial<OnionChoice>): void {
    this.choice.set({ ...this.choice.value, ...part });
  }

  start(): void {
    this.active = true;
    this.model.studio.viewport.helpers.add(this.onion.object);
    this.refresh();
  }

  stop(): void {
    this.active = false;
    this.model.studio.viewport.helpers.remove(this.onion.object);
    this.onion.clear();
  }

  private refresh(): void {
    if (!this.active) return;
    if (this.choice.value.on && this.model.clip && !this.model.player.playing.value) this.latest.push(0);
    else if (this.onion.count) {
      this.onion.clear();
      this.model.studio.viewport.request();
    }
  }

  private async load(): Promise<void> {
    const { player, studio } = this.model;
    const now = player.time.value;
    const moments = this.moments(now).sort((a, b) => Math.abs(a - now) - Math.abs(b - now));
    const frames = await Promise.all(moments.map((time) => player.frame(time)));
    if (!this.active || !this.choice.value.on) return;
    const ranks = { before: 0, after: 0 };
    const ghosts = moments.flatMap((time, i): Ghost[] => {
      const side = time < now ? "before" : "after";
      const frame = frames[i];
      const opacity = STRONGEST * 0.66 ** ranks[side]++;
      return frame ? [ghost(frame, time < now ? studio.palette.grid : studio.palette.handle, opacity)] : [];
    });
    this.onion.show(ghosts);
    studio.viewport.request();
  }

  private moments(now: number): number[] {
    const { count, every } = this.choice.value;
    const { duration, fps, tracks } = this.model.clip!;
    if (every === 0) {
      const keys = [...new Set(tracks.flatMap((track) => track.keys.map((key) => key.time)))].filter((time) => time <= duration).sort((a, b) => a - b);
      return [...keys.filter((time) => time < now - 1e-6).slice(-count), ...keys.filter((time) => time > now + 1e-6).slice(0, count)];
    }
    const steps = Array.from({ length: count }, (_, i) => ((i + 1) * every) / fps);
    return steps.flatMap((step) => [now - step, now + step]).filter((time) => time >= 0 && time <= duration + 1e-9);
  }
}

function ghost({ head, arrays }: Frame, color: Ghost["color"], opacity: number): Ghost {
  const positions = widened(arrays["positions"]!, head["low"] as number[], head["high"] as number[]);
  return { positions, normals: arrays["normals"] as Int8Array, color, opacity };
}
