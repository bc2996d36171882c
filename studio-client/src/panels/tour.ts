// First-run guides: a card walks through the parts of a mode, one step at a time, beside what it speaks of. The page
// stays usable below it; it can be skipped, is shown once, and starts anew from the help sheet.

import { h, replace } from "../core/dom";
import { t, type StringKey } from "../core/strings";
import type { Mode } from "../modes/mode";
import type { Studio } from "../studio";
import { button, iconButton } from "./controls";

export interface TourStep {
  /** What the step points at, as a CSS selector; the first that there is of several. The canvas where there is none. */
  at?: string;
  title: StringKey;
  text: StringKey;
}

const GAP = 14;

export class Tours {
  readonly element = h("div", { class: "tours" });
  private running: { mode: Mode; steps: TourStep[]; step: number } | null = null;
  private card: HTMLElement | null = null;
  private readonly ring = h("div", { class: "tour-ring", "aria-hidden": "true" });

  constructor(
    private readonly studio: Studio,
    readonly modes: Mode[],
    private readonly setMode: (id: string) => void,
    /** Whether guides begin by themselves where a mode is entered for the first time. */
    private readonly automatic: boolean,
  ) {
    new ResizeObserver(() => this.place()).observe(studio.root);
    studio.mode.onChange(() => this.welcome());
    studio.session.scene.onChange(() => this.welcome());
  }

  /** The modes that have a guide. */
  get guided(): Mode[] {
    return this.modes.filter((mode) => mode.tour !== undefined);
  }

  /** Show the guide of a mode, whether it was seen before or not. */
  start(mode: Mode): void {
    const steps = mode.tour?.() ?? [];
    if (!steps.length) return;
    this.setMode(mode.id);
    this.running = { mode, steps, step: 0 };
    this.show();
  }

  /** Draw the card anew, as after a change of the language. */
  refresh(): void {
    if (this.running) this.show();
  }

  /** Begin where a mode is new to this person; end where the mode or the shape has gone. */
  private welcome(): void {
    const mode = this.studio.mode.value;
    const { guides, guided } = this.studio.settings.now;
    const shown = this.studio.scene?.mesh !== null;
    if (this.running && (!shown || this.running.mode !== mode)) this.close();
    if (this.running || !this.automatic || !guides || !shown || !this.studio.scene) return;
    if (mode?.tour && !guided.includes(mode.id)) this.start(mode);
  }

  private show(): void {
    const { mode, steps, step } = this.running!;
    const { title, text } = steps[step]!;
    const last = step === steps.length - 1;
    const next = button(t(last ? "tourDone" : "tourNext"), () => (last ? this.end() : this.go(1)), { kind: "primary" });
    this.card = h(
      "section",
      { class: "tour", role: "dialog", "aria-labelledby": "tour-title", "aria-describedby": "tour-text" },
      h(
        "div",
        { class: "tour-head" },
        h("span", { class: "tour-mode" }, t(mode.title)),
        iconButton("close", t("tourSkip"), () => this.end()),
      ),
      h("h3", { id: "tour-title" }, t(title)),
      h("p", { id: "tour-text" }, t(text)),
      h(
        "div",
        { class: "tour-foot" },
        h("span", { class: "tour-count", "aria-label": `${step + 1} / ${steps.length}` }, ...dots(step, steps.length)),
        step === 0 && this.automatic && button(t("tourNever"), () => this.never(), { kind: "quiet" }),
        step > 0 && button(t("tourBack"), () => this.go(-1), { kind: "quiet" }),
        next,
      ),
    );
    this.card.addEventListener("keydown", (event) => this.key(event));
    replace(this.element, this.ring, this.card);
    this.place();
    requestAnimationFrame(() => this.place()); // the panel that it speaks of may come after it
    next.focus({ preventScroll: true });
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "Escape") this.end();
    else if (event.key === "ArrowRight" && this.running!.step < this.running!.steps.length - 1) this.go(1);
    else if (event.key === "ArrowLeft" && this.running!.step > 0) this.go(-1);
    else return;
    event.stopPropagation();
    event.preventDefault();
  }

  private go(by: 1 | -1): void {
    this.running!.step += by;
    this.show();
  }

  /** Read or skipped: this guide does not come by itself again. */
  private end(): void {
    const { guided } = this.studio.settings.now;
    const { id } = this.running!.mode;
    this.studio.settings.change({ guided: [...new Set([...guided, id])] });
    this.close();
    this.studio.viewport.canvas.focus({ preventScroll: true });
  }

  private never(): void {
    this.studio.settings.change({ guides: false });
    this.end();
  }

  private close(): void {
    this.running = this.card = null;
    replace(this.element);
  }

  /** The card stands beside what it speaks of, on the side that has room; else low on the canvas. */
  private place(): void {
    const { card, ring, running } = this;
    if (!card || !running) return;
    const page = this.studio.root.getBoundingClientRect();
    const stage = (this.studio.viewport.element.closest(".stage") ?? this.studio.viewport.element).getBoundingClientRect();
    const target = this.target(running.steps[running.step]!.at);
    const { offsetWidth: width, offsetHeight: height } = card;
    encircle(ring, target ?? inside(stage), page);
    let [x, y] = [stage.left + GAP, stage.bottom - height - 3 * GAP];
    if (target) [x, y] = beside(target, page, width, height);
    const left = Math.min(Math.max(x, page.left + 8), page.right - width - 8) - page.left;
    const top = Math.min(Math.max(y, page.top + 8), page.bottom - height - 8) - page.top;
    Object.assign(card.style, pixels({ left, top }));
  }

  private target(selector: string | undefined): DOMRect | null {
    const found = (selector ?? "").split(",").map((each) => each.trim() && this.studio.root.querySelector(each));
    const element = found.find((each) => each instanceof Element && each.getClientRects().length) || null;
    element?.scrollIntoView({ block: "nearest" });
    const box = element?.getBoundingClientRect();
    return box && box.width > 0 && box.height > 0 ? box : null;
  }
}

function beside(target: DOMRect, page: DOMRect, width: number, height: number): [number, number] {
  const middle = target.top + target.height / 2 - height / 2;
  const center = target.left + target.width / 2 - width / 2;
  if (target.width < page.width / 2) {
    if (target.right + GAP + width < page.right) return [target.right + GAP, middle];
    if (target.left - GAP - width > page.left) return [target.left - GAP - width, middle];
  }
  return target.bottom + GAP + height < page.bottom ? [center, target.bottom + GAP] : [center, target.top - GAP - height];
}

/** Draw the ring around a place, clear of it, but on the page. */
function encircle(ring: HTMLElement, { left, top, right, bottom }: DOMRect, page: DOMRect): void {
  const [x, y] = [Math.max(left - 4, page.left + 1), Math.max(top - 4, page.top + 1)];
  const [width, height] = [Math.min(right + 4, page.right - 1) - x, Math.min(bottom + 4, page.bottom - 1) - y];
  Object.assign(ring.style, pixels({ left: x - page.left, top: y - page.top, width, height }));
}

const inside = ({ left, top, width, height }: DOMRect): DOMRect => new DOMRect(left + 6, top + 6, width - 12, height - 12);

const dots = (now: number, count: number): HTMLElement[] =>
  Array.from({ length: count }, (_, i) => h("i", { class: i === now ? "now" : "" }));

const pixels = (values: Record<string, number>): Record<string, string> =>
  Object.fromEntries(Object.entries(values).map(([name, value]) => [name, `${value}px`]));
