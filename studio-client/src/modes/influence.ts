// How much of the selected control points' move each point of the surface makes, as colours.

import { t } from "../core/strings";
import type { Studio } from "../studio";
import { Latest } from "../transport/latest";
import type { ControlPoints } from "./control_points";

export class Influence {
  private readonly latest = new Latest<ControlPoints | null>((points) => this.fetch(points));
  private shown = "";

  constructor(private readonly studio: Studio) {}

  show(points: ControlPoints | null): void {
    const key = points?.selected.size ? `${points.layer} ${this.studio.scene?.revision} ${[...points.selected].join()}` : "";
    if (key === this.shown) return;
    this.shown = key;
    this.latest.push(key ? points : null);
  }

  private async fetch(points: ControlPoints | null): Promise<void> {
    const { studio } = this;
    const index = Uint32Array.from(points?.selected ?? []);
    const answer = points && index.length ? await studio.ask("points.influence", { layer: points.layer }, { index }) : null;
    if (!answer) {
      studio.paint.set(null);
      return;
    }
    const values = answer.arrays["values"] as Float32Array;
    const high = values.reduce((most, value) => Math.max(most, value), 0) || 1;
    studio.paint.set({ title: t("influence"), unit: t("influenceUnit"), low: 0, high, values, table: answer.arrays["table"]! });
  }
}
