// The layers: what deforms the shape, in order, the last one on top.

import { h, replace } from "../core/dom";
import { icon } from "../core/icons";
import { t, term } from "../core/strings";
import { KINDS } from "../core/strings/terms";
import { LayerDrag } from "../modes/layer_drag";
import type { Studio } from "../studio";
import type { Layer } from "../transport/protocol";
import { button, iconButton, press, slider } from "./controls";
import { chooseDeformer } from "./deformer_menu";
import { newLattice } from "./lattice_dialog";

export function layersPanel(studio: Studio): { body: HTMLElement; tools: HTMLElement[] } {
  const body = h("div", { class: "layers", role: "listbox", "aria-label": t("layers") });
  let shown = "";
  const show = (): void => {
    const layers = studio.scene?.layers ?? [];
    const key = JSON.stringify([layers.map((layer) => ({ ...layer, fields: null })), studio.activeLayer.value]);
    if (key === shown || body.querySelector("input.rename")) return;
    shown = key;
    if (layers.length) replace(body, ...layers.map((layer) => row(studio, layer)).reverse());
    else replace(body, empty(studio));
  };
  studio.session.scene.watch(show);
  studio.activeLayer.onChange(show);
  const add = iconButton("plus", t("addLayer"), (event) => chooseDeformer(studio, event.currentTarget as HTMLElement));
  return { body, tools: [add] };
}

function empty(studio: Studio): HTMLElement {
  return h(
    "div",
    { class: "empty" },
    icon("layer", 28) as unknown as Node,
    h("p", null, t("noLayers")),
    button(t("addLattice"), () => newLattice(studio), { kind: "primary", icon: "points" }),
  );
}

function row(studio: Studio, layer: Layer): HTMLElement {
  const active = studio.activeLayer.value === layer.name;
  const ask = (command: string, values: Record<string, unknown>): void => {
    void studio.ask(command, { layer: layer.name, ...values });
  };
  const mute = iconButton(layer.muted ? "hidden" : "view", t(layer.muted ? "unmute" : "mute"), () =>
    ask("layers.mute", { muted: !layer.muted }),
  );
  const solo = iconButton("solo", t("solo"), () => ask("layers.solo", { solo: !layer.solo }));
  press(mute, layer.muted);
  press(solo, layer.solo);
  const name = h("span", { class: "layer-name" }, layer.name);
  name.addEventListener("dblclick", () => rename(studio, layer, name));
  const element = h(
    "div",
    {
      class: `layer${active ? " active" : ""}${layer.muted ? " muted-layer" : ""}`,
      role: "option",
      "aria-selected": String(active),
      tabindex: "0",
      draggable: true,
      title: t("reorder"),
      "data-layer": layer.name,
      onclick: () => studio.activeLayer.set(layer.name),
    },
    h("span", { class: "grip" }, icon("grip", 14) as unknown as Node),
    h("div", { class: "layer-text" }, name, h("span", { class: "layer-kind" }, term(KINDS, layer.kind, layer.title))),
    solo,
    mute,
    iconButton("trash", t("remove"), () => ask("layers.remove", {})),
    active && strength(studio, layer),
  );
  makeSortable(studio, element, layer);
  return element;
}

function strength(studio: Studio, layer: Layer): HTMLElement {
  let drag: LayerDrag | null = null;
  const control = slider(layer.envelope, {
    label: t("envelope"),
    low: 0,
    high: 1.5,
    step: 0.01,
    text: (value) => `${Math.round(100 * value)} %`,
    oninput: (envelope) => {
      drag ??= new LayerDrag(studio, "preview", { layer: layer.name, label: "envelope" });
      drag.move({ envelope }, {});
    },
    ondone: () => {
      void drag?.commit();
      drag = null;
    },
  });
  const element = h("div", { class: "layer-strength" }, h("span", { class: "row-label" }, t("envelope")), control);
  element.draggable = true;
  element.addEventListener("dragstart", (event) => {
    event.preventDefault();
    event.stopPropagation();
  });
  return element;
}

function rename(studio: Studio, layer: Layer, name: HTMLElement): void {
  const input = h("input", { class: "rename", value: layer.name, "aria-label": t("rename") });
  let done = false;
  const finish = (keep: boolean): void => {
    if (done) return;
    done = true;
    input.replaceWith(name);
    if (keep && input.value.trim() && input.value !== layer.name) {
      const to = input.value.trim();
      void studio.ask("layers.rename", { layer: layer.name, name: to }).then((answer) => {
        if (answer) studio.activeLayer.set(to);
      });
    }
  };
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") finish(true);
    if (event.key === "Escape") finish(false);
    event.stopPropagation();
  });
  input.addEventListener("blur", () => finish(true));
  name.replaceWith(input);
  input.select();
}

/** Layers are reordered by dragging, and by Alt-Up and Alt-Down. The list shows the last layer first. */
function makeSortable(studio: Studio, element: HTMLElement, layer: Layer): void {
  const layers = (): Layer[] => studio.scene?.layers ?? [];
  const place = (name: string): number => layers().findIndex((each) => each.name === name);
  const move = (name: string, index: number): void => {
    if (index >= 0 && index < layers().length && index !== place(name)) void studio.ask("layers.move", { layer: name, index });
  };
  element.addEventListener("keydown", (event) => {
    if (event.target !== element) return;
    if (event.key === "Enter" || event.key === " ") studio.activeLayer.set(layer.name);
    else if (event.altKey && event.key === "ArrowUp") move(layer.name, place(layer.name) + 1);
    else if (event.altKey && event.key === "ArrowDown") move(layer.name, place(layer.name) - 1);
    else if (event.key === "F2") rename(studio, layer, element.querySelector<HTMLElement>(".layer-name")!);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  element.addEventListener("dragstart", (event) => event.dataTransfer?.setData("application/x-layer", layer.name));
  element.addEventListener("dragover", (event) => {
    if (!event.dataTransfer?.types.includes("application/x-layer")) return;
    event.preventDefault();
    element.classList.add("drop-target");
  });
  element.addEventListener("dragleave", () => element.classList.remove("drop-target"));
  element.addEventListener("drop", (event) => {
    element.classList.remove("drop-target");
    const name = event.dataTransfer?.getData("application/x-layer");
    if (!name) return;
    event.preventDefault();
    event.stopPropagation();
    move(name, place(layer.name));
  });
}
