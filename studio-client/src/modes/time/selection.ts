// Which keys are selected, by their layer, field and time; what is gone is forgotten.

import { Signal } from "../../core/signal";
import type { ClipKey, ClipState, TrackState } from "../../transport/protocol";

export type KeyName = [layer: string, field: string, time: number];

export const nameOf = (track: TrackState, key: ClipKey): KeyName => [track.layer, track.field, key.time];

export class KeySelection {
  readonly changed = new Signal(0);
  private readonly names = new Map<string, KeyName>();

  get list(): KeyName[] {
    return [...this.names.values()];
  }

  get size(): number {
    return this.names.size;
  }

  has(name: KeyName): boolean {
    return this.names.has(JSON.stringify(name));
  }

  choose(names: KeyName[], how: "only" | "add" | "toggle" = "only"): void {
    if (how === "only") this.names.clear();
    for (const name of names) {
      const id = JSON.stringify(name);
      if (how === "toggle" && this.names.has(id)) this.names.delete(id);
      else this.names.set(id, name);
    }
    this.tell();
  }

  /** The selected keys themselves, with their tracks. */
  found(clip: ClipState | null): { track: TrackState; key: ClipKey }[] {
    return (clip?.tracks ?? []).flatMap((track) =>
      track.keys.filter((key) => this.has(nameOf(track, key))).map((key) => ({ track, key })),
    );
  }

  /** Keep those that are still there. */
  prune(clip: ClipState | null): void {
    const there = new Set((clip?.tracks ?? []).flatMap((track) => track.keys.map((key) => JSON.stringify(nameOf(track, key)))));
    for (const id of [...this.names.keys()]) if (!there.has(id)) this.names.delete(id);
    this.tell();
  }

  private tell(): void {
    this.changed.set(this.changed.value + 1);
  }
}
