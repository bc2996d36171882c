// Buttons, sliders and fields that all panels are made of.

import { h, replace } from "../core/dom";
import { icon, type IconName } from "../core/icons";

export function button(label: string, onclick: () => void, options: { icon?: IconName; kind?: "primary" | "quiet" } = {}): HTMLButtonElement {
  return h(
    "button",
    { class: `button ${options.kind ?? ""}`, type: "button", onclick },
    options.icon && (icon(options.icon, 16) as unknown as Node),
    h("span", null, label),
  );
}

export function iconButton(name: IconName, label: string, onclick: (event: MouseEvent) => void): HTMLButtonElement {
  return h(
    "button",
    { class: "icon-button", type: "button", title: label, "aria-label": label, onclick },
    icon(name) as unknown as Node,
  );
}

/** A button that is on or off. */
export function toggle(name: IconName, label: string, on: boolean, onchange: (on: boolean) => void): HTMLButtonElement {
  const element = iconButton(name, label, () => {
    const now = element.getAttribute("aria-pressed") !== "true";
    press(element, now);
    onchange(now);
  });
  press(element, on);
  return element;
}

export function press(element: HTMLElement, on: boolean): void {
  element.setAttribute("aria-pressed", String(on));
}

export function checkbox(label: string, on: boolean, onchange: (on: boolean) => void): HTMLLabelElement {
  const box = h("input", { type: "checkbox", checked: on, class: "switch" });
  box.addEventListener("change", () => onchange(box.checked));
  return h("label", { class: "row" }, h("span", { class: "row-label" }, label), box);
}

export function select<T extends string>(
  choices: readonly (readonly [T, string])[],
  value: T,
  onchange: (value: T) => void,
  label = "",
): HTMLSelectElement {
  const element = h("select", { class: "select", "aria-label": label || undefined, title: label || undefined });
  for (const [key, text] of choices) element.append(h("option", { value: key }, text));
  element.value = value;
  element.addEventListener("change", () => onchange(element.value as T));
  return element;
}

/** One of a few, all of them visible. */
export function segments<T extends string>(
  choices: readonly (readonly [T, string])[],
  value: T,
  onchange: (value: T) => void,
): HTMLDivElement {
  const group = h("div", { class: "segments", role: "radiogroup" });
  const show = (now: T): void => {
    replace(
      group,
      ...choices.map(([key, text]) =>
        h(
          "button",
          {
            type: "button",
            role: "radio",
            "aria-checked": String(key === now),
            onclick: () => {
              show(key);
              onchange(key);
            },
          },
          text,
        ),
      ),
    );
  };
  show(value);
  return group;
}

export interface NumberOptions {
  label: string;
  step?: number;
  unit?: string;
  low?: number;
  integer?: boolean;
  axis?: "x" | "y" | "z";
}

/** A field for a number: arrows step, Enter and leaving it set the value, Escape gives it back. */
export function numberField(value: number, onset: (value: number) => void, options: NumberOptions): HTMLElement {
  const input = h("input", { type: "text", inputMode: "decimal", "aria-label": options.label, class: "number", spellcheck: false });
  let current = value;
  const show = (): void => {
    const text = shortNumber(current);
    if (input.value !== text) input.value = text; // a field that stays as it is need not be drawn again
  };
  const commit = (): void => {
    const typed = Number(input.value.trim().replace(",", "."));
    const valid = input.value.trim() !== "" && Number.isFinite(typed) && typed >= (options.low ?? -Infinity);
    const next = valid ? (options.integer ? Math.round(typed) : typed) : current;
    if (valid && input.value !== shortNumber(current)) {
      current = next;
      onset(next);
    }
    show();
  };
  input.addEventListener("focus", () => input.select());
  input.addEventListener("blur", commit);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") commit();
    else if (event.key === "Escape") {
      show();
      input.blur();
    } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      event.preventDefault();
      const step = (options.step ?? 1) * (event.shiftKey ? 10 : 1) * (event.key === "ArrowUp" ? 1 : -1);
      input.value = shortNumber((Number(input.value) || 0) + step);
      commit();
    }
  });
  show();
  const field = h(
    "span",
    { class: `number-field${options.axis ? ` axis-${options.axis}` : ""}` },
    options.axis && h("span", { class: "axis-letter", "aria-hidden": "true" }, options.axis),
    input,
    options.unit && h("span", { class: "unit" }, options.unit),
  );
  Reflect.set(field, "setNumber", (next: number) => {
    current = next;
    if (document.activeElement !== input) show();
  });
  return field;
}

/** Show another number in a field, unless somebody types there. */
export function setNumber(field: Element, value: number): void {
  (Reflect.get(field, "setNumber") as (value: number) => void)(value);
}

/** Three fields beside each other. */
export function vectorField(value: readonly number[], onset: (axis: number, value: number) => void, options: NumberOptions): HTMLElement {
  return h(
    "div",
    { class: "vector" },
    ...(["x", "y", "z"] as const).map((axis, i) =>
      numberField(value[i]!, (next) => onset(i, next), { ...options, axis, label: `${options.label} ${axis}` }),
    ),
  );
}

export interface SliderOptions {
  label: string;
  low: number;
  high: number;
  step: number;
  /** Told at every move; `done` at the end only. */
  oninput?: (value: number) => void;
  ondone?: (value: number) => void;
  text?: (value: number) => string;
}

export function slider(value: number, options: SliderOptions): HTMLElement {
  const input = h("input", {
    type: "range",
    min: String(options.low),
    max: String(options.high),
    step: String(options.step),
    "aria-label": options.label,
  });
  input.value = String(value);
  const fill = (): void => {
    const part = (Number(input.value) - options.low) / (options.high - options.low || 1);
    input.style.setProperty("--part", `${Math.min(Math.max(part, 0), 1) * 100}%`);
  };
  const shown = h("output", { class: "slider-value" });
  const tell = (): void => {
    fill();
    shown.textContent = (options.text ?? shortNumber)(Number(input.value));
  };
  input.addEventListener("input", () => {
    tell();
    options.oninput?.(Number(input.value));
  });
  input.addEventListener("change", () => options.ondone?.(Number(input.value)));
  tell();
  return h("div", { class: "slider" }, input, options.text === undefined ? null : shown);
}

export function row(label: string, ...children: (Node | string)[]): HTMLDivElement {
  return h("div", { class: "row" }, h("span", { class: "row-label" }, label), h("div", { class: "row-body" }, ...children));
}

/** A part of the inspector that folds. */
export function section(title: string, body: HTMLElement, key: string, tools: HTMLElement[] = []): HTMLElement {
  const folded = sessionStorage.getItem(`fold-${key}`) === "1";
  const head = h(
    "button",
    { class: "section-title", type: "button", "aria-expanded": String(!folded) },
    icon("down", 14) as unknown as Node,
    h("span", null, title),
  );
  body.hidden = folded;
  head.addEventListener("click", () => {
    body.hidden = !body.hidden;
    head.setAttribute("aria-expanded", String(!body.hidden));
    sessionStorage.setItem(`fold-${key}`, body.hidden ? "1" : "0");
  });
  body.classList.add("section-body");
  return h("section", { class: "section", "data-section": key }, h("div", { class: "section-head" }, head, ...tools), body);
}

/** A number as short as it can be said with six digits. */
export function shortNumber(value: number): string {
  if (!Number.isFinite(value)) return "–";
  if (value !== 0 && (Math.abs(value) >= 1e7 || Math.abs(value) < 1e-4)) return value.toExponential(3).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(6)));
}
