// Keys as diamonds on the rows of their tracks: selected, dragged along time, gathered by a rectangle.

import { s } from "../../core/svg";
import type { ClipModel } from "./clip_model";
import type { KeyName } from "./selection";
import { nameOf } from "./selection";
import { fieldTitle, ROW, type Row } from "./track_list";

const SIZE = 5.2; // pixels from a diamond's middle to its corner
const SLOP = 3;

export class KeyArea {
  readonly element = s("svg", { class: "key-area", role: "group" });
  private rows: Row[] = [];

  constructor(private readonly model: ClipModel) {
    this.element.addEventListener("pointerdown", (event) => this.down(event));
    this.element.addEventListener("dblclick", (event) => this.add(event));
  }

  show(rows: Row[]): void {
    const { model } = this;
    const { span } = model;
    this.rows = rows;
    const focused = (document.activeElement as SVGElement | null)?.getAttribute("data-key") ?? null;
    this.element.setAttribute("width", String(span.width));
    this.element.setAttribute("height", String(rows.length * ROW));
    const end = span.x(model.clip?.duration ?? 0);
    const parts: SVGElement[] = rows.map((row, i) =>
      s("rect", { class: row.track ? "row" : "row layer", x: 0, y: i * ROW, width: span.width, height: ROW - 1 }),
    );
    parts.push(...span.ticks(model.clip?.fps ?? 24).major.map((time) => s("line", { class: "grid", x1: span.x(time), x2: span.x(time), y1: 0, y2: rows.length * ROW })));
    rows.forEach((row, i) => parts.push(...(row.track ? this.track(row, i) : this.summary(row, i))));
    parts.push(s("rect", { class: "beyond", x: end, y: 0, width: Math.max(span.width - end, 0), height: rows.length * ROW }));
    this.element.replaceChildren(...parts);
    if (focused) this.element.querySelector<SVGElement>(`[data-key="${CSS.escape(focused)}"]`)?.focus();
  }

  private track({ track }: Row, row: number): SVGElement[] {
    const { span, selection } = this.model;
    const y = row * ROW + ROW / 2;
    const { keys } = track!;
    const lines = keys.slice(1).map((key, i) => {
      const still = key.value.every((value, k) => value === keys[i]!.value[k]);
      return s("line", { class: still ? "between still" : "between", x1: span.x(keys[i]!.time), x2: span.x(key.time), y1: y, y2: y });
    });
    return [
      ...lines,
      ...keys.map((key) => {
        const name = nameOf(track!, key);
        return s("path", {
          class: selection.has(name) ? "key selected" : "key",
          d: diamond(span.x(key.time), y),
          "data-key": JSON.stringify(name),
          tabindex: 0,
          role: "button",
          "aria-pressed": String(selection.has(name)),
          "aria-label": `${fieldTitle(track!.field)}, ${Number(key.time.toFixed(3))} s`,
        });
      }),
    ];
  }

  /** All keys of a layer on its own row: one moves those of the same time. */
  private summary({ layer }: Row, row: number): SVGElement[] {
    const { span, selection, tracks } = this.model;
    const names = tracks.filter((track) => track.layer === layer).flatMap((track) => track.keys.map((key) => nameOf(track, key)));
    const times = [...new Set(names.map(([, , time]) => time))];
    return times.map((time) => {
      const same = names.filter((name) => name[2] === time);
      const chosen = same.every((name) => selection.has(name));
      return s("path", { class: chosen ? "key summary selected" : "key summary", d: diamond(span.x(time), row * ROW + ROW / 2), "data-keys": JSON.stringify(same) });
    });
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) return;
    const names = namesAt(event.target);
    if (!names) {
      this.gather(event);
      return;
    }
    const { selection } = this.model;
    const chosen = names.every((name) => selection.has(name));
    if (event.shiftKey) selection.choose(names, "toggle");
    else if (!chosen) selection.choose(names);
    this.drag(event, names);
  }

  /** Move the selected keys by as much as the one that is held. */
  private drag(event: PointerEvent, held: KeyName[]): void {
    const { model } = this;
    const start = held[0]![2];
    let by: number | null = null;
    follow(event, {
      move: (now) => {
        if (by === null) {
          if (Math.abs(now.clientX - event.clientX) < SLOP || !model.selection.size) return;
          model.beginDrag();
        }
        const to = model.snapped(start + model.span.time(now.clientX - event.clientX) - model.span.time(0), now.altKey);
        by = to - start;
        model.moveDrag({ by });
      },
      end: () => void (by === null ? undefined : model.endDrag(by)),
      cancel: () => void (by === null ? undefined : model.cancelDrag()),
    });
  }

  private gather(event: PointerEvent): void {
    const { model, element } = this;
    const box = element.getBoundingClientRect();
    const from = [event.clientX - box.left, event.clientY - box.top] as const;
    const frame = s("rect", { class: "gather" });
    element.append(frame);
    follow(event, {
      move: (now) => {
        const [x, y] = [now.clientX - box.left, now.clientY - box.top];
        frame.setAttribute("x", String(Math.min(x, from[0])));
        frame.setAttribute("y", String(Math.min(y, from[1])));
        frame.setAttribute("width", String(Math.abs(x - from[0])));
        frame.setAttribute("height", String(Math.abs(y - from[1])));
      },
      end: (now) => {
        frame.remove();
        const [left, right] = [from[0], now.clientX - box.left].sort((a, b) => a - b) as [number, number];
        const [top, bottom] = [from[1], now.clientY - box.top].sort((a, b) => a - b) as [number, number];
        model.selection.choose(this.within(left, right, top, bottom), now.shiftKey ? "add" : "only");
      },
      cancel: () => frame.remove(),
    });
  }

  private within(left: number, right: number, top: number, bottom: number): KeyName[] {
    const { span } = this.model;
    return this.rows.flatMap(({ track }, row) => {
      const y = row * ROW + ROW / 2;
      if (!track || y < top || y > bottom) return [];
      return track.keys.filter((key) => span.x(key.time) >= left && span.x(key.time) <= right).map((key) => nameOf(track, key));
    });
  }

  /** A double click sets a key of the row's value, as it is at that time. */
  private add(event: MouseEvent): void {
    const box = this.element.getBoundingClientRect();
    const row = this.rows[Math.floor((event.clientY - box.top) / ROW)];
    if (!row?.track || namesAt(event.target)) return;
    const time = this.model.snapped(this.model.span.time(event.clientX - box.left), event.altKey);
    void this.model.setKey(row.layer, [row.track.field], time);
  }
}

const diamond = (x: number, y: number): string => `M${x} ${y - SIZE}L${x + SIZE} ${y}L${x} ${y + SIZE}L${x - SIZE} ${y}Z`;

function namesAt(target: EventTarget | null): KeyName[] | null {
  if (!(target instanceof SVGElement)) return null;
  if (target.dataset["key"]) return [JSON.parse(target.dataset["key"]) as KeyName];
  return target.dataset["keys"] ? (JSON.parse(target.dataset["keys"]) as KeyName[]) : null;
}

interface Following {
  move: (event: PointerEvent) => void;
  end: (event: PointerEvent) => void;
  cancel: () => void;
}

/** Follow a pointer until it is let go, or Escape gives it up. */
export function follow(begun: PointerEvent, { move, end, cancel }: Following): void {
  const controller = new AbortController();
  const { signal } = controller;
  const stop = (): void => controller.abort();
  const mine = (event: PointerEvent): boolean => event.pointerId === begun.pointerId;
  addEventListener("pointermove", (event) => mine(event) && move(event), { signal });
  addEventListener("pointerup", (event) => mine(event) && (stop(), end(event)), { signal });
  addEventListener("pointercancel", (event) => mine(event) && (stop(), cancel()), { signal });
  const key = (event: KeyboardEvent): void => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    stop();
    cancel();
  };
  addEventListener("keydown", key, { signal, capture: true });
}
