// What the inspector says of a transfer: the source and its poses, the list of markers, computing, and playing.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, iconButton, slider } from "../../panels/controls";
import { markerColor, type TransferState } from "./state";

export interface TransferActions {
  load: () => void;
  poses: () => void;
  example: () => void;
  dropPose: (name: string) => void;
  unmark: (index: number | null) => void;
  light: (index: number | null) => void;
  saveMarkers: () => void;
  loadMarkers: () => void;
  compute: () => void;
  weight: (index: number, value: number, done: boolean) => void;
  only: (index: number) => void;
  play: () => void;
  exportPoses: () => void;
}

/** The poses of a layer, and how much there is of each. */
export interface Keys {
  layer: string;
  names: string[];
  weights: number[];
}

export class TransferPanel {
  readonly element = h("div", { class: "transfer-panel" });
  private readonly sliders: HTMLInputElement[] = [];

  constructor(private readonly actions: TransferActions) {}

  show(state: TransferState, keys: Keys | null, playing: boolean): void {
    const scrolled = this.element.querySelector(".marker-list")?.scrollTop ?? 0;
    replace(this.element, this.source(state), state.name !== null && this.markers(state), state.name !== null && this.step(state), keys && this.mixer(keys, playing));
    const list = this.element.querySelector(".marker-list");
    if (list) list.scrollTop = scrolled;
  }

  /** Other weights of the same poses, as they play. */
  follow(weights: readonly number[]): void {
    this.sliders.forEach((input, i) => {
      input.value = String(weights[i] ?? 0);
      input.style.setProperty("--part", `${Math.min(Math.max(weights[i] ?? 0, 0), 1) * 100}%`);
    });
  }

  private source(state: TransferState): HTMLElement {
    const { actions } = this;
    if (state.name === null) {
      return h(
        "div",
        null,
        h("p", { class: "muted" }, t("transferIntro")),
        h(
          "div",
          { class: "button-row" },
          button(t("loadSource"), () => actions.load(), { icon: "open", kind: "primary" }),
          button(t("tryExample"), () => actions.example()),
        ),
      );
    }
    return h(
      "div",
      null,
      h("p", { class: "selection-title" }, state.name),
      h(
        "div",
        { class: "chips" },
        ...state.poses.map((name) =>
          h("span", { class: "chip", title: name }, h("span", null, name), iconButton("close", `${t("remove")}: ${name}`, () => actions.dropPose(name))),
        ),
      ),
      h(
        "div",
        { class: "button-row" },
        button(t("addPoses"), () => actions.poses(), { icon: "plus" }),
        button(t("otherSource"), () => actions.load(), { kind: "quiet" }),
      ),
    );
  }

  private markers(state: TransferState): HTMLElement {
    const { actions } = this;
    const row = ([one, two]: [number, number], i: number): HTMLElement => {
      const element = h(
        "div",
        { class: "marker-row", "data-marker": String(i) },
        h("i", { style: { background: `#${markerColor(i).getHexString()}` } }),
        h("strong", null, String(i + 1)),
        h("span", { class: "muted" }, `${one} → ${two}`),
        iconButton("trash", `${t("remove")} ${i + 1}`, () => actions.unmark(i)),
      );
      element.addEventListener("pointerenter", () => actions.light(i));
      element.addEventListener("pointerleave", () => actions.light(null));
      return element;
    };
    return h(
      "div",
      null,
      h("h4", null, `${t("markers")} · ${state.markers.length}`),
      state.markers.length === 0
        ? h("p", { class: "muted" }, t("markersHint"))
        : h("div", { class: "marker-list" }, ...state.markers.map(row)),
      h(
        "div",
        { class: "button-row" },
        button(t("loadMarkers"), () => actions.loadMarkers(), { icon: "open" }),
        state.markers.length > 0 && button(t("save"), () => actions.saveMarkers(), { icon: "save" }),
        state.markers.length > 0 && button(t("clear"), () => actions.unmark(null), { kind: "quiet" }),
      ),
    );
  }

  private step(state: TransferState): HTMLElement {
    const missing = state.poses.length === 0 ? t("needsPoses") : state.markers.length < 3 ? t("needsMarkers") : null;
    const go = button(t(state.ready ? "computeAgain" : "compute"), () => this.actions.compute(), { kind: "primary", icon: "transfer" });
    go.disabled = missing !== null;
    return h("div", { class: "transfer-step" }, go, missing && h("p", { class: "muted" }, missing));
  }

  private mixer({ names, weights }: Keys, playing: boolean): HTMLElement {
    const { actions } = this;
    this.sliders.length = 0;
    const row = (name: string, i: number): HTMLElement => {
      const control = slider(weights[i]!, {
        label: name,
        low: 0,
        high: 1,
        step: 0.01,
        oninput: (value) => actions.weight(i, value, false),
        ondone: (value) => actions.weight(i, value, true),
      });
      this.sliders.push(control.querySelector("input")!);
      return h(
        "div",
        { class: "pose-row" },
        h("button", { class: "pose-name", type: "button", title: t("onlyThisPose"), onclick: () => actions.only(i) }, name),
        control,
      );
    };
    return h(
      "div",
      null,
      h("h4", null, t("poses")),
      ...names.map(row),
      h(
        "div",
        { class: "button-row" },
        button(t(playing ? "pausePoses" : "playPoses"), () => actions.play(), { icon: playing ? "pause" : "play", kind: "primary" }),
        button(t("exportPoses"), () => actions.exportPoses(), { icon: "export" }),
      ),
    );
  }
}
