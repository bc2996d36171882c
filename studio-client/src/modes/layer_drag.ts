// A drag as the server sees it: begun, moved as often as it answers, committed as one entry of the history.

import type { Frame, Numbers } from "../transport/frame";
import { Latest } from "../transport/latest";
import { CommandError } from "../transport/session";
import type { Studio } from "../studio";
import { boundsOf } from "../view/mesh_view";

interface Job {
  values: Record<string, unknown>;
  arrays: Record<string, Numbers>;
  began: number;
}

/** How long the last move took until it was drawn, in milliseconds: for benchmarks. */
export const latencies: number[] = [];

/** The drag in hand, and when the last one that was in hand has ended. */
let held: LayerDrag | null = null;
let ending: Promise<unknown> = Promise.resolve();

const hold = (drag: LayerDrag): void => void (held = drag);
export const dragInHand = (): boolean => held !== null;
export const dragEnded = (): Promise<unknown> => ending;

export class LayerDrag {
  private readonly latest: Latest<Job>;
  private index: Numbers | null = null;
  private ended = false;
  private moved = false;
  /** What the server said to its beginning; null where it refused. */
  readonly begun: Promise<Frame | null>;

  constructor(
    private readonly studio: Studio,
    /** Of the commands `begin`, `move`, `commit` and `cancel`. */
    private readonly prefix: string,
    begin: Record<string, unknown>,
    private readonly onAnswer: (arrays: Record<string, Numbers>, head: Frame["head"]) => void = () => undefined,
    arrays: Record<string, Numbers> = {},
  ) {
    this.latest = new Latest((job) => this.send(job));
    this.begun = studio.ask(`${prefix}.begin`, begin, arrays);
    void this.begun.then((answer) => {
      if (!answer) this.ended = true;
    });
    hold(this);
  }

  move(values: Record<string, unknown>, arrays: Record<string, Numbers>): void {
    this.moved = true;
    if (!this.ended) this.latest.push({ values, arrays, began: performance.now() });
  }

  /** When the last move has been answered. */
  answered(): Promise<void> {
    return this.latest.idle();
  }

  /** Keep what has been done; whether there was anything: what did not move is no entry of the history. */
  commit(): Promise<boolean> {
    return this.letGo(this.moved ? this.keep() : this.drop());
  }

  async cancel(): Promise<void> {
    await this.letGo(this.drop());
  }

  private letGo(last: Promise<boolean>): Promise<boolean> {
    if (held === this) held = null;
    ending = last;
    return last;
  }

  private async keep(): Promise<boolean> {
    await this.begun;
    await this.latest.idle();
    const kept = !this.ended && (await this.studio.ask(`${this.prefix}.commit`)) !== null;
    this.ended = true;
    return kept;
  }

  private async drop(): Promise<boolean> {
    this.latest.clear();
    const was = this.ended;
    this.ended = true;
    if ((await this.begun) && !was) await this.studio.ask(`${this.prefix}.cancel`);
    return false;
  }

  /** Ask for a move; where the server has given the drag up, that is told once. */
  private async asked(job: Job): Promise<Frame | null> {
    try {
      return await this.studio.session.ask(`${this.prefix}.move`, job.values, job.arrays);
    } catch (error) {
      if (error instanceof CommandError && error.kind === "DragOver") this.ended = true;
      this.studio.tell(error);
      return null;
    }
  }

  private async send(job: Job): Promise<void> {
    if (this.ended) return;
    const answer = await this.asked(job);
    if (!answer || this.ended) return;
    const { arrays, head } = answer;
    if (arrays["index"]) this.index = arrays["index"];
    if (arrays["positions"]) {
      this.studio.mesh.move(head["all"] ? null : this.index, arrays["positions"], arrays["normals"]!, boundsOf(head));
      this.studio.pointsMoved.set(this.studio.pointsMoved.value + 1);
    }
    this.onAnswer(arrays, head);
    const stop = this.studio.viewport.drawn.onChange(() => {
      stop();
      latencies.push(performance.now() - job.began);
      if (latencies.length > 500) latencies.shift();
    });
    this.studio.viewport.request();
  }
}

/** Positions from 16 bits a coordinate in a box. */
export function widened(values: Numbers, low: number[], high: number[]): Float32Array {
  const out = new Float32Array(values.length);
  const step = [0, 1, 2].map((k) => (high[k]! - low[k]!) / 65535);
  for (let i = 0; i < values.length; i += 3) {
    out[i] = low[0]! + values[i]! * step[0]!;
    out[i + 1] = low[1]! + values[i + 1]! * step[1]!;
    out[i + 2] = low[2]! + values[i + 2]! * step[2]!;
  }
  return out;
}
