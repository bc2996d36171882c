// A new lattice around the mesh: its basis, its control points, its margin, the way it stands.

import { h } from "../core/dom";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import { numberField, row, segments, select, slider } from "./controls";
import { openDialog } from "./dialog";

const MOST = 100_000;

export function newLattice(studio: Studio, basis: "bspline" | "bezier" = "bspline"): void {
  if (!studio.scene?.mesh) return;
  const choice = { basis, shape: [4, 4, 4], margin: 0.05, orientation: "axes" as "axes" | "shape", part: "" };
  const { parts } = studio.scene.mesh;
  const shape = h(
    "div",
    { class: "vector" },
    ...(["x", "y", "z"] as const).map((axis, i) =>
      numberField(4, (count) => (choice.shape[i] = count), { label: `${t("shape")} ${axis}`, axis, integer: true, low: 1 }),
    ),
  );
  const body = h(
    "div",
    { class: "form" },
    row(t("latticeKind"), segments([["bspline", t("bspline")], ["bezier", t("bezier")]], basis, (value) => (choice.basis = value))),
    row(t("shape"), shape),
    parts.length > 0 &&
      row(
        t("around"),
        select([["", t("wholeMesh")], ...parts.map((part) => [part, part] as const)], "", (part) => (choice.part = part), t("around")),
      ),
    row(
      t("margin"),
      slider(choice.margin, {
        label: t("margin"),
        low: 0,
        high: 0.5,
        step: 0.01,
        text: (value) => `${Math.round(100 * value)} %`,
        oninput: (margin) => (choice.margin = margin),
      }),
    ),
    row(
      t("orientation"),
      segments([["axes", t("alongAxes")], ["shape", t("alongShape")]], "axes", (value) => (choice.orientation = value)),
    ),
  );
  openDialog(studio.root, t("newLattice"), body, {
    label: t("create"),
    run: async () => {
      if (choice.shape.reduce((all, each) => all * each, 1) > MOST) {
        studio.toasts.error(t("tooManyPoints"));
        return false;
      }
      const answer = await studio.ask("lattice.add", choice);
      if (answer) studio.activeLayer.set(answer.head["layer"] as string);
      return answer !== null;
    },
  });
}
