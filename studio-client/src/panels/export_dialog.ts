// Export: the mesh, the deformation, the field, or a picture; what a format cannot hold is shown, never hidden.

import { h, replace } from "../core/dom";
import { save } from "../core/files";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import type { Frame } from "../transport/frame";
import { button, checkbox, numberField, row, segments, select } from "./controls";
import { openDialog } from "./dialog";
import { motionPane } from "./motion_export";

type Tab = "mesh" | "motion" | "transform" | "field" | "picture";

export function openExport(studio: Studio, tab: Tab = "mesh"): void {
  if (!studio.scene?.mesh) return;
  const report = h("div", { class: "report" });
  const pane = h("div", { class: "form" });
  const show = (now: Tab): void => {
    replace(report);
    replace(pane, panes[now]());
  };
  const deliver = async (command: string, values: Record<string, unknown>): Promise<void> => {
    const answer = await studio.ask(command, values);
    if (answer) handOver(answer, report);
  };
  const panes: Record<Tab, () => HTMLElement> = {
    mesh: () => meshPane(studio, deliver),
    motion: () => motionPane(studio, report),
    transform: () => transformPane(studio, deliver),
    field: () => fieldPane(deliver),
    picture: () => picturePane(studio),
  };
  const tabs = segments<Tab>(
    [["mesh", t("exportMesh")], ["motion", t("exportMotion")], ["transform", t("exportTransform")], ["field", t("exportField")], ["picture", t("exportPicture")]],
    tab,
    show,
  );
  show(tab);
  openDialog(studio.root, t("export"), h("div", null, tabs, pane, report));
}

type Deliver = (command: string, values: Record<string, unknown>) => Promise<void>;

function meshPane(studio: Studio, deliver: Deliver): HTMLElement {
  const formats = studio.session.catalogue.value?.meshes ?? [];
  const choices = formats.flatMap((format) => format.suffixes.map((suffix) => [suffix, `${format.name}  (${suffix})`] as const));
  let suffix = choices.find(([each]) => each === ".obj")?.[0] ?? ".ply";
  return h(
    "div",
    null,
    row(t("format"), select(choices, suffix, (value) => (suffix = value), t("format"))),
    download(() => deliver("export.mesh", { suffix })),
  );
}

function transformPane(studio: Studio, deliver: Deliver): HTMLElement {
  const formats = studio.session.catalogue.value?.transforms ?? [];
  const choices = formats.flatMap((format) => format.suffixes.map((suffix) => [suffix, `${format.name}  (${suffix})`] as const));
  const layers = studio.scene?.layers ?? [];
  let suffix = ".ffd";
  let layer = studio.activeLayer.value ?? "";
  return h(
    "div",
    null,
    row(t("which"), select([...layers.map((each) => [each.name, each.name] as const), ["", t("allLayers")] as const], layer, (value) => (layer = value), t("which"))),
    row(t("format"), select(choices, suffix, (value) => (suffix = value), t("format"))),
    download(() => deliver("export.transform", { suffix, layer })),
  );
}

function fieldPane(deliver: Deliver): HTMLElement {
  return h(
    "div",
    { class: "button-column" },
    button(t("exportGrid"), () => void deliver("export.grid", {}), { icon: "field" }),
    button(t("exportSurface"), () => void deliver("export.surface", {}), { icon: "cube" }),
  );
}

function picturePane(studio: Studio): HTMLElement {
  const { width, height } = studio.viewport.size;
  const choice = { width: 2 * width, height: 2 * height, transparent: false, helpers: true };
  return h(
    "div",
    null,
    row(
      `${t("width")} × ${t("height")}`,
      numberField(choice.width, (value) => (choice.width = value), { label: t("width"), integer: true, low: 16 }),
      numberField(choice.height, (value) => (choice.height = value), { label: t("height"), integer: true, low: 16 }),
    ),
    checkbox(t("transparent"), false, (on) => (choice.transparent = on)),
    checkbox(t("modePoints"), true, (on) => (choice.helpers = on)),
    download(async () => {
      const color = getComputedStyle(studio.root).getPropertyValue("--canvas").trim();
      const blob = await studio.viewport.picture(
        Math.min(choice.width, 8192),
        Math.min(choice.height, 8192),
        choice.transparent ? null : color,
        choice.helpers,
      );
      save(blob, `${studio.title}.png`);
    }),
  );
}

const download = (run: () => Promise<void>): HTMLElement =>
  h("div", { class: "button-row end" }, button(t("download"), () => void run(), { kind: "primary", icon: "export" }));

/** Save the files of an answer, and say what they lost. */
export function handOver(answer: Frame, report: HTMLElement): void {
  const { files, losses, notes } = answer.head as { files: string[]; losses: string[]; notes: string[] };
  for (const name of files) save(new Blob([answer.arrays[name] as Uint8Array<ArrayBuffer>]), name);
  replace(
    report,
    h("h3", null, files.join(", ")),
    losses.length ? h("p", { class: "losses-title" }, t("losses")) : h("p", { class: "fine" }, t("wroteNothingLost")),
    ...losses.map((loss) => h("p", { class: "loss" }, loss)),
    ...notes.map((note) => h("p", { class: "muted" }, note)),
  );
}
