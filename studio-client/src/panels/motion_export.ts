// Export of the clip: a format, what it can be told, progress with a way to stop, and what the format did not hold.

import { h, replace } from "../core/dom";
import { t, type StringKey } from "../core/strings";
import type { Studio } from "../studio";
import { button, numberField, row, select } from "./controls";
import { handOver } from "./export_dialog";

const FORMATS: [string, string, StringKey][] = [
  [".glb", "glTF (.glb)", "motion_glb"],
  [".usdc", "USD (.usdc)", "motion_usd"],
  [".mp4", "MP4 (.mp4)", "motion_film"],
  [".gif", "GIF (.gif)", "motion_film"],
  [".pc2", "Point cache (.pc2)", "motion_cache"],
  [".mdd", "Point cache (.mdd)", "motion_cache"],
  [".pvd", "ParaView (.pvd)", "motion_pvd"],
  [".abc", "Alembic (.abc)", "motion_usd"],
];
const SIZES = ["1280 × 720", "1920 × 1080", "1080 × 1080", "640 × 360"] as const;
const SMALL = SIZES[3];

export function motionPane(studio: Studio, report: HTMLElement): HTMLElement {
  const choice = { suffix: ".glb", size: SIZES[0] as string, turns: 0 };
  const pane = h("div", null);
  let job: string | null = null;
  const show = (part: number | null = null): void => {
    const [, , about] = FORMATS.find(([suffix]) => suffix === choice.suffix)!;
    const film = about === "motion_film";
    const formats = FORMATS.map(([suffix, title]) => [suffix, title] as const);
    replace(
      pane,
      row(t("format"), select(formats, choice.suffix, (suffix) => choose(suffix), t("format"))),
      h("p", { class: "muted" }, t(about)),
      film && row(t("motionSize"), select(SIZES.map((size) => [size, size] as const), choice.size as (typeof SIZES)[number], (size) => (choice.size = size), t("motionSize"))),
      film && row(t("motionTurns"), numberField(choice.turns, (turns) => (choice.turns = turns), { label: t("motionTurns"), step: 0.5 })),
      job === null
        ? h("div", { class: "button-row end" }, button(t("download"), () => void begin(), { kind: "primary", icon: "film" }))
        : working(part, () => void studio.ask("job.cancel", { job })),
    );
  };
  const choose = (suffix: string): void => {
    choice.suffix = suffix;
    choice.size = suffix === ".gif" ? SMALL : SIZES[0];
    show();
  };
  const begin = async (): Promise<void> => {
    replace(report);
    const [width, height] = choice.size.split(" × ").map(Number) as [number, number];
    const view = studio.viewport.cameras.direction().negate().toArray();
    const { dark, now } = studio.settings;
    const answer = await studio.ask("export.clip", { ...choice, width, height, view, up: now.up, background: dark ? "dark" : "light" });
    if (answer) job = answer.head["job"] as string;
    show();
  };
  const stops = [
    studio.session.on("progress", ({ head }) => {
      if (head["job"] === job && job !== null) show(head["part"] as number | null);
    }),
    studio.session.on("exported", (frame) => {
      handOver(frame, report);
      if (!pane.isConnected) studio.toasts.info((frame.head["files"] as string[]).join(", "), frame.head["losses"] as string[]);
    }),
    studio.session.on("progress-end", ({ head }) => {
      if (head["job"] !== job) return;
      job = null;
      if (pane.isConnected) show();
      else for (const stop of stops) stop();
    }),
  ];
  show();
  return pane;
}

function working(part: number | null, cancel: () => void): HTMLElement {
  const fill = h("div", { class: `progress-fill${part === null ? " indeterminate" : ""}` });
  if (part !== null) fill.style.width = `${100 * part}%`;
  return h(
    "div",
    { class: "working", role: "progressbar", "aria-valuenow": part === null ? undefined : String(Math.round(100 * part)) },
    h("div", { class: "progress-track" }, fill),
    h("span", { class: "muted" }, part === null ? "…" : `${Math.round(100 * part)} %`),
    button(t("cancel"), cancel, { icon: "close" }),
  );
}
