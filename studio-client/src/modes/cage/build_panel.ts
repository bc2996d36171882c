// A cage to be built: by a budget of vertices, by planes that are drawn across the limbs, or a box.

import { h, replace } from "../../core/dom";
import { t, tWord } from "../../core/strings";
import { button, checkbox, iconButton, row, segments, select, slider } from "../../panels/controls";
import type { Method, Plans } from "./plan";

export const KINDS = ["mean_value", "green", "harmonic", "maximum_entropy", "quad_mean_value", "quad_green"] as const;

export interface BuildActions {
  build: () => void;
}

export class BuildPanel {
  readonly element = h("div", { class: "cage-build" });
  private message = "";

  constructor(
    private readonly plans: Plans,
    private readonly actions: BuildActions,
  ) {}

  /** Show why the planes do not make a cage yet. */
  tell(message: string): void {
    this.message = message;
    this.show();
  }

  show(): void {
    const { now } = this.plans;
    replace(
      this.element,
      segments<Method>(
        [["offset", t("cageAutomatic")], ["cuts", t("cagePlanes")], ["box", t("cageBox")]],
        now.method,
        (method) => this.change({ method, drawing: method === "cuts" }),
      ),
      ...(now.method === "cuts" ? this.planes() : []),
      ...this.budget(),
      row(
        t("margin"),
        slider(100 * now.margin, {
          label: t("margin"),
          low: 1,
          high: 15,
          step: 0.5,
          text: (value) => `${value} %`,
          ondone: (margin) => this.change({ margin: margin / 100 }),
        }),
      ),
      row(
        t("coordinates"),
        select(KINDS.map((kind) => [kind, tWord("coordinates_", kind)] as const), now.coordinates as "green", (coordinates) => this.change({ coordinates }), t("coordinates")),
      ),
      h("div", { class: "button-row" }, button(t("buildCage"), this.actions.build, { kind: "primary", icon: "cage" })),
    );
  }

  private budget(): HTMLElement[] {
    const { now } = this.plans;
    const symmetries = [["", t("mirrorOff")], ["x", "x"], ["y", "y"], ["z", "z"]] as const;
    const found = [
      row(
        t("vertexBudget"),
        slider(now.vertices, {
          label: t("vertexBudget"),
          low: 20,
          high: 600,
          step: 10,
          text: String,
          oninput: (vertices) => this.plans.change({ vertices }),
        }),
      ),
    ];
    if (now.method === "offset") found.push(row(t("symmetry"), segments(symmetries, now.symmetry, (symmetry) => this.change({ symmetry }))));
    return found;
  }

  private planes(): (HTMLElement | false)[] {
    const { now } = this.plans;
    const without = (at: number): void => this.change({ cuts: now.cuts.filter((_, i) => i !== at) });
    return [
      h("p", { class: "muted" }, t("drawPlanes")),
      checkbox(t("drawingPlanes"), now.drawing, (drawing) => this.plans.change({ drawing })),
      now.cuts.length > 0 &&
        h(
          "ol",
          { class: "cage-cuts" },
          ...now.cuts.map((_, at) => h("li", null, h("span", null, `${t("plane")} ${at}`), iconButton("close", `${t("remove")} ${t("plane")} ${at}`, () => without(at)))),
        ),
      this.message !== "" && h("p", { class: "cage-message" }, this.message),
      row(
        t("ringSides"),
        slider(now.sides, { label: t("ringSides"), low: 3, high: 12, step: 1, text: String, ondone: (sides) => this.change({ sides }) }),
      ),
    ];
  }

  private change(part: Parameters<Plans["change"]>[0]): void {
    this.plans.change(part);
    this.show();
  }
}
