// Frames are asked for ahead of the clock: as many at once as the server works on while others travel and are drawn,
// and so early as answers have taken lately. A frame that comes too late is drawn when it comes.

import type { Frame } from "../../transport/frame";

const UNDER_WAY = 2;
const REACH = 1.5; // seconds that are looked ahead

export class ReadAhead {
  private readonly asked = new Set<number>();
  private count = 0; // frames of the clock since the beginning
  private fps = 24;
  private last = -1; // the count that was asked for last
  private drawn = -1;
  private wait = 0.03; // seconds that answers take
  private turn = 0; // answers of an earlier play come to nothing

  constructor(
    /** The frame that is shown at a count of the clock; null beyond the end. */
    private readonly frameAt: (count: number) => number | null,
    private readonly has: (frame: number) => boolean,
    private readonly ask: (frame: number) => Promise<Frame | null>,
    private readonly draw: (answer: Frame) => void,
  ) {}

  begin(): void {
    this.turn++;
    this.asked.clear();
    this.count = 0;
    this.last = this.drawn = -1;
  }

  end(): void {
    this.turn++;
  }

  /** The clock is at a count. */
  follow(count: number, fps: number): void {
    [this.count, this.fps] = [count, fps];
    const frame = this.frameAt(count);
    if (frame !== null && this.has(frame)) this.drawn = count;
    this.fill();
  }

  private fill(): void {
    while (this.asked.size < UNDER_WAY) {
      const next = this.wanted();
      if (next === null) return;
      void this.fetch(next, this.frameAt(next)!, this.turn);
    }
  }

  /** The next count whose frame is missing, not sooner than it can be here. */
  private wanted(): number | null {
    const first = Math.max(this.count + Math.ceil(this.wait * this.fps), this.last + 1);
    for (let count = first; count <= this.count + REACH * this.fps + 1; count++) {
      const frame = this.frameAt(count);
      if (frame === null) return null;
      if (!this.has(frame) && !this.asked.has(frame)) return count;
    }
    return null;
  }

  private async fetch(count: number, frame: number, turn: number): Promise<void> {
    this.asked.add(frame);
    this.last = count;
    const began = performance.now();
    const answer = await this.ask(frame);
    if (turn !== this.turn) return;
    this.asked.delete(frame);
    this.wait += 0.3 * (Math.min((performance.now() - began) / 1000, 1) - this.wait);
    const late = count <= this.count;
    if (answer && count > this.drawn && (late || !this.has(frame))) {
      this.drawn = count;
      this.draw(answer);
    }
    this.fill();
  }
}
