// The axis in numbers: which way it runs, where the deformation acts, how its strength goes along it.

import { h, replace } from "../../core/dom";
import { t, tWord } from "../../core/strings";
import { button, numberField, row, segments, shortNumber } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { ratesPanel } from "./rates";

const PROFILES = ["ramp", "smooth", "constant", "bump"] as const;
const AXES = ["x", "y", "z"] as const;
const NEUTRAL: Record<string, number> = { factor: 1, start: 1, end: 1, x: 1, y: 1, z: 1, waves: 1 };

export function axialPanel(studio: Studio): HTMLElement {
  const body = h("div", { class: "axial-panel" });
  let shown = "";
  const show = (): void => {
    const { layer } = studio;
    const rates = layer?.kind === "tangent-frames" && studio.scene?.revision; // many numbers are told by their shape
    const key = JSON.stringify([layer?.name, layer?.fields, layer?.kind, rates]);
    if (key === shown) return;
    shown = key;
    if (!layer?.axial) replace(body, h("p", { class: "muted" }, t("noAxis")));
    else replace(body, ...rows(studio, layer));
  };
  studio.session.scene.watch(show);
  studio.activeLayer.onChange(show);
  return body;
}

function rows(studio: Studio, layer: Layer): (HTMLElement | false)[] {
  const value = (name: string): unknown => layer.fields.find((field) => field.name === name)?.value;
  const set = (fields: Record<string, unknown>): void => void studio.ask("layers.fields", { layer: layer.name, fields });
  const numbers = Object.fromEntries(layer.fields.filter((field) => field.control).map(({ name }) => [name, NEUTRAL[name] ?? 0]));
  const bounds = value("bounds") as [number, number] | undefined;
  const axis = value("axis");
  const profile = value("profile");
  return [
    axis !== undefined &&
      row(
        t("axis"),
        segments(AXES.map((each) => [each, each] as const), typeof axis === "string" ? (axis as "x") : ("" as "x"), (to) =>
          void studio.ask("axial.fit", { layer: layer.name, axis: to }),
        ),
      ),
    Array.isArray(axis) && h("p", { class: "muted axial-direction" }, axis.map((each) => shortNumber(Number((each as number).toFixed(3)))).join(", ")),
    bounds !== undefined &&
      row(
        t("bounds"),
        ...bounds.map((bound, end) =>
          numberField(bound, (next) => set({ bounds: end ? [bounds[0], next] : [next, bounds[1]] }), {
            label: t(end ? "boundHigh" : "boundLow"),
            step: (bounds[1] - bounds[0]) / 20,
          }),
        ),
      ),
    layer.kind === "tangent-frames" && ratesPanel(studio, layer),
    profile !== undefined &&
      h(
        "div",
        { class: "row tall" },
        h("span", { class: "row-label" }, t("profile")),
        segments(
          PROFILES.map((each) => [each, tWord("profile_", each)] as const),
          profile as "ramp",
          (to) => set({ profile: to }),
        ),
      ),
    h(
      "div",
      { class: "button-row" },
      button(t("fitToShape"), () => void studio.ask("axial.fit", { layer: layer.name }), { icon: "frame" }),
      button(t("straighten"), () => set(layer.kind === "tangent-frames" ? { rates: atRest(value("rates")) } : numbers), { icon: "reset" }),
    ),
  ];
}

/** As many segments, none of which turns or grows; a value is told by its shape where it is long. */
function atRest(rates: unknown): number[][] {
  const count = Array.isArray(rates) ? rates.length : Number.parseInt(String(rates), 10);
  return Array.from({ length: count }, () => [0, 0, 0, 0]);
}
