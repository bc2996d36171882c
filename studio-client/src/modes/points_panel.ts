// The selected control points in numbers: position, displacement, locks, and whole layers of the lattice.

import { h, replace } from "../core/dom";
import { t } from "../core/strings";
import { button, numberField, row, setNumber, vectorField } from "../panels/controls";
import type { Axis } from "./points_tools";
import type { ControlPoints } from "./control_points";

export interface PointActions {
  place: (position: Float64Array) => void;
  reset: (all: boolean) => void;
  lock: (locked: boolean) => void;
  chooseLayer: (axis: Axis, index: number) => void;
  chooseAll: () => void;
}

const LETTERS = ["i", "j", "k"] as const;
const READABLE = 100; // milliseconds

export class PointsPanel {
  readonly element = h("div", { class: "points-panel" });
  private position: HTMLElement | null = null;
  private displacement: HTMLElement | null = null;
  private following: number | null = null;

  constructor(private readonly actions: PointActions) {}

  /** The selection is another one. */
  show(points: ControlPoints | null): void {
    this.position = this.displacement = null;
    if (!points) {
      replace(this.element, h("p", { class: "muted" }, t("nothingSelected")));
      return;
    }
    const count = points.selected.size;
    replace(
      this.element,
      h("p", { class: "selection-title" }, this.title(points)),
      count > 0 && this.fields(points),
      points.arranged && this.layerChoice(points),
      h(
        "div",
        { class: "button-row" },
        count > 0 && button(t("resetPoints"), () => this.actions.reset(false), { icon: "reset" }),
        button(t("resetAll"), () => this.actions.reset(true)),
        count > 0 && this.lockButton(points),
        count === 0 && button(t("selectAll"), () => this.actions.chooseAll()),
      ),
    );
  }

  /** The same selection, elsewhere: told as often as somebody can read it. */
  follow(points: ControlPoints): void {
    this.following ??= window.setTimeout(() => {
      this.following = null;
      if (points.last === null || !this.position || !this.displacement) return;
      setAll(this.position, points.at(points.last).toArray());
      setAll(this.displacement, points.displacement(points.last).toArray());
    }, READABLE);
  }

  private title(points: ControlPoints): string {
    const { size } = points.selected;
    if (size === 0) return t("nothingSelected");
    if (size > 1 || points.last === null) return `${size} ${t("controlPointsSelected")}`;
    const place = points.place(points.last);
    return `${t("controlPoint")} ${place ? `(${place.join(", ")})` : points.last}`;
  }

  private fields(points: ControlPoints): HTMLElement {
    const at = points.last!;
    const set = (axis: number, value: number, displaced: boolean): void => {
      const next = points.at(at);
      next.setComponent(axis, displaced ? points.rest[3 * at + axis]! + value : value);
      this.actions.place(new Float64Array(next.toArray()));
    };
    this.displacement = vectorField(points.displacement(at).toArray(), (axis, value) => set(axis, value, true), {
      label: t("displacement"),
    });
    this.position = vectorField(points.at(at).toArray(), (axis, value) => set(axis, value, false), { label: t("position") });
    return h(
      "div",
      null,
      h("span", { class: "field-label" }, t("displacement")),
      this.displacement,
      h("span", { class: "field-label" }, t("position")),
      this.position,
    );
  }

  private layerChoice(points: ControlPoints): HTMLElement {
    const place = points.last === null ? [0, 0, 0] : points.place(points.last)!.map((index) => Math.max(index, 0));
    const letters = points.round ? (["θ", "r", "h"] as const) : LETTERS;
    return row(
      t("layerOf"),
      ...letters.map((letter, axis) =>
        h(
          "span",
          { class: "layer-choice" },
          button(letter, () => this.actions.chooseLayer(axis as Axis, place[axis]!), { kind: "quiet" }),
          numberField(place[axis]!, (index) => this.actions.chooseLayer(axis as Axis, index), {
            label: `${t("layerOf")} ${letter}`,
            integer: true,
            low: 0,
          }),
        ),
      ),
    );
  }

  private lockButton(points: ControlPoints): HTMLElement {
    const locked = [...points.selected].every((index) => points.locked.has(index));
    return button(t(locked ? "unlockPoints" : "lockPoints"), () => this.actions.lock(!locked), { icon: "lock" });
  }
}

function setAll(vector: HTMLElement, values: number[]): void {
  [...vector.children].forEach((field, i) => setNumber(field, values[i]!));
}
