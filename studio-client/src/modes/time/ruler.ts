// The ruler above the keys: seconds, what is kept for playing, and the playhead, which is dragged along it.

import { t } from "../../core/strings";
import { s } from "../../core/svg";
import type { ClipModel } from "./clip_model";
import { follow } from "./key_area";

export const HEIGHT = 26; // pixels

export class Ruler {
  readonly element = s("svg", { class: "ruler", height: HEIGHT, tabindex: 0, role: "slider" });
  private readonly head = s("path", { class: "playhead-grip", d: "M-6 3h12v8l-6 7-6-7z" });

  constructor(private readonly model: ClipModel) {
    this.element.setAttribute("aria-label", t("timePlayhead"));
    this.element.addEventListener("pointerdown", (event) => this.scrub(event));
    this.element.addEventListener("keydown", (event) => this.key(event));
  }

  show(): void {
    const { span, clip, player } = this.model;
    const { fps, duration } = clip ?? { fps: 24, duration: 1 };
    const { major, minor } = span.ticks(fps);
    const end = span.x(duration);
    const frames = major.some((time) => !isTwentieth(time));
    this.element.setAttribute("width", String(span.width));
    const kept = Array.from({ length: Math.round(duration * fps) + 1 }, (_, i) => i).filter((frame) => player.has(frame));
    const wide = Math.max(span.x(1 / fps) - span.x(0), 1);
    this.element.replaceChildren(
      s("rect", { class: "lasts", x: span.x(0), y: 0, width: Math.max(end - span.x(0), 0), height: HEIGHT }),
      ...minor.map((time) => s("line", { class: "minor", x1: span.x(time), x2: span.x(time), y1: HEIGHT - 5, y2: HEIGHT })),
      ...major.map((time) => s("line", { x1: span.x(time), x2: span.x(time), y1: HEIGHT - 9, y2: HEIGHT })),
      ...major.map((time) => s("text", { x: span.x(time) + 4, y: 12 }, said(time, fps, frames))),
      ...kept.map((frame) => s("rect", { class: "kept", x: span.x(frame / fps) - wide / 2, y: HEIGHT - 2, width: wide, height: 2 })),
      this.head,
    );
    this.place();
  }

  place(): void {
    const { player, span, clip } = this.model;
    const { value } = player.time;
    this.head.setAttribute("transform", `translate(${span.x(value)} 0)`);
    this.element.setAttribute("aria-valuenow", String(Number(value.toFixed(3))));
    this.element.setAttribute("aria-valuemin", "0");
    this.element.setAttribute("aria-valuemax", String(clip?.duration ?? 0));
    this.element.setAttribute("aria-valuetext", `${value.toFixed(2)} s`);
  }

  private scrub(event: PointerEvent): void {
    if (event.button !== 0) return;
    const { model } = this;
    const left = this.element.getBoundingClientRect().left;
    const to = (now: PointerEvent): void => {
      const time = model.snapped(model.span.time(now.clientX - left), now.altKey);
      if (time !== model.player.time.value) model.player.scrub(time);
    };
    to(event);
    follow(event, { move: to, end: () => void model.player.settle(), cancel: () => void model.player.settle() });
  }

  private key(event: KeyboardEvent): void {
    const { player, clip } = this.model;
    const by = { ArrowLeft: -1, ArrowRight: 1, PageUp: 10, PageDown: -10 }[event.key];
    if (by) void player.step(event.shiftKey ? 10 * by : by);
    else if (event.key === "Home") void player.goto(0);
    else if (event.key === "End") void player.goto(clip?.duration ?? 0);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** A tick in seconds, or in frames where these are no round numbers of seconds. */
const said = (time: number, fps: number, frames: boolean): string => (frames ? `${Math.round(time * fps)}` : `${Number(time.toFixed(2))} s`);

const isTwentieth = (time: number): boolean => Math.abs(time * 20 - Math.round(time * 20)) < 1e-6;
