// Back-pressure: one request on its way, and of those that wait only the latest.

export class Latest<T> {
  private busy = false;
  private waiting: { job: T } | null = null;
  private settled: (() => void)[] = [];

  constructor(private readonly run: (job: T) => Promise<void>) {}

  push(job: T): void {
    if (this.busy) {
      this.waiting = { job };
      return;
    }
    this.busy = true;
    void this.run(job)
      .catch(() => undefined) // whoever runs a job reports its failure
      .finally(() => this.next());
  }

  /** Forget what waits. */
  clear(): void {
    this.waiting = null;
  }

  /** When nothing is on its way any more. */
  idle(): Promise<void> {
    if (!this.busy) return Promise.resolve();
    return new Promise((resolve) => this.settled.push(resolve));
  }

  private next(): void {
    this.busy = false;
    const waiting = this.waiting;
    this.waiting = null;
    if (waiting) {
      this.push(waiting.job);
      return;
    }
    for (const resolve of this.settled.splice(0)) resolve();
  }
}
