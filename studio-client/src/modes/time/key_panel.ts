// The selected keys in numbers: when, what, and how each is reached from the one before.

import { h, replace } from "../../core/dom";
import { s, lineThrough } from "../../core/svg";
import { t, tWord } from "../../core/strings";
import { button, numberField, row, select } from "../../panels/controls";
import type { ClipKey, TrackState } from "../../transport/protocol";
import type { ClipModel, Easing } from "./clip_model";
import { fieldTitle } from "./track_list";

const COMPONENTS = ["x", "y", "z"] as const;

export class KeyPanel {
  readonly element = h("div", { class: "key-panel" });

  constructor(private readonly model: ClipModel) {
    model.selection.changed.onChange(() => this.show());
    model.studio.activeLayer.onChange(() => this.show());
    model.studio.settings.all.onChange(() => this.show());
  }

  /** Keys of all tracks of the active layer, or of its first value where it has none. */
  setKeys(): void {
    const layer = this.model.studio.activeLayer.value;
    if (layer === null) return;
    const known = this.model.tracks.filter((track) => track.layer === layer).map((track) => track.field);
    const first = this.model.clip?.keyable[layer]?.[0];
    if (known.length || first) void this.model.setKey(layer, known.length ? known : [first!]);
  }

  show(): void {
    if (this.element.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement) {
      document.activeElement.blur();
    }
    const found = this.model.selection.found(this.model.clip);
    const layer = this.model.studio.activeLayer.value;
    if (!found.length) {
      replace(
        this.element,
        h("p", { class: "muted" }, t("timeNoKey")),
        layer !== null && button(t("timeSetKey"), () => this.setKeys(), { icon: "key" }),
      );
      return;
    }
    const [{ track, key }] = found as [{ track: TrackState; key: ClipKey }];
    replace(
      this.element,
      h("p", { class: "selection-title" }, found.length > 1 ? `${found.length} ${t("timeKeysSelected")}` : `${track.layer}: ${fieldTitle(track.field)}`),
      found.length === 1 && row(t("timeAt"), this.time(track, key)),
      found.length === 1 && track.plain && this.values(track, key),
      row(t("timeEasing"), this.easing(key.easing)),
      this.drawing(key.easing),
      typeof key.easing !== "string" && this.handles(key.easing),
      h(
        "div",
        { class: "button-row" },
        button(t("timeDouble"), () => void this.model.double(), { icon: "layer" }),
        button(t("remove"), () => void this.model.removeSelected(), { icon: "trash" }),
      ),
    );
  }

  private time(track: TrackState, key: ClipKey): HTMLElement {
    const set = (to: number): void => this.change({ by: to - key.time }, to - key.time);
    return numberField(key.time, set, { label: `${t("timeAt")}: ${fieldTitle(track.field)}`, unit: "s", low: 0, step: 1 / (this.model.clip?.fps ?? 24) });
  }

  private values(track: TrackState, key: ClipKey): HTMLElement {
    const one = key.value.length === 1;
    const fields = key.value.map((value, component) => {
      const label = one ? fieldTitle(track.field) : `${fieldTitle(track.field)} ${COMPONENTS[component]!}`;
      const axis = one ? {} : { axis: COMPONENTS[component]! };
      return numberField(value, (to) => this.change({ rise: to - value, component }, 0), { label: `${t("timeValue")}: ${label}`, step: track.unit ? 5 : 0.1, unit: track.unit, ...axis });
    });
    return one ? row(t("timeValue"), fields[0]!) : h("div", null, h("span", { class: "field-label" }, t("timeValue")), h("div", { class: "vector" }, ...fields));
  }

  private change(values: Record<string, unknown>, by: number): void {
    this.model.beginDrag();
    this.model.moveDrag(values);
    void this.model.endDrag(by);
  }

  private easing(now: Easing): HTMLElement {
    const known = this.model.studio.session.catalogue.value?.easings ?? [];
    const choices = known.map(({ name }) => [name, tWord("easing_", name)] as const);
    const own = typeof now === "string" ? [] : [["bezier", t("easing_bezier")] as const];
    return select([...choices, ...own], typeof now === "string" ? now : "bezier", (name) => name !== "bezier" && this.model.ease(name), t("timeEasing"));
  }

  private handles(now: [number, number, number, number]): HTMLElement {
    const set = (at: number, value: number): void => this.model.ease(now.map((old, i) => (i === at ? value : old)) as [number, number, number, number]);
    return h(
      "div",
      { class: "vector handles" },
      ...now.map((value, i) => numberField(Number(value.toFixed(4)), (to) => set(i, to), { label: `${t("timeHandle")} ${"xyxy"[i]!}${i < 2 ? 1 : 2}`, step: 0.05 })),
    );
  }

  /** The way as a small curve, of which the selected key's own track tells the heights. */
  private drawing(easing: Easing): HTMLElement | null {
    const found = this.model.selection.found(this.model.clip)[0];
    const at = found?.track.keys.indexOf(found.key) ?? -1;
    if (!found || at < 1) return null;
    const { track, key } = found;
    const before = track.keys[at - 1]!;
    const component = key.value.map((value, i) => Math.abs(value - before.value[i]!)).reduce((best, change, i, all) => (change > all[best]! ? i : best), 0);
    const tall = key.value[component]! - before.value[component]!;
    if (Math.abs(tall) < 1e-12) return null;
    const points = track.times
      .map((time, i) => [(time - before.time) / (key.time - before.time), (track.curves[component]![i]! - before.value[component]!) / tall] as const)
      .filter(([x]) => x >= -1e-9 && x <= 1 + 1e-9)
      .map(([x, y]) => [10 + 100 * x, 56 - 40 * y] as const);
    const label = typeof easing === "string" ? tWord("easing_", easing) : t("easing_bezier");
    return h("div", { class: "easing-drawing" }, s("svg", { viewBox: "0 0 120 72", role: "img", "aria-label": label }, s("path", { class: "frame", d: "M10 16h100M10 56h100" }), s("path", { class: "curve component-only", d: lineThrough(points) })));
  }

}
