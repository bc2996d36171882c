// A new lattice of another shape than a box: cylinder, prism or sphere, around the shape or a part of it.

import { h, replace } from "../core/dom";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import { Latest } from "../transport/latest";
import { reveal } from "../view/reveal";
import { row, segments, select, slider } from "./controls";
import { openDialog } from "./dialog";

type Kind = "cylinder" | "prism" | "sphere";

const PATCHES = [4, 7, 10, 13] as const; // control points along patches that share their ends

export function newExtended(studio: Studio): void {
  if (!studio.scene?.mesh) return;
  const choice = { kind: "cylinder" as Kind, axis: studio.settings.now.up as string, shape: [8, 4, 4], margin: 0.05, part: "" };
  const counts = h("div", { class: "form" });
  const told = h("p", { class: "muted" });
  let shown = new Float32Array();
  const latest = new Latest<null>(async () => {
    const answer = await studio.ask("extended.preview", choice);
    shown = new Float32Array(answer?.arrays["points"] ?? []);
    studio.field.setPreview(shown.length ? shown : null, (answer?.arrays["links"] as Uint32Array) ?? new Uint32Array());
    told.textContent = answer ? `${answer.head["count"] as number} ${t("controlPointsCount")}` : "";
    studio.viewport.request();
  });
  const change = (part: Partial<typeof choice>): void => {
    Object.assign(choice, part);
    latest.push(null);
  };
  const showCounts = (): void => {
    const put = (at: number, value: number): void => change({ shape: choice.shape.map((old, i) => (i === at ? value : old)) });
    const patched = (at: number, label: string): HTMLElement =>
      row(label, segments(PATCHES.map((n) => [String(n), String(n)] as const), String(choice.shape[at]), (n) => put(at, Number(n))));
    const prism = choice.kind === "prism";
    replace(
      counts,
      row(
        t(prism ? "roundSides" : "roundAround"),
        slider(choice.shape[0]!, { label: t("roundAround"), low: prism ? 3 : 5, high: 16, step: 1, text: String, oninput: (n) => put(0, n) }),
      ),
      patched(1, t("roundOut")),
      patched(2, t(choice.kind === "sphere" ? "roundPoles" : "roundAlong")),
    );
  };
  const setKind = (kind: Kind): void => {
    change({ kind, shape: kind === "sphere" ? [8, 4, 7] : kind === "prism" ? [6, 4, 4] : [8, 4, 4] });
    showCounts();
  };
  const { parts } = studio.scene.mesh;
  const body = h(
    "div",
    { class: "form" },
    row(t("roundKind"), segments<Kind>([["cylinder", t("cylinder")], ["prism", t("prism")], ["sphere", t("sphere")]], choice.kind, setKind)),
    row(t("axis"), segments([["x", "x"], ["y", "y"], ["z", "z"]], choice.axis, (axis) => change({ axis }))),
    counts,
    parts.length > 0 &&
      row(
        t("around"),
        select([["", t("wholeMesh")], ...parts.map((part) => [part, part] as const)], "", (part) => change({ part }), t("around")),
      ),
    row(
      t("margin"),
      slider(choice.margin, {
        label: t("margin"),
        low: 0,
        high: 0.5,
        step: 0.01,
        text: (value) => `${Math.round(100 * value)} %`,
        oninput: (margin) => change({ margin }),
      }),
    ),
    told,
  );
  showCounts();
  latest.push(null);
  const { element } = openDialog(studio.root, t("newRound"), body, {
    label: t("create"),
    run: async () => {
      const answer = await studio.ask("extended.add", choice);
      if (!answer) return false;
      studio.activeLayer.set(answer.head["layer"] as string);
      reveal(studio, shown);
      return true;
    },
  });
  element.classList.add("beside");
  element.addEventListener("close", () => {
    void latest.idle().then(() => {
      studio.field.setPreview(null, new Uint32Array());
      studio.viewport.request();
    });
  });
}
