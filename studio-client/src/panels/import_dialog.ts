// A transform file: what was found in it, and the choices that the file leaves open, with their effect on the mesh.

import { h, replace } from "../core/dom";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import { row, segments, select, shortNumber } from "./controls";
import { openDialog } from "./dialog";

type Edge = "clamp" | "zero" | "identity";

export function importTransform(studio: Studio, upload: string, file: string): void {
  const fits = (studio.scene?.layers ?? []).filter((layer) => layer.shape);
  const choice = { upload, placement: "physical", variant: "", edge: "clamp" as Edge, into: "" };
  const found = h("div", { class: "preview" });
  const preview = async (): Promise<void> => {
    const answer = await studio.ask("transform.preview", choice);
    if (!answer) {
      replace(found, h("p", { class: "muted" }, "–"));
      return;
    }
    const { summary, warnings, reach, inside } = answer.head as { summary: string; warnings: string[]; reach: number; inside: number };
    replace(
      found,
      h("p", { class: "preview-summary" }, summary),
      row(t("reach"), h("strong", null, shortNumber(reach))),
      row(t("overlap"), h("strong", null, `${Math.round(100 * inside)} %`)),
      ...warnings.map((warning) => h("p", { class: "muted" }, warning)),
    );
    showLattice(studio, answer.arrays["points"] as Float64Array | undefined, answer.arrays["links"] as Uint32Array | undefined);
  };
  const change = (part: Partial<typeof choice>): void => {
    Object.assign(choice, part);
    void preview();
  };
  const isFFD = file.toLowerCase().endsWith(".ffd");
  const body = h(
    "div",
    { class: "form" },
    h("p", { class: "file-name" }, file),
    row(t("placement"), segments([["physical", t("placementPhysical")], ["fit", t("placementFit")]], "physical", (placement) => change({ placement }))),
    isFFD &&
      row(
        t("variant"),
        select([["", t("variantGuess")], ["A", t("variantA")], ["B", t("variantB")], ["C", t("variantC")], ["D", t("variantD")]], "", (variant) => change({ variant }), t("variant")),
      ),
    row(
      t("edge"),
      segments<Edge>([["clamp", t("edgeClamp")], ["zero", t("edgeZero")], ["identity", t("edgeIdentity")]], "clamp", (edge) => change({ edge })),
    ),
    fits.length > 0 &&
      row(
        t("importAs"),
        select([["", t("importNewLayer")], ...fits.map((layer) => [layer.name, `${t("importDisplacements")} ${layer.name}`] as const)], "", (into) => (choice.into = into), t("importAs")),
      ),
    h("h3", null, t("guessed")),
    found,
  );
  const { element } = openDialog(studio.root, t("importTransform"), body, {
    label: t("import"),
    run: async () => {
      const answer = await studio.ask("transform.import", choice);
      if (answer) studio.activeLayer.set(answer.head["layer"] as string);
      return answer !== null;
    },
  });
  element.classList.add("beside"); // the preview behind it stays visible
  element.addEventListener("close", () => showLattice(studio, undefined, undefined));
  void preview();
}

/** The lattice that is about to be imported, drawn over the mesh. */
function showLattice(studio: Studio, points: Float64Array | undefined, links: Uint32Array | undefined): void {
  studio.field.setPreview(points ? new Float32Array(points) : null, links ?? new Uint32Array());
  studio.viewport.request();
}
