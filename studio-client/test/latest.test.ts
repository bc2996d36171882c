import { expect, test } from "vitest";
import { Latest } from "../src/transport/latest";

test("one job at a time, and of those that wait the latest", async () => {
  const done: number[] = [];
  let running = 0;
  const latest = new Latest<number>(async (job) => {
    expect(++running).toBe(1);
    await new Promise((resolve) => setTimeout(resolve, 2));
    running--;
    done.push(job);
  });
  for (let job = 0; job < 10; job++) latest.push(job);
  await latest.idle();
  expect(done).toEqual([0, 9]);
});

test("a job that fails does not stop the next", async () => {
  const done: number[] = [];
  const latest = new Latest<number>(async (job) => {
    if (job === 0) throw new Error("no");
    done.push(job);
  });
  latest.push(0);
  latest.push(1);
  await latest.idle();
  expect(done).toEqual([1]);
});

test("what was cleared does not run", async () => {
  const done: number[] = [];
  const latest = new Latest<number>(async (job) => {
    await Promise.resolve();
    done.push(job);
  });
  latest.push(0);
  latest.push(1);
  latest.clear();
  await latest.idle();
  expect(done).toEqual([0]);
});
