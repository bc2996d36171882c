// How control points are moved: tool, soft selection, mirror, snapping, pivot, the axis that a drag is locked to.

import { Quaternion, Vector3 } from "three";
import { h, replace } from "../core/dom";
import { Signal } from "../core/signal";
import { t, tWord } from "../core/strings";
import type { Studio } from "../studio";
import { iconButton, numberField, press, select, slider, toggle } from "../panels/controls";
import type { Tool } from "../view/gizmo";
import { roundStep } from "../view/ground";

export type Axis = 0 | 1 | 2;
/** What a click takes: one control point, or all of a ring, a row, a layer; an edge or a face of a cage. */
export type Take = "point" | "ring" | "row" | "layer" | "edge" | "face";
export type Pivot = "center" | "origin" | "last";

export interface Tools {
  tool: Tool;
  rectangle: boolean;
  soft: boolean;
  /** As part of the shape's diagonal. */
  radius: number;
  mirror: Axis | null;
  snap: boolean;
  step: number;
  pivot: Pivot;
  axis: Axis | null;
  /** Along the axes of the lattice, not of the world. */
  local: boolean;
  take: Take;
  /** What there is to take. */
  takes: readonly Take[];
  /** What the axes of the lattice are called. */
  letters: readonly [string, string, string];
}

export class PointTools {
  readonly state = new Signal<Tools>({
    tool: "translate",
    rectangle: false,
    soft: false,
    radius: 0.2,
    mirror: null,
    snap: false,
    step: 0,
    pivot: "center",
    axis: null,
    local: false,
    take: "point",
    takes: ["point"],
    letters: ["i", "j", "k"],
  });

  /** From the world's axes to those of the lattice; null where they are the same. */
  own: Quaternion | null = null;

  constructor(private readonly studio: Studio) {}

  get now(): Tools {
    return this.state.value;
  }

  change(part: Partial<Tools>): void {
    this.state.set({ ...this.now, ...part });
  }

  get diagonal(): number {
    return this.studio.scene?.mesh?.diagonal ?? 1;
  }

  get step(): number {
    return this.now.step || roundStep(this.diagonal / 50);
  }

  get softRadius(): number | null {
    return this.now.soft ? this.now.radius * this.diagonal : null;
  }

  /** How the axes in use are turned; null where they are the world's. */
  get turn(): Quaternion | null {
    return this.now.local ? this.own : null;
  }

  /** The direction that drags are locked to. */
  get along(): Vector3 | null {
    const { axis } = this.now;
    return axis === null ? null : new Vector3().setComponent(axis, 1).applyQuaternion(this.turn ?? new Quaternion());
  }

  /** A move as the lock and the snapping allow it. */
  restrained(move: Vector3): Vector3 {
    const { axis, snap } = this.now;
    const turn = this.turn ?? new Quaternion();
    const own = move.clone().applyQuaternion(turn.clone().invert());
    const kept = axis === null ? own : new Vector3().setComponent(axis, own.getComponent(axis));
    if (snap) kept.set(...(kept.toArray().map((value) => Math.round(value / this.step) * this.step) as [number, number, number]));
    return kept.applyQuaternion(turn);
  }

  /** What these control points let one take, what their axes are called, and how these are turned. */
  offer(takes: readonly Take[], boxed: boolean, own: Quaternion | null): void {
    const turned = (own === null) !== (this.own === null);
    this.own = own;
    const letters = boxed ? (["i", "j", "k"] as const) : (["x", "y", "z"] as const);
    if (!turned && String(takes) === String(this.now.takes) && letters[0] === this.now.letters[0]) return;
    this.change({ takes, letters, take: takes.includes(this.now.take) ? this.now.take : "point" });
  }

  /** The bar above the canvas. */
  bar(): HTMLElement {
    const element = h("div", { class: "toolbar", role: "toolbar" });
    this.state.watch(() => this.fill(element));
    return element;
  }

  private fill(element: HTMLElement): void {
    const { now } = this;
    const tool = (name: Tool, iconName: "move" | "rotate" | "scale", label: string): HTMLElement => {
      const each = iconButton(iconName, label, () => this.change({ tool: name }));
      press(each, now.tool === name);
      return each;
    };
    replace(
      element,
      tool("translate", "move", `${t("toolMove")} (G)`),
      tool("rotate", "rotate", `${t("toolRotate")} (R)`),
      tool("scale", "scale", `${t("toolScale")} (S)`),
      separator(),
      now.takes.length > 1 && this.takeChoice(),
      toggle("rectangle", `${t("toolRectangle")} (B)`, now.rectangle, (rectangle) => this.change({ rectangle })),
      separator(),
      toggle("soft", `${t("soft")} (O)`, now.soft, (soft) => this.change({ soft })),
      now.soft && this.radiusSlider(),
      toggle("magnet", `${t("snap")} (N)`, now.snap, (snap) => this.change({ snap })),
      this.own && toggle("axes", `${t("key_local")} (L)`, now.local, (local) => this.change({ local })),
      now.snap && numberField(this.step, (step) => this.change({ step }), { label: t("snapStep"), low: 1e-9, step: this.step }),
      separator(),
      h("span", { class: "toolbar-label" }, t("mirror")),
      this.mirrorChoice(),
      h("span", { class: "toolbar-label" }, t("pivot")),
      this.pivotChoice(),
    );
  }

  private radiusSlider(): HTMLElement {
    return slider(this.now.radius, {
      label: t("radius"),
      low: 0.02,
      high: 1,
      step: 0.01,
      text: (value) => `${Math.round(100 * value)} %`,
      ondone: (radius) => this.change({ radius }),
    });
  }

  private mirrorChoice(): HTMLElement {
    const [first, second, third] = this.now.letters;
    const choices = [["", t("mirrorOff")], ["0", first], ["1", second], ["2", third]] as const;
    const now = this.now.mirror === null ? "" : (String(this.now.mirror) as "0" | "1" | "2");
    return select(choices, now, (value) => this.change({ mirror: value === "" ? null : (Number(value) as Axis) }), t("mirror"));
  }

  private takeChoice(): HTMLElement {
    const choices = this.now.takes.map((each) => [each, tWord("take_", each)] as const);
    return select(choices, this.now.take, (take) => this.change({ take }), t("take"));
  }

  private pivotChoice(): HTMLElement {
    const choices = [["center", t("pivotCenter")], ["last", t("pivotLast")], ["origin", t("pivotOrigin")]] as const;
    return select(choices, this.now.pivot, (pivot) => this.change({ pivot }), t("pivot"));
  }
}

export const separator = (): HTMLElement => h("span", { class: "separator", "aria-hidden": "true" });
