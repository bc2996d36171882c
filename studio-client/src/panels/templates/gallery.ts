// The gallery of templates: ready motions, shown on the scene's own mesh; put on it as strong, as long and from when on
// as one likes.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import type { Studio } from "../../studio";
import { button, numberField, row, segments, slider } from "../controls";
import { openDialog } from "../dialog";
import { MovingCards } from "./moving_cards";

interface Template {
  name: string;
  title: string;
  about: string;
  moves: boolean;
  duration: number;
  ending: string;
  own: boolean;
}

export async function openTemplates(studio: Studio, start: number): Promise<void> {
  const answer = await studio.ask("templates.list");
  if (answer) new Gallery(studio, answer.head["templates"] as Template[], start);
}

class Gallery {
  private chosen: Template | null = null;
  private readonly choice: { intensity: number; replace: boolean; duration: number | null };
  private readonly cards: MovingCards;
  private readonly grid = h("div", { class: "template-grid", role: "listbox", "aria-label": t("templates") });
  private readonly side = h("div", { class: "template-side" });
  private readonly close: () => void;

  constructor(
    private readonly studio: Studio,
    private readonly known: Template[],
    private readonly start: number,
  ) {
    this.choice = { intensity: 1, replace: !studio.scene?.layers.length, duration: null };
    this.cards = new MovingCards(studio, this.wanted);
    this.cards.onFailure = (card, why) => {
      card.classList.add("unfit");
      card.setAttribute("title", why);
    };
    const search = h("input", { class: "search", type: "search", placeholder: t("templateSearch"), "aria-label": t("templateSearch") });
    search.addEventListener("input", () => this.fill(search.value.trim().toLowerCase()));
    const { element, close } = openDialog(studio.root, t("templates"), h("div", { class: "gallery" }, h("div", { class: "gallery-main" }, search, this.grid), this.side));
    element.classList.add("wide");
    element.addEventListener("close", () => this.cards.end());
    this.close = close;
    for (const each of known) this.grid.append(this.card(each));
    this.choose(known[0]!);
  }

  private get wanted(): { intensity: number; replace: boolean } {
    return { intensity: this.choice.intensity, replace: this.choice.replace };
  }

  private card(template: Template): HTMLElement {
    const canvas = h("canvas", { class: "template-picture" });
    const card = h(
      "button",
      { class: "template-card", type: "button", role: "option", "data-template": template.name, "aria-selected": "false" },
      canvas,
      h("span", { class: "template-title" }, template.title),
    );
    card.addEventListener("click", () => this.choose(template));
    card.addEventListener("dblclick", () => void this.apply());
    card.addEventListener("keydown", (event) => this.key(event, card));
    this.cards.add(template.name, card, canvas);
    return card;
  }

  private key(event: KeyboardEvent, card: HTMLElement): void {
    const across = Math.max(Math.round(this.grid.clientWidth / card.offsetWidth), 1);
    const by = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -across, ArrowDown: across }[event.key];
    if (by) {
      const shown = [...this.grid.children].filter((each) => !(each as HTMLElement).hidden) as HTMLElement[];
      shown[shown.indexOf(card) + by]?.focus();
      event.preventDefault();
    } else if (event.key === "Enter" && card.getAttribute("aria-selected") === "true") void this.apply();
  }

  private fill(word: string): void {
    for (const card of [...this.grid.children] as HTMLElement[]) {
      const template = this.known.find(({ name }) => name === card.dataset["template"])!;
      card.hidden = !`${template.title} ${template.about}`.toLowerCase().includes(word);
    }
  }

  private choose(template: Template): void {
    this.chosen = template;
    for (const card of [...this.grid.children] as HTMLElement[]) {
      card.setAttribute("aria-selected", String(card.dataset["template"] === template.name));
    }
    this.showSide(template);
  }

  private showSide(template: Template): void {
    const { choice } = this;
    const change = (part: Partial<typeof choice>): void => {
      Object.assign(choice, part);
      this.cards.want(this.wanted);
    };
    const ends = { once: "timeOnce", loop: "timeLoop", "ping-pong": "timePingPong" } as const;
    replace(
      this.side,
      h("h3", null, template.title),
      h("p", { class: "muted" }, template.about),
      template.moves && h("p", { class: "template-facts" }, `${template.duration} s · ${t(ends[template.ending as keyof typeof ends])}`),
      h("span", { class: "field-label" }, t("templateIntensity")),
      slider(choice.intensity, { label: t("templateIntensity"), low: 0, high: 2, step: 0.05, text: (value) => `${Math.round(100 * value)} %`, ondone: (intensity) => change({ intensity }) }),
      template.moves && row(t("timeDuration"), numberField(choice.duration ?? template.duration, (duration) => (choice.duration = duration), { label: t("timeDuration"), unit: "s", low: 0.05, step: 0.5 })),
      (this.studio.scene?.layers.length ?? 0) > 0 &&
        segments<"top" | "anew">([["top", t("templateOnTop")], ["anew", t("templateAnew")]], choice.replace ? "anew" : "top", (how) => change({ replace: how === "anew" })),
      !choice.replace && template.moves && this.start > 0 && h("p", { class: "muted" }, `${t("templateFrom")} ${Number(this.start.toFixed(2))} s`),
      h("div", { class: "spacer" }),
      button(t("templateApply"), () => void this.apply(), { kind: "primary", icon: "check" }),
      (this.studio.scene?.layers.length ?? 0) > 0 && button(t("templateKeep"), () => keepTemplate(this.studio, this.close), { kind: "quiet", icon: "save" }),
    );
  }

  private async apply(): Promise<void> {
    const { chosen, choice, studio } = this;
    if (!chosen) return;
    const values = { name: chosen.name, intensity: choice.intensity, replace: choice.replace, up: studio.settings.now.up, start: this.start };
    const duration = choice.duration === null ? {} : { duration: choice.duration };
    const answer = await studio.ask("templates.apply", { ...values, ...duration });
    if (!answer) return;
    studio.activeLayer.set(answer.head["layer"] as string);
    this.close();
    studio.viewport.canvas.focus({ preventScroll: true });
  }
}

/** Ask what a template of one's own shall be called, and keep it. */
function keepTemplate(studio: Studio, done: () => void): void {
  const title = h("input", { class: "search", "aria-label": t("templateTitle"), value: studio.scene?.name ?? "" });
  const about = h("input", { class: "search", "aria-label": t("templateAbout") });
  const run = async (): Promise<boolean> => {
    const name = title.value.trim().toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "") || "my-template";
    const answer = await studio.ask("templates.save", { name, title: title.value.trim(), about: about.value.trim() });
    if (!answer) return false;
    studio.toasts.info(`${t("templateKept")}: ${title.value}`);
    done();
    return true;
  };
  const form = h("div", { class: "form" }, row(t("templateTitle"), title), row(t("templateAbout"), about), h("p", { class: "muted" }, t("templateKeepText")));
  openDialog(studio.root, t("templateKeep"), form, { label: t("save"), run });
}
