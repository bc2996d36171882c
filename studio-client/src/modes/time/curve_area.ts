// The curves of the chosen track: keys dragged in time and value, and the handles of the ways between them.

import { s, lineThrough } from "../../core/svg";
import type { ClipKey, TrackState } from "../../transport/protocol";
import { shortNumber } from "../../panels/controls";
import type { ClipModel } from "./clip_model";
import { follow } from "./key_area";
import { nameOf } from "./selection";
import { fieldTitle } from "./track_list";

const ROOM = 22; // pixels above and below
const SLOP = 3;
type Handles = [number, number, number, number];

export class CurveArea {
  readonly element = s("svg", { class: "curve-area", role: "group" });
  private low = 0;
  private high = 1;
  private height = 100;
  private held = false; // the scale stays while something is dragged

  constructor(private readonly model: ClipModel) {}

  show(track: TrackState | null, height: number): void {
    const { model } = this;
    const { span } = model;
    this.height = height;
    this.element.setAttribute("width", String(span.width));
    this.element.setAttribute("height", String(height));
    if (!track) {
      this.element.replaceChildren();
      return;
    }
    if (!this.held) this.fit(track);
    const end = span.x(model.clip?.duration ?? 0);
    this.element.replaceChildren(
      ...this.levels(),
      ...span.ticks(model.clip?.fps ?? 24).major.map((time) => s("line", { class: "grid", x1: span.x(time), x2: span.x(time), y1: 0, y2: height })),
      s("rect", { class: "beyond", x: end, y: 0, width: Math.max(span.width - end, 0), height }),
      ...track.curves.map((curve, i) => s("path", { class: `curve component-${track.curves.length > 1 ? i : "only"}`, d: this.path(track.times, curve) })),
      ...track.keys.flatMap((key, i) => this.handles(track, i, key)),
      ...track.keys.flatMap((key) => key.value.map((value, component) => this.key(track, key, value, component))),
    );
  }

  private fit(track: TrackState): void {
    const heights = [...track.curves.flat(), ...this.grips(track)];
    this.low = Math.min(...heights);
    this.high = Math.max(...heights);
    if (this.high - this.low < 1e-9) [this.low, this.high] = [this.low - 0.5, this.high + 0.5];
  }

  /** How high the handles are that are shown. */
  private grips(track: TrackState): number[] {
    return track.keys.flatMap((_, at) => {
      const found = this.shownHandles(track, at);
      if (!found) return [];
      const [from, to] = found.ends;
      return [1, 3].map((i) => from + Math.min(Math.max(found.handles[i]!, -2), 3) * (to - from));
    });
  }

  private y(value: number): number {
    return this.height - ROOM - ((value - this.low) / (this.high - this.low)) * (this.height - 2 * ROOM);
  }

  private rise(pixels: number): number {
    return (-pixels / (this.height - 2 * ROOM)) * (this.high - this.low);
  }

  private path(times: number[], curve: number[]): string {
    return lineThrough(times.map((time, i) => [this.model.span.x(time), this.y(curve[i]!)]));
  }

  /** Lines at round values, with what they are. */
  private levels(): SVGElement[] {
    const size = (this.high - this.low) / 4;
    const ten = 10 ** Math.floor(Math.log10(size));
    const step = [1, 2, 5, 10].map((factor) => factor * ten).find((each) => each >= size)!;
    const first = Math.ceil((this.low - size) / step);
    const last = Math.floor((this.high + size) / step);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step).flatMap((value) => [
      s("line", { class: "grid", x1: 0, x2: this.model.span.width, y1: this.y(value), y2: this.y(value) }),
      s("text", { class: "level", x: 4, y: this.y(value) - 3 }, shortNumber(value)),
    ]);
  }

  private key(track: TrackState, key: ClipKey, value: number, component: number): SVGElement {
    const name = nameOf(track, key);
    const element = s("rect", {
      class: `key${this.model.selection.has(name) ? " selected" : ""} component-${track.curves.length > 1 ? component : "only"}`,
      x: this.model.span.x(key.time) - 4,
      y: this.y(value) - 4,
      width: 8,
      height: 8,
      rx: 2,
      tabindex: 0,
      role: "button",
      "data-key": JSON.stringify(name),
      "aria-label": `${fieldTitle(track.field)}, ${Number(key.time.toFixed(3))} s: ${shortNumber(value)}`,
    });
    element.addEventListener("pointerdown", (event) => this.dragKey(event, track, key, component));
    return element;
  }

  private dragKey(event: PointerEvent, track: TrackState, key: ClipKey, component: number): void {
    if (event.button !== 0) return;
    event.stopPropagation();
    const { model } = this;
    const name = nameOf(track, key);
    if (event.shiftKey) model.selection.choose([name], "toggle");
    else if (!model.selection.has(name)) model.selection.choose([name]);
    let by: number | null = null;
    follow(event, {
      move: (now) => {
        const [dx, dy] = [now.clientX - event.clientX, now.clientY - event.clientY];
        if (by === null) {
          if (Math.hypot(dx, dy) < SLOP) return;
          this.held = true;
          model.beginDrag();
        }
        by = Math.abs(dx) < SLOP ? 0 : model.snapped(key.time + model.span.time(dx) - model.span.time(0), now.altKey) - key.time;
        model.moveDrag({ by, rise: track.plain ? this.rise(dy) : 0, component });
      },
      end: () => {
        this.held = false;
        if (by !== null) void model.endDrag(by);
      },
      cancel: () => {
        this.held = false;
        if (by !== null) void model.cancelDrag();
      },
    });
  }

  /** The handles of the way to a key that is selected, or from one. */
  private handles(track: TrackState, at: number, key: ClipKey): SVGElement[] {
    const found = this.shownHandles(track, at);
    if (!found) return [];
    const { span } = this.model;
    const { before, handles, ends: [from, to] } = found;
    const place = (x: number, y: number): [number, number] => [span.x(before.time + x * (key.time - before.time)), this.y(from + y * (to - from))];
    const ends: [number, number][] = [place(0, 0), place(1, 1)];
    return [0, 1].flatMap((which) => {
      const [x, y] = place(handles[2 * which]!, handles[2 * which + 1]!);
      const grip = s("circle", { class: "handle", cx: x, cy: y, r: 4.5, "data-handle": `${at}-${which}` });
      grip.addEventListener("pointerdown", (event) => this.dragHandle(event, track, at, handles, which as 0 | 1, to - from));
      return [s("line", { class: "arm", x1: ends[which]![0], y1: ends[which]![1], x2: x, y2: y }), grip];
    });
  }

  private shownHandles(track: TrackState, at: number): { before: ClipKey; handles: Handles; ends: [number, number] } | null {
    const { selection } = this.model;
    const [before, key] = [track.keys[at - 1], track.keys[at]!];
    const handles = before ? this.handlesOf(key.easing) : null;
    if (!before || !handles || !(selection.has(nameOf(track, key)) || selection.has(nameOf(track, before)))) return null;
    const component = widest(before.value, key.value);
    return { before, handles, ends: [before.value[component]!, key.value[component]!] };
  }

  private dragHandle(event: PointerEvent, track: TrackState, at: number, handles: Handles, which: 0 | 1, tall: number): void {
    event.stopPropagation();
    const { model } = this;
    const key = track.keys[at]!;
    const wide = key.time - track.keys[at - 1]!.time;
    const chosen = model.selection.list;
    let moved = false;
    follow(event, {
      move: (now) => {
        if (!moved) {
          moved = this.held = true;
          model.selection.choose([nameOf(track, key)]);
          model.beginDrag();
        }
        const x = handles[2 * which]! + (model.span.time(now.clientX - event.clientX) - model.span.time(0)) / wide;
        const y = handles[2 * which + 1]! + (Math.abs(tall) > 1e-12 ? this.rise(now.clientY - event.clientY) / tall : 0);
        const easing = [...handles] as Handles;
        easing[2 * which] = Math.min(Math.max(x, 0), 1);
        easing[2 * which + 1] = Math.min(Math.max(y, -8), 8);
        model.moveDrag({ easing });
      },
      end: () => {
        this.held = false;
        if (moved) void model.endDrag(0).then(() => model.selection.choose(chosen));
      },
      cancel: () => {
        this.held = false;
        if (moved) void model.cancelDrag();
      },
    });
  }

  private handlesOf(easing: ClipKey["easing"]): Handles | null {
    if (typeof easing !== "string") return easing;
    return this.model.studio.session.catalogue.value?.easings.find(({ name }) => name === easing)?.handles ?? null;
  }
}

/** The component that changes most. */
function widest(before: number[], after: number[]): number {
  const changes = before.map((value, i) => Math.abs(after[i]! - value));
  return changes.indexOf(Math.max(...changes));
}
