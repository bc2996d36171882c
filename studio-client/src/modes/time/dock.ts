// The timeline under the canvas: bar, ruler, names and keys, or curves; as high as somebody drags it.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import type { TrackState } from "../../transport/protocol";
import type { ClipModel } from "./clip_model";
import { CurveArea } from "./curve_area";
import { follow, KeyArea } from "./key_area";
import { Ruler } from "./ruler";
import { rowsOf, TrackList } from "./track_list";
import { segments } from "../../panels/controls";
import { TransportBar, type BarActions } from "./transport_bar";

type View = "keys" | "curves";

const [LEAST, MOST] = [150, 560]; // pixels

export class Dock {
  readonly element = h("section", { class: "dock", "aria-label": t("timeline") });
  private readonly bar: TransportBar;
  private readonly ruler: Ruler;
  private readonly list: TrackList;
  private readonly keys: KeyArea;
  private readonly curves: CurveArea;
  private readonly line = h("div", { class: "playhead-line" });
  private readonly area = h("div", { class: "time-area" });
  private readonly scroller = h("div", { class: "dock-scroll" });
  private readonly corner = h("div", { class: "dock-corner" });
  private readonly empty = h("p", { class: "dock-empty" });
  private view: View = "keys";
  private chosen: { layer: string; field: string } | null = null;
  private pinned = false;
  private asked = false;

  constructor(
    private readonly model: ClipModel,
    actions: BarActions,
  ) {
    const pin = (on: boolean): void => {
      this.pinned = on;
      actions.pin(on);
    };
    this.bar = new TransportBar(model, { ...actions, pin });
    this.ruler = new Ruler(model);
    this.list = new TrackList(model);
    this.keys = new KeyArea(model);
    this.curves = new CurveArea(model);
    this.build();
    for (const signal of [model.redraw, model.selection.changed, model.player.kept]) signal.onChange(() => this.request());
    model.studio.activeLayer.onChange(() => this.request());
    model.player.time.onChange(() => this.place());
    new ResizeObserver(() => this.request()).observe(this.area);
  }

  /** Draw it at the next opportunity. */
  request(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      if (this.element.isConnected) this.draw();
    });
  }

  /** The choice between keys and curves, in the language of the page. */
  private showViews(): void {
    if (this.corner.textContent === t("timeKeys") + t("timeCurves")) return;
    const show = (view: View): void => {
      this.view = view;
      this.request();
    };
    replace(this.corner, segments<View>([["keys", t("timeKeys")], ["curves", t("timeCurves")]], this.view, show));
  }

  private build(): void {
    const grip = h("div", { class: "dock-grip", role: "separator", "aria-orientation": "horizontal", tabindex: 0, "aria-label": t("timeHeight") });
    grip.addEventListener("pointerdown", (event) => this.resize(event));
    grip.addEventListener("keydown", (event) => {
      const by = { ArrowUp: 20, ArrowDown: -20 }[event.key];
      if (by) this.setHeight(this.element.offsetHeight + by);
    });
    this.setHeight(this.model.studio.settings.now.timeline);
    this.area.append(this.keys.element, this.curves.element);
    this.scroller.append(this.list.element, this.area);
    this.element.append(
      grip,
      this.bar.element,
      h("div", { class: "dock-body" }, this.corner, this.ruler.element as unknown as Node, this.scroller, this.line, this.empty),
    );
    for (const element of [this.ruler.element, this.area]) {
      element.addEventListener("wheel", (event) => this.wheel(event as WheelEvent), { passive: false });
    }
  }

  private draw(): void {
    const { model } = this;
    const rows = rowsOf(model);
    const chosen = this.track();
    model.span.width = this.area.clientWidth;
    this.bar.show(this.pinned, model.studio.settings.now.language);
    this.showViews();
    this.ruler.show();
    this.list.show(rows, this.view === "curves" ? chosen : null, (track) => this.choose(track));
    this.keys.element.toggleAttribute("hidden", this.view !== "keys");
    this.curves.element.toggleAttribute("hidden", this.view !== "curves");
    if (this.view === "keys") this.keys.show(rows);
    else this.curves.show(chosen, this.scroller.clientHeight - 1);
    this.empty.textContent = model.tracks.length ? "" : t("timeEmpty");
    this.place();
  }

  /** The playhead is elsewhere: only that is moved. */
  private place(): void {
    if (!this.element.isConnected) return;
    const { span, player } = this.model;
    const x = span.x(player.time.value);
    this.line.hidden = x < 0 || x > span.width;
    this.line.style.left = `${this.area.offsetLeft + x}px`;
    this.ruler.place();
    this.list.place();
    this.bar.place();
  }

  private choose(track: TrackState): void {
    this.chosen = { layer: track.layer, field: track.field };
    this.model.studio.activeLayer.set(track.layer);
    this.request();
  }

  /** The track whose curves are shown: the one chosen, or of the keys selected, or of the active layer. */
  private track(): TrackState | null {
    const { tracks, selection, studio } = this.model;
    const of = (layer: string | undefined, field?: string): TrackState | undefined =>
      tracks.find((track) => track.layer === layer && (field === undefined || track.field === field));
    const [layer, field] = selection.list[0] ?? [];
    return of(layer, field) ?? of(this.chosen?.layer, this.chosen?.field) ?? of(studio.activeLayer.value ?? "") ?? tracks[0] ?? null;
  }

  private wheel(event: WheelEvent): void {
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (!event.ctrlKey && !event.metaKey && !sideways) return; // the rows scroll
    event.preventDefault();
    const { span } = this.model;
    if (event.ctrlKey || event.metaKey) span.zoom(1.0015 ** event.deltaY, event.clientX - this.area.getBoundingClientRect().left);
    else span.pan(sideways);
    this.request();
  }

  private resize(event: PointerEvent): void {
    const start = this.element.offsetHeight;
    const to = (now: PointerEvent): void => this.setHeight(start + event.clientY - now.clientY);
    follow(event, { move: to, end: to, cancel: () => this.setHeight(start) });
  }

  private setHeight(height: number): void {
    const kept = Math.min(Math.max(height, LEAST), MOST);
    this.element.style.height = `${kept}px`;
    if (kept !== this.model.studio.settings.now.timeline) this.model.studio.settings.change({ timeline: kept });
    this.request();
  }
}
