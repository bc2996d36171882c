// Markers belong to no history: what they were before each change is known here, as long as the scene stays as it is.

import type { Studio } from "../../studio";
import type { TransferState } from "./state";

type Markers = TransferState["markers"];

export class MarkerPast {
  private past: { markers: Markers; revision: number }[] = [];
  private now: TransferState | null = null;
  private returning: string[] = []; // markers that were asked for: going back is no change

  constructor(private readonly studio: Studio) {}

  private get revision(): number {
    return this.studio.scene?.revision ?? -1;
  }

  /** The server tells of markers. */
  follow(state: TransferState): void {
    const { now } = this;
    this.now = state;
    if (now?.name !== state.name || now.points !== state.points) [this.past, this.returning] = [[], []];
    else if (this.returning[0] === state.markers.join(";")) this.returning.shift();
    else if (now.markers.join(";") !== state.markers.join(";")) this.past.push({ markers: now.markers, revision: this.revision });
  }

  /** Ask for the markers before the last change; false where the scene has changed since. */
  undo(): boolean {
    const last = this.past.pop();
    if (!last || last.revision !== this.revision) return false;
    const { markers } = last;
    this.returning.push(markers.join(";"));
    if (markers.length) void this.studio.ask("transfer.load", { texts: [JSON.stringify({ markers })] });
    else void this.studio.ask("transfer.unmark", { index: -1 });
    return true;
  }
}
