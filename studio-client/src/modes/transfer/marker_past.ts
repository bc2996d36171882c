// Markers belong to no history: what they were before each change is known here, as long as the scene stays as it is.

import type { Studio } from "../../studio";
import type { TransferState } from "./state";

type Markers = TransferState["markers"];

export class MarkerPast {
  private past: { markers: Markers; revision: number }[] = [];
  private now: TransferState | null = null;

  constructor(private readonly studio: Studio) {}

  private get revision(): number {
    return this.studio.scene?.revision ?? -1;
  }

  /** The server tells of markers. */
  follow(state: TransferState): void {
    const { now } = this;
    this.now = state;
    if (now?.name !== state.name || now.points !== state.points) this.past = [];
    else if (now.markers.join(";") !== state.markers.join(";")) this.past.push({ markers: now.markers, revision: this.revision });
  }

  /** Ask for the markers before the last change; false where the scene has changed since. */
  undo(): boolean {
    const last = this.past.pop();
    if (!last || last.revision !== this.revision) return false;
    const before = [...this.past];
    const { markers } = last;
    const asked = markers.length
      ? this.studio.ask("transfer.load", { texts: [JSON.stringify({ markers })] })
      : this.studio.ask("transfer.unmark", { index: -1 });
    void asked.then(() => (this.past = before)); // going back is no change
    return true;
  }
}
