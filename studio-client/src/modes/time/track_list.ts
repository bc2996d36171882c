// The names beside the keys: layers, and under each the values that have keys, or could have.

import { h, replace } from "../../core/dom";
import { icon } from "../../core/icons";
import { t, tWord } from "../../core/strings";
import { iconButton } from "../../panels/controls";
import { openMenu } from "../../panels/deformer_menu";
import type { TrackState } from "../../transport/protocol";
import type { ClipModel } from "./clip_model";

/** A row of the timeline: a layer, with the keys of all its tracks, or one track. */
export interface Row {
  layer: string;
  track: TrackState | null;
}

export const ROW = 26; // pixels

/** The rows of all layers, the topmost first, as the layers panel has them. */
export function rowsOf(model: ClipModel): Row[] {
  const names = (model.studio.scene?.layers ?? []).map((layer) => layer.name).reverse();
  return names.flatMap((layer) => [
    { layer, track: null },
    ...model.tracks.filter((track) => track.layer === layer).map((track) => ({ layer, track })),
  ]);
}

export const fieldTitle = (field: string): string => tWord("field_", field).replaceAll("_", " ");

export class TrackList {
  readonly element = h("div", { class: "track-list", role: "list" });

  private values: [HTMLElement, TrackState][] = [];

  constructor(private readonly model: ClipModel) {}

  show(rows: Row[], chosen: TrackState | null, choose: (track: TrackState) => void): void {
    const active = this.model.studio.activeLayer.value;
    this.values = [];
    replace(this.element, ...rows.map((row) => (row.track ? this.track(row.track, chosen, choose) : this.layer(row.layer, active))));
  }

  /** The playhead is elsewhere: the values are those there. */
  place(): void {
    for (const [element, track] of this.values) element.textContent = valueAt(track, this.model.player.time.value);
  }

  private layer(name: string, active: string | null): HTMLElement {
    const { studio } = this.model;
    return h(
      "div",
      { class: `track-row layer-row${name === active ? " active" : ""}`, role: "listitem", "data-layer": name },
      h("button", { type: "button", class: "track-name", onclick: () => studio.activeLayer.set(name) }, icon("layer", 14) as unknown as Node, h("span", null, name)),
      iconButton("key", `${t("timeSetKey")}: ${name}`, (event) => this.chooseField(event.currentTarget as HTMLElement, name)),
    );
  }

  private track(track: TrackState, chosen: TrackState | null, choose: (track: TrackState) => void): HTMLElement {
    const { model } = this;
    const same = chosen?.layer === track.layer && chosen.field === track.field;
    const title = fieldTitle(track.field);
    const value = h("span", { class: "track-value" });
    this.values.push([value, track]);
    return h(
      "div",
      { class: `track-row${same ? " chosen" : ""}`, role: "listitem", "data-track": `${track.layer}/${track.field}` },
      h("button", { type: "button", class: "track-name", onclick: () => choose(track) }, title),
      value,
      iconButton("key", `${t("timeSetKey")}: ${title}`, () => void model.setKey(track.layer, [track.field])),
    );
  }

  private chooseField(anchor: HTMLElement, layer: string): void {
    const { model } = this;
    const fields = model.clip?.keyable[layer] ?? [];
    const known = new Set(model.tracks.filter((track) => track.layer === layer).map((track) => track.field));
    const all = { label: t("timeKeyAll"), icon: "key" as const, run: () => void model.setKey(layer, [...known]) };
    openMenu(model.studio.root, anchor, [
      ...(known.size ? [all, null] : []),
      ...fields.map((field) => ({ label: fieldTitle(field), checked: known.has(field), run: () => void model.setKey(layer, [field]) })),
    ]);
  }
}

/** What a track of one number says at a time: as its drawn curve does. */
function valueAt({ plain, curves, times, unit }: TrackState, time: number): string {
  if (!plain || curves.length !== 1) return "";
  const curve = curves[0]!;
  const after = times.findIndex((each) => each >= time);
  if (after <= 0) return shown(curve[after === 0 ? 0 : curve.length - 1]!) + unit;
  const [a, b] = [times[after - 1]!, times[after]!];
  return shown(curve[after - 1]! + ((time - a) / (b - a || 1)) * (curve[after]! - curve[after - 1]!)) + unit;
}

const shown = (value: number): string => String(Number(value.toPrecision(4)));
