// How sure the model is of each point, as colours; it depends on which landmarks there are, not on where.

import { t } from "../../core/strings";
import type { Studio } from "../../studio";
import type { Numbers } from "../../transport/frame";
import type { ModelState } from "./model_state";

export class Uncertainty {
  shown = true;
  private painted = "";

  constructor(private readonly studio: Studio) {}

  async paint(model: ModelState | null): Promise<void> {
    const { studio } = this;
    const key = model && this.shown && model.landmarks ? model.knowledge : "";
    if (key === this.painted) return;
    this.painted = key;
    const answer = key ? await studio.ask("model.uncertainty", { layer: model!.layer }) : null;
    if (this.painted !== key) return;
    studio.paint.set(
      answer && {
        title: t("uncertainty"),
        unit: t("unitLength"),
        low: answer.head["low"] as number,
        high: answer.head["high"] as number,
        values: answer.arrays["values"] as Float32Array,
        table: answer.arrays["table"] as Numbers,
      },
    );
  }

  clear(): void {
    this.painted = "";
    this.studio.paint.set(null);
  }
}
