// The bar above the canvas for control points: tools and switches, and below it the numbers of those that are on.

import { h, replace } from "../core/dom";
import { icon, type IconName } from "../core/icons";
import { t, tWord } from "../core/strings";
import { iconButton, numberField, press, select, slider, toggle } from "../panels/controls";
import type { Tool } from "../view/gizmo";
import type { Axis, PointTools } from "./points_tools";

export function pointToolbar(tools: PointTools): HTMLElement {
  const bar = h("div", { class: "toolbar", role: "toolbar" });
  const numbers = h("div", { class: "toolbar-numbers" });
  tools.state.watch(() => {
    fill(bar, tools);
    const shown = fields(tools);
    numbers.hidden = shown.length === 0;
    replace(numbers, ...shown);
  });
  return h("div", { class: "toolbars" }, bar, numbers);
}

export const separator = (): HTMLElement => h("span", { class: "separator", "aria-hidden": "true" });

function fill(bar: HTMLElement, tools: PointTools): void {
  const { now } = tools;
  const tool = (name: Tool, symbol: IconName, label: string): HTMLElement => {
    const each = iconButton(symbol, label, () => tools.change({ tool: name }));
    press(each, now.tool === name);
    return each;
  };
  replace(
    bar,
    tool("translate", "move", `${t("toolMove")} (G)`),
    tool("rotate", "rotate", `${t("toolRotate")} (R)`),
    tool("scale", "scale", `${t("toolScale")} (S)`),
    separator(),
    now.takes.length > 1 && takeChoice(tools),
    toggle("rectangle", `${t("toolRectangle")} (B)`, now.rectangle, (rectangle) => tools.change({ rectangle })),
    separator(),
    toggle("soft", `${t("soft")} (O)`, now.soft, (soft) => tools.change({ soft })),
    toggle("magnet", `${t("snap")} (N)`, now.snap, (snap) => tools.change({ snap })),
    now.joints && toggle("joint", `${t("keepJoints")} (J)`, now.smooth, (smooth) => tools.change({ smooth })),
    tools.own && toggle("axes", `${t("key_local")} (L)`, now.local, (local) => tools.change({ local })),
    separator(),
    h("span", { class: "toolbar-icon", title: t("mirror") }, icon("mirror") as unknown as Node),
    mirrorChoice(tools),
  );
}

/** Of what is on: how far soft selection reaches, the step of snapping, what is turned and scaled about. */
function fields(tools: PointTools): HTMLElement[] {
  const { now } = tools;
  const field = (title: string, ...parts: HTMLElement[]): HTMLElement => h("span", { class: "toolbar-field" }, h("span", null, title), ...parts);
  return [
    ...(now.soft ? [field(t("radius"), radius(tools))] : []),
    ...(now.snap
      ? [field(t("snapStep"), numberField(tools.step, (step) => tools.change({ step }), { label: t("snapStep"), low: 1e-9, step: tools.step }))]
      : []),
    ...(now.tool === "translate" ? [] : [field(t("pivot"), pivotChoice(tools))]),
  ];
}

function radius(tools: PointTools): HTMLElement {
  return slider(tools.now.radius, {
    label: t("radius"),
    low: 0.02,
    high: 1,
    step: 0.01,
    text: (value) => `${Math.round(100 * value)} %`,
    ondone: (part) => tools.change({ radius: part }),
  });
}

function mirrorChoice(tools: PointTools): HTMLElement {
  const [first, second, third] = tools.now.letters;
  const choices = [["", t("mirrorOff")], ["0", first], ["1", second], ["2", third]] as const;
  const now = tools.now.mirror === null ? "" : (String(tools.now.mirror) as "0" | "1" | "2");
  return select(choices, now, (value) => tools.change({ mirror: value === "" ? null : (Number(value) as Axis) }), t("mirror"));
}

function takeChoice(tools: PointTools): HTMLElement {
  const choices = tools.now.takes.map((each) => [each, tWord("take_", each)] as const);
  return select(choices, tools.now.take, (take) => tools.change({ take }), t("take"));
}

function pivotChoice(tools: PointTools): HTMLElement {
  const choices = [["center", t("pivotCenter")], ["last", t("pivotLast")], ["origin", t("pivotOrigin")]] as const;
  return select(choices, tools.now.pivot, (pivot) => tools.change({ pivot }), t("pivot"));
}
