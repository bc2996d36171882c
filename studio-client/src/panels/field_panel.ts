// The deformation of space: grid lines, arrows, colours on the surface with their legend, and folds.

import { Box3, Vector3 } from "three";
import { h, replace } from "../core/dom";
import { icon } from "../core/icons";
import { Signal } from "../core/signal";
import { t, tWord, type StringKey } from "../core/strings";
import { Latest } from "../transport/latest";
import type { Paint, Studio } from "../studio";
import type { Frame } from "../transport/frame";
import { button, checkbox, numberField, row, segments, select, setNumber, slider } from "./controls";
import { withAlpha } from "../view/color_map";
import { Legend } from "./legend";

type Slice = "box" | "x" | "y" | "z";

interface FieldChoice {
  lines: boolean;
  density: number;
  slice: Slice;
  at: number;
  inside: boolean;
  arrows: boolean;
  color: string;
}

interface Fold {
  status: "fold-free" | "folds" | "undecided" | "checking" | "none";
  point?: number[];
  least?: number;
  /** How far a proof is, from 0 to 1. */
  part?: number;
}

export class FieldPanel {
  readonly body = h("div", { class: "field-panel" });
  readonly legend = new Legend();
  readonly choice = new Signal<FieldChoice>({
    lines: false,
    density: 12,
    slice: "box",
    at: 0.5,
    inside: false,
    arrows: false,
    color: "material",
  });
  private fold: Fold = { status: "none" };
  private painted: readonly [Paint, number] | null = null;
  private range: [number, number] | null = null; // null = as the values are
  private found: [number, number] = [0, 1];
  private readonly foldLine = h("div", { class: "fold" });
  private readonly rangeRow = h("div", { class: "range-row", hidden: true });
  private readonly latest = new Latest<null>(() => this.fetch());

  constructor(private readonly studio: Studio) {
    this.choice.onChange(() => this.refresh());
    studio.session.scene.onChange(() => this.refresh());
    studio.pointsMoved.onChange(() => this.refresh());
    studio.paint.onChange(() => this.refresh());
    studio.session.on("fold", (frame) => this.showFold(frame.head["fold"] as Fold));
    this.build();
  }

  private change(part: Partial<FieldChoice>): void {
    this.choice.set({ ...this.choice.value, ...part });
  }

  private build(): void {
    const now = this.choice.value;
    const quantities = this.studio.session.catalogue.value?.quantities ?? [];
    const details = h("div", { class: "indented", hidden: !now.lines });
    replace(
      details,
      row(t("density"), slider(now.density, { label: t("density"), low: 3, high: 40, step: 1, text: String, oninput: (density) => this.change({ density }) })),
      row(
        t("slices"),
        segments<Slice>([["box", t("fullGrid")], ["x", "x"], ["y", "y"], ["z", "z"]], now.slice, (slice) => this.change({ slice })),
      ),
      row(t("position"), slider(now.at, { label: t("slices"), low: 0, high: 1, step: 0.01, text: (v) => `${Math.round(100 * v)} %`, oninput: (at) => this.change({ at }) })),
      checkbox(t("insideOnly"), now.inside, (inside) => this.change({ inside })),
    );
    replace(
      this.body,
      this.foldLine,
      row(
        t("colorBy"),
        select(
          [["material", t("colorTexture")], ...quantities.map((name) => [name, tWord("quantity_", name)] as const)],
          now.color,
          (color) => {
            this.range = null;
            this.change({ color });
          },
          t("colorBy"),
        ),
      ),
      this.rangeRow,
      checkbox(t("gridLines"), now.lines, (lines) => {
        details.hidden = !lines;
        this.change({ lines });
      }),
      details,
      checkbox(t("arrowsShown"), now.arrows, (arrows) => this.change({ arrows })),
    );
    this.showFold(this.fold);
  }

  /** The catalogue has come, or the language is another. */
  rebuild(): void {
    this.build();
  }

  private refresh(): void {
    this.latest.push(null);
  }

  private async fetch(): Promise<void> {
    const { studio } = this;
    const { lines, density, slice, at, inside, arrows, color } = this.choice.value;
    if (!studio.scene?.mesh) return;
    const own = studio.paint.value;
    const colored = !own && color !== "material";
    const grid = lines ? await studio.ask("field.lines", { density, slice, at, inside }) : null;
    const pins = arrows ? await studio.ask("field.arrows", { density }) : null;
    const paint = colored ? await studio.ask("field.color", { quantity: color }) : null;
    studio.field.setLines((grid?.arrays["points"] as Float32Array) ?? null, (grid?.arrays["offsets"] as Uint32Array) ?? new Uint32Array());
    if (own) this.showPaint(own);
    else this.showColors(colored ? paint : null);
    const table = (pins?.arrays["table"] as Uint8Array) ?? new Uint8Array();
    studio.field.setArrows(
      (pins?.arrays["positions"] as Float32Array) ?? null,
      (pins?.arrays["vectors"] as Float32Array) ?? new Float32Array(),
      studio.scene.mesh.diagonal / 400,
      withAlpha(table),
    );
    studio.viewport.request();
  }

  /** What a mode paints with: taken once, since it does not follow the points. */
  private showPaint(paint: Paint): void {
    const { mesh, meshLoaded } = this.studio;
    const key = [paint, meshLoaded.value] as const;
    if (this.painted?.[0] === key[0] && this.painted[1] === key[1]) return;
    this.painted = key;
    this.legend.element.hidden = false;
    this.rangeRow.hidden = true;
    mesh.colorMap.setTable(paint.table);
    mesh.colorMap.setRange(paint.low, paint.high);
    this.legend.show(paint.title, paint.unit, paint.low, paint.high, mesh.colorMap.table);
    mesh.setScalars(paint.values);
  }

  private showColors(paint: Frame | null): void {
    this.painted = null;
    const { mesh } = this.studio;
    if (!paint && this.legend.element.hidden) return; // nothing to take away
    this.legend.element.hidden = !paint;
    this.rangeRow.hidden = !paint;
    if (!paint) {
      mesh.setScalars(null);
      return;
    }
    mesh.colorMap.setTable(paint.arrays["table"]!);
    this.found = [paint.head["low"] as number, paint.head["high"] as number];
    this.showRange(paint);
    mesh.setScalars(paint.arrays["values"] as Float32Array);
  }

  private showRange(paint: Frame): void {
    const [low, high] = this.range ?? this.found;
    this.studio.mesh.colorMap.setRange(low, high);
    const unit = t(`unit${paint.head["unit"] as string}` as StringKey);
    this.legend.show(tWord("quantity_", this.choice.value.color), unit, low, high, this.studio.mesh.colorMap.table);
    if (this.rangeRow.contains(document.activeElement)) return;
    const set = (range: [number, number] | null): void => {
      this.range = range && range[0] < range[1] ? range : null;
      this.showRange(paint);
      this.studio.viewport.request();
    };
    const fields = [low, high].map((value, i) =>
      numberField(value, (next) => set(i ? [low, next] : [next, high]), { label: `${t("range")} ${i ? "↑" : "↓"}`, step: (high - low) / 20 }),
    );
    const reach = slider(1, {
      label: t("range"),
      low: 0.05,
      high: 2,
      step: 0.01,
      oninput: (part) => {
        const middle = this.found[0] < 0 && this.found[1] > 0 ? 0 : this.found[0];
        this.range = [middle + (this.found[0] - middle) * part, middle + (this.found[1] - middle) * part];
        this.studio.mesh.colorMap.setRange(...this.range);
        this.legend.show(tWord("quantity_", this.choice.value.color), unit, ...this.range, this.studio.mesh.colorMap.table);
        fields.forEach((field, i) => setNumber(field, this.range![i]!));
        this.studio.viewport.request();
      },
    });
    replace(this.rangeRow, row(t("range"), ...fields, button(t("autoRange"), () => set(null), { kind: "quiet" })), reach);
  }

  private showFold(fold: Fold): void {
    this.fold = fold;
    const { studio } = this;
    const texts: Record<Fold["status"], StringKey | null> = {
      "fold-free": "foldFree",
      folds: "folds",
      undecided: "undecided",
      checking: "checkingFolds",
      none: null,
    };
    const text = texts[fold.status];
    this.foldLine.className = `fold ${fold.status}`;
    this.foldLine.hidden = text === null;
    const point = fold.status === "folds" && fold.point ? new Vector3(...(fold.point as [number, number, number])) : null;
    studio.field.setMark(point, (studio.scene?.mesh?.diagonal ?? 1) / 40);
    studio.viewport.request();
    if (!text) return;
    const look = (): void => studio.frame(new Box3().setFromCenterAndSize(point!, new Vector3().setScalar(studio.scene!.mesh!.diagonal / 4)));
    replace(
      this.foldLine,
      icon(fold.status === "folds" ? "warning" : "check", 16) as unknown as Node,
      h("span", null, t(text), detail(fold)),
      point && button(t("showFold"), look, { kind: "quiet" }),
      fold.status === "folds" && button(t("limitFold"), () => void studio.ask("field.limit"), { kind: "quiet" }),
    );
  }
}

/** How strongly it folds, or how far the proof is. */
function detail({ status, least, part }: Fold): string {
  if (status === "folds" && least !== undefined) return `: det J = ${least.toPrecision(3)}`;
  return part === undefined ? "" : ` ${Math.round(100 * part)} %`;
}
