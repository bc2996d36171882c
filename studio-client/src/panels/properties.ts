// The properties of a layer, generated from its deformer's fields: a new deformer needs no line here.

import { h, replace } from "../core/dom";
import { t, term } from "../core/strings";
import { CHOICES, FIELDS } from "../core/strings/terms";
import { LayerDrag } from "../modes/layer_drag";
import type { Studio } from "../studio";
import type { FieldValue, Layer } from "../transport/protocol";
import { checkbox, numberField, row, select, setNumber, shortNumber, slider, vectorField } from "./controls";

const DEGREE = Math.PI / 180;

export function propertiesPanel(studio: Studio): HTMLElement {
  const body = h("div", { class: "properties" });
  let shown = "";
  const show = (): void => {
    const { layer } = studio;
    const key = JSON.stringify([layer?.name, layer?.fields]);
    if (key === shown || body.contains(document.activeElement) && body.querySelector("input[type=range]:active")) return;
    shown = key;
    const focused = (document.activeElement as HTMLElement | null)?.getAttribute("aria-label");
    if (!layer) replace(body, h("p", { class: "muted" }, t("noProperties")));
    else replace(body, ...layer.fields.map((field) => fieldRow(studio, layer, field)));
    if (focused && document.activeElement === document.body) {
      body.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus();
    }
  };
  studio.session.scene.watch(show);
  studio.activeLayer.onChange(show);
  return body;
}

function fieldRow(studio: Studio, layer: Layer, field: FieldValue): HTMLElement {
  const set = (value: unknown): void => {
    void studio.ask("layers.fields", { layer: layer.name, fields: { [field.name]: value } });
  };
  const element = editor(studio, layer, field, set);
  element.title = field.doc;
  element.dataset["field"] = field.name;
  return element;
}

function editor(studio: Studio, layer: Layer, field: FieldValue, set: (value: unknown) => void): HTMLElement {
  const label = term(FIELDS, field.name);
  const { value } = field;
  if (field.editable) {
    if (typeof value === "number") return row(label, number(studio, layer, field, value, set));
    if (typeof value === "boolean") return checkbox(label, value, set);
    if (field.type === "choice" && field.choices.length) {
      return row(label, select(field.choices.map((word) => [word, term(CHOICES, word, word)] as const), String(value), set, label));
    }
    if (field.type === "axis" && typeof value === "string") {
      return row(label, select((["x", "y", "z"] as const).map((axis) => [axis, axis] as const), value as "x", set, label));
    }
    if (isVector(value)) {
      return h(
        "div",
        { class: "row tall" },
        h("span", { class: "row-label" }, label),
        vectorField(value, (axis, next) => set(value.map((old, i) => (i === axis ? next : old))), { label }),
      );
    }
  }
  return row(label, h("span", { class: "muted", title: t("notEditable") }, summary(value)));
}

/** A number: a slider that previews, where a range is known, and a field for any value. */
function number(studio: Studio, layer: Layer, field: FieldValue, value: number, set: (value: number) => void): HTMLElement {
  const scale = field.type === "angle" ? 1 / DEGREE : 1;
  const label = term(FIELDS, field.name);
  const entry = numberField(value * scale, (next) => set(next / scale), {
    label,
    integer: field.type === "integer",
    step: field.type === "angle" ? 5 : field.type === "integer" ? 1 : stepOf(value),
    ...(field.type === "angle" ? { unit: t("degrees") } : {}),
  });
  if (!field.range || field.type === "integer") return entry;
  let drag: LayerDrag | null = null;
  const low = Math.min(field.range[0], value) * scale;
  const high = Math.max(field.range[1], value) * scale;
  const control = slider(value * scale, {
    label: `${label} –`,
    low,
    high,
    step: (high - low) / 400,
    oninput: (next) => {
      drag ??= new LayerDrag(studio, "preview", { layer: layer.name, label: "field" });
      drag.move({ fields: { [field.name]: next / scale } }, {});
      setNumber(entry, next);
    },
    ondone: () => {
      void drag?.commit();
      drag = null;
    },
  });
  return h("div", { class: "slider-and-number" }, control, entry);
}

const stepOf = (value: number): number => 10 ** Math.floor(Math.log10(Math.abs(value) || 1)) / 10;

const isVector = (value: unknown): value is number[] =>
  Array.isArray(value) && value.length === 3 && value.every((each) => typeof each === "number");

function summary(value: unknown): string {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number") return shortNumber(value);
  if (Array.isArray(value)) return value.every((each) => typeof each === "number") ? value.map(shortNumber).join(", ") : `${value.length} × …`;
  return typeof value === "string" ? value : "…";
}

