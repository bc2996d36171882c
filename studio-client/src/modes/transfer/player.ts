// Poses in time and by sliders: weights go to the server, one drag from the first move to the last.

import type { Studio } from "../../studio";
import type { Numbers } from "../../transport/frame";
import { LayerDrag } from "../layer_drag";
import { weightsAt } from "./state";

export class Player {
  weights: number[] = [];
  playing = false;
  private drag: LayerDrag | null = null;
  private began = 0;

  constructor(
    private readonly studio: Studio,
    /** What an answer says beside the points. */
    private readonly answered: (arrays: Record<string, Numbers>) => void,
    private readonly moved: (weights: readonly number[]) => void,
  ) {}

  play(layer: string, count: number): void {
    this.playing = true;
    this.began = performance.now();
    const step = (now: number): void => {
      if (!this.playing) return;
      this.put(layer, weightsAt(Math.max(now - this.began, 0) / 1000, count));
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  /** Other weights; the first of a movement takes hold. */
  put(layer: string, weights: number[]): void {
    this.weights = weights;
    this.drag ??= new LayerDrag(this.studio, "transfer", { layer }, (arrays) => this.answered(arrays));
    this.drag.move({ weights }, {});
    this.moved(weights);
  }

  get moving(): boolean {
    return this.drag !== null;
  }

  /** Back to the weights before. */
  async cancel(): Promise<void> {
    const { drag } = this;
    this.playing = false;
    this.drag = null;
    await drag?.cancel();
  }

  /** Keep the weights as they are now: one entry of the history. */
  async stop(): Promise<void> {
    const { drag } = this;
    this.playing = false;
    this.drag = null;
    await drag?.commit();
  }
}
