// A value that tells its readers when it changes.

export type Unsubscribe = () => void;

export class Signal<T> {
  private readonly readers = new Set<(value: T) => void>();

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set(value: T): void {
    if (Object.is(value, this.current)) return;
    this.current = value;
    this.notify();
  }

  /** Tell everybody, where the value is the same object with other contents. */
  notify(): void {
    for (const reader of [...this.readers]) reader(this.current);
  }

  /** Call now and at every change. */
  watch(reader: (value: T) => void): Unsubscribe {
    const stop = this.onChange(reader);
    reader(this.current);
    return stop;
  }

  /** Call at every change. */
  onChange(reader: (value: T) => void): Unsubscribe {
    this.readers.add(reader);
    return () => this.readers.delete(reader);
  }
}
