// How an iteration converges: the energies of a drag, one after another, on a logarithmic scale.

import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { shortNumber } from "../../panels/controls";

const SVG = "http://www.w3.org/2000/svg";
const [WIDE, HIGH, SHOWN] = [260, 44, 120];

export class Convergence {
  readonly element = h("div", { class: "convergence", hidden: true });
  private readonly text = h("span");
  private readonly line = document.createElementNS(SVG, "polyline");
  energies: number[] = [];
  iterations = 0;
  converged = false;

  constructor() {
    const svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", `0 0 ${WIDE} ${HIGH}`);
    svg.setAttribute("preserveAspectRatio", "none");
    svg.append(this.line);
    replace(this.element, svg as unknown as Node, this.text);
  }

  begin(): void {
    this.energies = [];
    this.iterations = 0;
    this.converged = false;
    this.element.hidden = true;
  }

  /** The handle is released: an iteration that was under way is finished elsewhere, unseen. */
  end(): void {
    if (!this.converged) this.begin();
  }

  /** The energies of one answer: at its beginning, and after each iteration. */
  add(energies: ArrayLike<number>, converged: boolean): void {
    this.energies.push(...Array.from(energies).slice(this.energies.length ? 1 : 0));
    this.iterations += energies.length - 1;
    this.converged = converged;
    this.show();
  }

  private show(): void {
    const shown = this.energies.slice(-SHOWN).map((energy) => Math.log(Math.max(energy, 1e-30)));
    const [low, high] = [Math.min(...shown), Math.max(...shown)];
    const places = shown.map((value, i) => {
      const x = (i / Math.max(shown.length - 1, 1)) * WIDE;
      return `${x.toFixed(1)},${(4 + (1 - (value - low) / (high - low || 1)) * (HIGH - 8)).toFixed(1)}`;
    });
    this.line.setAttribute("points", places.join(" "));
    this.element.classList.toggle("converged", this.converged);
    const energy = shortNumber(Number(this.energies.at(-1)!.toPrecision(3)));
    this.text.textContent = `${this.iterations} ${t("iterations")} · ${t("energy")} ${energy} · ${t(this.converged ? "converged" : "converging")}`;
    this.element.hidden = false;
  }
}
