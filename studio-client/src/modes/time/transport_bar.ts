// The row of buttons above the timeline: to the keys and the ends, play, the clip's own numbers, recording, what is shown.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, iconButton, numberField, press, select, setNumber, toggle } from "../../panels/controls";
import { separator } from "../point_toolbar";
import type { ClipModel } from "./clip_model";

export interface BarActions {
  templates: () => void;
  film: () => void;
  pin: (on: boolean) => void;
}

const RATES = ["24", "30", "60"] as const;

export class TransportBar {
  readonly element = h("div", { class: "transport", role: "toolbar" });
  private readonly play = iconButton("play", t("timePlay"), () => this.model.player.toggle());
  private readonly pace = h("span", { class: "pace", "aria-live": "off" });
  private seconds: HTMLElement | null = null;
  private frame: HTMLElement | null = null;
  private shown = "";

  constructor(
    private readonly model: ClipModel,
    private readonly actions: BarActions,
  ) {
    this.play.classList.add("play");
    model.player.playing.onChange((on) => this.showPlaying(on));
    model.player.pace.onChange(() => this.showPace());
    model.player.leftOut.onChange(() => this.showPace());
  }

  /** Build it for the clip as it is, unless it is shown so already. */
  show(pinned: boolean, language: string): void {
    const { model } = this;
    const { clip, player } = model;
    if (!clip) return;
    const { duration, fps, ending, recording } = clip;
    const key = JSON.stringify([duration, fps, ending, recording, pinned, language]);
    if (key === this.shown) return this.place();
    this.shown = key;
    const set = (values: Record<string, unknown>): void => void model.studio.ask("time.clip", values);
    this.seconds = numberField(player.time.value, (time) => void player.goto(time), { label: t("timePlayhead"), unit: "s", low: 0, step: 1 / fps });
    this.frame = numberField(0, (frame) => void player.goto(frame / fps), { label: t("timeFrame"), integer: true, low: 0 });
    this.frame.classList.add("whole-frames");
    const length = numberField(duration, (value) => set({ duration: value }), { label: t("timeDuration"), unit: "s", low: 0.01, step: 0.5 });
    const record = toggle("record", t("timeRecord"), recording, (on) => void model.studio.ask("time.record", { on }));
    record.classList.add("record");
    replace(
      this.element,
      iconButton("first", t("timeFirst"), () => void player.goto(0)),
      iconButton("previous", `${t("timePreviousKey")} (,)`, () => model.toKey(-1)),
      this.play,
      iconButton("next", `${t("timeNextKey")} (.)`, () => model.toKey(1)),
      iconButton("last", t("timeLast"), () => void player.goto(duration)),
      record,
      separator(),
      this.seconds,
      this.frame,
      h("span", { class: "of" }, "/"),
      length,
      this.rate(fps, (rate) => set({ fps: rate })),
      select([["once", t("timeOnce")], ["loop", t("timeLoop")], ["ping-pong", t("timePingPong")]], ending, (value) => set({ ending: value }), t("timeEnding")),
      this.pace,
      h("span", { class: "spacer" }),
      this.command("template", t("templates"), this.actions.templates),
      this.command("film", t("timeFilm"), this.actions.film),
      toggle("pin", t("timePin"), pinned, this.actions.pin),
    );
    this.showPlaying(player.playing.value);
    this.place();
  }

  /** The playhead is elsewhere. */
  place(): void {
    const { player } = this.model;
    if (this.seconds) setNumber(this.seconds, Number(player.time.value.toFixed(4)));
    if (this.frame) setNumber(this.frame, player.frameAt(player.time.value));
  }

  /** How many frames a second are seen, of how many; and how many were left out where that is slower than the clock. */
  private showPace(): void {
    const { pace, leftOut } = this.model.player;
    const wanted = this.model.clip?.fps ?? 0;
    const late = leftOut.value > 0 && pace.value < 0.95 * wanted;
    const seen = late ? `${pace.value}/${Math.round(wanted)}` : `${pace.value} fps`;
    replace(this.pace, pace.value ? seen : "", late && pace.value ? h("span", { class: "left-out" }, ` fps −${leftOut.value}`) : null);
    this.pace.title = late ? `${leftOut.value} ${t("timeLeftOut")}` : "";
    this.pace.classList.toggle("late", late);
  }

  /** A button whose word makes room where there is little. */
  private command(icon: "template" | "film", label: string, run: () => void): HTMLElement {
    const each = button(label, run, { icon, kind: "quiet" });
    each.title = each.ariaLabel = label;
    return each;
  }

  private rate(fps: number, set: (fps: number) => void): HTMLElement {
    const known = (RATES as readonly string[]).includes(String(fps));
    const choices = [...RATES.map((rate) => [rate, `${rate} fps`] as const), ...(known ? [] : [[String(fps), `${fps} fps`] as const])];
    return select(choices, String(fps), (rate) => set(Number(rate)), t("timeRate"));
  }

  private showPlaying(on: boolean): void {
    press(this.play, on);
    this.play.querySelector("path")?.setAttribute("d", on ? "M6.5 4.5v11M13.5 4.5v11" : "M6 4l10 6-10 6z");
    this.play.title = this.play.ariaLabel = `${t(on ? "timePause" : "timePlay")} (${t("timeSpace")})`;
  }
}
