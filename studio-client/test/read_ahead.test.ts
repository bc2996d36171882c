// Frames that are asked for ahead of the clock: how many at once, which, and what becomes of those that come late.

import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { ReadAhead } from "../src/modes/time/read_ahead";
import type { Frame } from "../src/transport/frame";

const settle = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 0));

function server(count = 20) {
  const kept = new Set<number>();
  const waiting = new Map<number, () => void>();
  const drawn: number[] = [];
  const ahead = new ReadAhead(
    (at) => (at < count ? at : null),
    (frame) => kept.has(frame),
    (frame) =>
      new Promise<Frame>((resolve) =>
        waiting.set(frame, () => {
          waiting.delete(frame);
          kept.add(frame);
          resolve({ head: { frame }, arrays: {} });
        }),
      ),
    ({ head }) => drawn.push(head["frame"] as number),
  );
  const answer = async (frame: number): Promise<void> => {
    waiting.get(frame)!();
    await settle();
  };
  ahead.begin();
  return { ahead, kept, waiting, drawn, answer };
}

describe("reading ahead", () => {
  beforeEach(() => void vi.spyOn(performance, "now").mockReturnValue(0)); // answers take no time
  afterEach(() => vi.restoreAllMocks());

  it("asks for two frames that are to come, and for the next where one has come", async () => {
    const { ahead, waiting, drawn, answer } = server();
    ahead.follow(0, 10);
    expect([...waiting.keys()]).toEqual([1, 2]);
    await answer(1);
    expect([...waiting.keys()]).toEqual([2, 3]);
    expect(drawn).toEqual([]); // its time has not come: the clock draws what is kept
  });

  it("draws a frame that comes late when it comes, but none that is older than what is shown", async () => {
    const { ahead, kept, drawn, answer } = server();
    ahead.follow(0, 10);
    ahead.follow(4, 10);
    await answer(2);
    expect(drawn).toEqual([2]);
    await answer(1);
    expect(drawn).toEqual([2]);
    kept.add(6);
    ahead.follow(6, 10);
    expect(drawn).toEqual([2]);
  });

  it("asks for nothing beyond the end, nor for what is kept", () => {
    const { ahead, kept, waiting } = server(6);
    kept.add(2).add(4);
    ahead.follow(1, 10);
    expect([...waiting.keys()]).toEqual([3, 5]);
    expect(waiting.size).toBe(2);
  });

  it("draws no answer to an earlier play", async () => {
    const { ahead, waiting, drawn, answer } = server();
    ahead.follow(0, 10);
    ahead.end();
    ahead.begin();
    ahead.follow(5, 10);
    await answer(1);
    await answer(2);
    expect(drawn).toEqual([]);
    expect([...waiting.keys()]).toEqual([6, 7]);
  });
});
