// A cage that is there: whether it is sound, its coordinates, and what others would make of the same edit.

import { h, replace } from "../../core/dom";
import { icon } from "../../core/icons";
import { t, tWord, type StringKey } from "../../core/strings";
import { button, press, row, select } from "../../panels/controls";
import { KINDS } from "./build_panel";

export interface Report {
  ok: boolean;
  failures: string[];
  vertices: number;
  faces: number;
  genus: number | null;
  volume_ratio: number | null;
  clearance: number;
  manifold: boolean;
  simple: boolean;
  encloses: boolean;
}

export interface Row {
  coordinates: string;
  away: number;
  volume: number | null;
}

export interface CageActions {
  exchange: (kind: string) => void;
  compare: () => void;
  showOther: (kind: string | null) => void;
  beside: (kinds: string[]) => void;
}

export class CagePanel {
  readonly element = h("div", { class: "cage-panel" });
  private report: Report | null = null;
  private leftOut: string[] = [];
  private rows: Row[] = [];
  private other: string | null = null;
  private kind = "mean_value";
  private beside: string[] = [];

  constructor(private readonly actions: CageActions) {}

  show(kind: string): void {
    this.kind = kind;
    if (this.beside.includes(kind)) this.actions.beside((this.beside = this.beside.filter((each) => each !== kind)));
    this.fill();
  }

  forgetBeside(): void {
    this.beside = [];
  }

  setReport(report: Report | null): void {
    this.report = report;
    this.fill();
  }

  /** The planes that have no ring in this cage, and why. */
  setLeftOut(planes: string[]): void {
    this.leftOut = planes;
    this.fill();
  }

  setRows(rows: Row[], other: string | null): void {
    this.rows = rows;
    this.other = other;
    this.fill();
  }

  private fill(): void {
    replace(
      this.element,
      this.verification(),
      row(
        t("coordinates"),
        select(KINDS.map((kind) => [kind, tWord("coordinates_", kind)] as const), this.kind as "green", (kind) => this.actions.exchange(kind), t("coordinates")),
      ),
      ...this.sides(),
      h("div", { class: "button-row" }, button(t("compareCoordinates"), this.actions.compare, { icon: "compare" })),
      this.rows.length > 0 && this.comparison(),
    );
  }

  /** Which coordinates stand beside the present ones: one, then another one. */
  private sides(): HTMLElement[] {
    const choices = (at: number): string[] => KINDS.filter((kind) => kind !== this.kind && kind !== this.beside[1 - at]);
    const choose = (at: number, kind: string): void => {
      this.beside = [...this.beside.slice(0, at), kind, ...this.beside.slice(at + 1)].filter((each) => each !== "");
      this.actions.beside(this.beside);
      this.fill();
    };
    return (["cageBeside", "cageBesideToo"] as const).slice(0, this.beside.length + 1).map((key, at) =>
      row(
        t(key),
        select([["", t("mirrorOff")], ...choices(at).map((kind) => [kind, tWord("coordinates_", kind)] as [string, string])], this.beside[at] ?? "", (kind) => choose(at, kind), t(key)),
      ),
    );
  }

  private verification(): HTMLElement {
    const { report } = this;
    if (!report) return h("p", { class: "muted" }, t("cageChecking"));
    const lines: [boolean, StringKey][] = [
      [report.encloses, "cageEncloses"],
      [report.manifold, "cageManifold"],
      [report.simple, "cageSimple"],
    ];
    const ratio = report.volume_ratio === null ? "" : ` · ${report.volume_ratio.toFixed(2)} × ${t("cageVolume")}`;
    return h(
      "ul",
      { class: "cage-report" },
      ...lines.map(([good, key]) => h("li", { class: good ? "good" : "bad" }, icon(good ? "check" : "warning", 15) as unknown as Node, h("span", null, t(key)))),
      h("li", { class: "muted" }, h("span", null, `${report.vertices} ${t("vertices")}, ${report.faces} ${t("faces")}${ratio}`)),
      ...this.leftOut.map((plane) => h("li", { class: "left-out" }, icon("warning", 15) as unknown as Node, h("span", null, `${t("planeLeftOut")} ${plane}`))),
      ...report.failures.map((failure) => h("li", { class: "bad" }, h("span", null, failure))),
    );
  }

  private comparison(): HTMLElement {
    return h(
      "div",
      { class: "cage-comparison", role: "group", "aria-label": t("compareCoordinates") },
      ...this.rows.map(({ coordinates, away, volume }) => {
        const line = h(
          "button",
          { type: "button", class: "cage-row", onclick: () => this.actions.showOther(coordinates === this.other ? null : coordinates) },
          h("span", null, tWord("coordinates_", coordinates)),
          h("span", { class: "muted" }, `${(100 * away).toFixed(2)} %`),
          h("span", { class: "muted" }, volume === null ? "–" : `${(100 * volume).toFixed(1)} %`),
        );
        press(line, coordinates === this.other);
        return line;
      }),
      h("p", { class: "muted" }, t("compareLegend")),
    );
  }
}
