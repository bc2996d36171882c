// Another method for the edit in hand: on a large mesh it is bound in the background, and the edit goes on meanwhile.

import { Signal } from "../../core/signal";
import type { Studio } from "../../studio";
import type { Frame } from "../../transport/frame";
import type { Method, SurfaceToolbar } from "./tools";

export class MethodSwitch {
  /** What binds it; null = nothing. */
  readonly job = new Signal<string | null>(null);
  /** It is bound, or nobody waits for it any more. */
  onEnd: () => void = () => undefined;

  constructor(
    private readonly studio: Studio,
    private readonly tools: SurfaceToolbar,
  ) {
    studio.session.on("progress-end", ({ head }) => {
      if (head["job"] !== this.job.value) return;
      this.job.set(null);
      this.onEnd();
    });
  }

  /** Whether the method that is chosen is still being bound. */
  get waits(): boolean {
    return this.job.value !== null;
  }

  /** Exchange a layer's method. */
  async exchange(layer: string, method: Method): Promise<void> {
    const answer = await this.studio.ask("surface.method", { layer, method });
    if (answer) this.take(answer.head);
    if (!this.waits) this.onEnd();
  }

  /** What an answer says of it; where it was given up, the method before is chosen again. */
  take(head: Frame["head"]): void {
    this.job.set((head["job"] as string | undefined) ?? null);
    if (head["given_up"] === this.tools.now.method) this.tools.change({ method: head["method"] as Method });
  }
}
