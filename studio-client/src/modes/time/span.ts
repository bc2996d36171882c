// The stretch of time that is on view: from seconds to pixels and back, zoomed and moved; and round ticks for its ruler.

export class Span {
  width = 100;

  constructor(
    public from = 0,
    public to = 1,
    private readonly pad = 14,
  ) {}

  x(time: number): number {
    return this.pad + ((time - this.from) / (this.to - this.from)) * this.room;
  }

  time(x: number): number {
    return this.from + ((x - this.pad) / this.room) * (this.to - this.from);
  }

  /** All of a clip. */
  fit(duration: number): void {
    [this.from, this.to] = [0, duration];
  }

  zoom(factor: number, x: number): void {
    const about = this.time(x);
    const size = Math.min(Math.max((this.to - this.from) * factor, 0.02), 3600);
    const part = (about - this.from) / (this.to - this.from);
    this.from = Math.max(about - part * size, 0);
    this.to = this.from + size;
  }

  pan(pixels: number): void {
    const by = Math.max((pixels / this.room) * (this.to - this.from), -this.from);
    this.from += by;
    this.to += by;
  }

  /** Times of ticks: frames where there is room for them, else round numbers of seconds. */
  ticks(fps: number): { major: number[]; minor: number[] } {
    const perPixel = (this.to - this.from) / this.room;
    const steps = [1 / fps, 2 / fps, 5 / fps, 0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 60, 300].filter((step) => step >= 1 / fps - 1e-9);
    const major = steps.find((step) => step / perPixel >= 64) ?? steps.at(-1)!;
    const minor = steps.find((step) => step / perPixel >= 9 && isMultiple(major, step)) ?? major;
    return { major: this.every(major), minor: this.every(minor) };
  }

  private get room(): number {
    return Math.max(this.width - 2 * this.pad, 1);
  }

  private every(step: number): number[] {
    const first = Math.max(Math.ceil((this.from - 1e-9) / step), 0);
    const last = Math.floor((this.to + 1e-9) / step);
    return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => (first + i) * step);
  }
}

const isMultiple = (whole: number, part: number): boolean => Math.abs(whole / part - Math.round(whole / part)) < 1e-6;
