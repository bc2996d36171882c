// Sites in a panel: how they are made, mirrored and taken away, and how smooth the deformation is at them.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, checkbox, row, segments, slider } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { ControlPoints } from "../control_points";

export interface SiteActions {
  scatter: (count: number) => void;
  mirror: (axis: number) => void;
  remove: () => void;
  begin: () => void;
}

export class SitesPanel {
  readonly element = h("div", { class: "sites-panel" });
  private count = 24;
  private axis: "0" | "1" | "2" = "0";

  constructor(
    private readonly studio: Studio,
    private readonly actions: SiteActions,
  ) {}

  show(points: ControlPoints | null): void {
    replace(this.element, ...(points ? this.ofLayer(points) : this.ofNone()));
  }

  private ofNone(): HTMLElement[] {
    return [
      h("p", { class: "muted" }, t("noSites")),
      row(
        t("scatter"),
        slider(this.count, {
          label: t("scatter"),
          low: 4,
          high: 120,
          step: 1,
          text: String,
          oninput: (count) => (this.count = count),
        }),
      ),
      h("div", { class: "button-row" }, button(t("scatterNow"), () => this.actions.scatter(this.count), { kind: "primary" })),
    ];
  }

  private ofLayer(points: ControlPoints): HTMLElement[] {
    const smooth = this.studio.layer?.fields.find((field) => field.name === "smooth")?.value === true;
    const set = (on: boolean): void => void this.studio.ask("layers.fields", { layer: points.layer, fields: { smooth: on } });
    return [
      checkbox(t("smoothSites"), smooth, set),
      row(
        t("mirrorSites"),
        segments([["0", "x"], ["1", "y"], ["2", "z"]], this.axis, (axis) => (this.axis = axis)),
        button(t("add"), () => this.actions.mirror(Number(this.axis)), { icon: "mirror" }),
      ),
      h(
        "div",
        { class: "button-row" },
        button(t("newSites"), () => this.actions.begin(), { icon: "plus" }),
        ...(points.selected.size ? [button(t("deleteSites"), () => this.actions.remove(), { icon: "trash" })] : []),
      ),
    ];
  }
}
