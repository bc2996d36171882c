// The studio put together: canvas in the middle, modes on the left, the inspector on the right.

import "./modes";
import "./style/index.css";
import { h, replace } from "./core/dom";
import { icon } from "./core/icons";
import { setLanguage, t } from "./core/strings";
import { listenKeys } from "./keys";
import { loadMeshes } from "./loader";
import { listen } from "./modes/input";
import { makeModes, type Mode } from "./modes/mode";
import { Actions } from "./panels/actions";
import { press, iconButton, section } from "./panels/controls";
import { FieldPanel } from "./panels/field_panel";
import { historyPanel } from "./panels/history";
import { layersPanel } from "./panels/layers";
import { Opening } from "./panels/opening";
import { Progress } from "./panels/progress";
import { propertiesPanel } from "./panels/properties";
import { startPage } from "./panels/start";
import { statusBar } from "./panels/status";
import { topBar } from "./panels/topbar";
import { Tours } from "./panels/tour";
import { Compare, viewTools } from "./panels/view_tools";
import { Studio } from "./studio";
import type { Transport } from "./transport/transport";
import { axisGizmo } from "./view/axis_gizmo";

export interface App {
  studio: Studio;
  modes: Mode[];
  setMode: (id: string) => void;
  close: () => void;
}

export interface AppOptions {
  antialias?: boolean;
  /** Whether modes explain themselves when they are entered for the first time. */
  guides?: boolean;
}

export function mount(root: HTMLElement, transport: Transport, { antialias = true, guides = false }: AppOptions = {}): App {
  root.classList.add("studio");
  const studio = new Studio(transport, { antialias, root });
  const progress = new Progress(studio.session);
  const opening = new Opening(studio, progress);
  studio.take = (files) => void opening.take(files);
  const compare = new Compare(studio);
  const modes = makeModes(studio);
  const field = new FieldPanel(studio);
  const setMode = (id: string): void => {
    const next = modes.find((mode) => mode.id === id);
    if (!next || next === studio.mode.value) return;
    studio.mode.value?.leave();
    sessionStorage.setItem("mode", id);
    studio.mode.set(next);
    next.enter();
  };

  studio.enter = setMode;
  const tours = new Tours(studio, modes, setMode, guides);
  const actions = new Actions(studio, opening, tours);

  const build = (): void => {
    setLanguage(studio.settings.now.language);
    root.lang = studio.settings.now.language;
    replace(
      root,
      topBar(studio, actions),
      h(
        "div",
        { class: "workspace" },
        modeRail(studio, modes, setMode),
        h("div", { class: "center" }, stage(studio, actions, compare, field, progress), dock(studio)),
        inspector(studio, field),
        startPage(studio, opening),
      ),
      statusBar(studio),
      studio.toasts.element,
      tours.element,
    );
    field.rebuild();
    studio.session.scene.notify();
    tours.refresh();
  };
  build();
  let language = studio.settings.now.language;
  studio.settings.all.onChange(({ language: now }) => {
    if (now === language) return;
    language = now;
    build();
  });
  studio.session.catalogue.onChange(() => field.rebuild());

  studio.session.on("failure", ({ head }) => studio.toasts.error(head["message"] as string));
  studio.session.on("enter", ({ head }) => setMode(head["mode"] as string)); // what was opened has a mode of its own
  loadMeshes(studio);
  listen(studio);
  const stopKeys = listenKeys(studio, { actions, compare, modes, setMode });
  acceptDrops(root, opening);
  const last = root === document.body ? sessionStorage.getItem("mode") : null;
  setMode("points");
  if (last) goOnIn(studio, () => setMode(last));
  return {
    studio,
    modes,
    setMode,
    close: () => {
      stopKeys();
      studio.session.close();
    },
  };
}

/** A page that is loaded again goes on in the mode that it was in. */
function goOnIn(studio: Studio, enter: () => void): void {
  const stop = studio.meshLoaded.onChange(() => {
    stop();
    enter();
  });
}

function modeRail(studio: Studio, modes: Mode[], setMode: (id: string) => void): HTMLElement {
  const rail = h("nav", { class: "rail", role: "tablist", "aria-orientation": "vertical" });
  const buttons = modes.map((mode) => {
    const each = iconButton(mode.icon, `${t(mode.title)} (${mode.shortcut})`, () => setMode(mode.id));
    each.dataset["mode"] = mode.id;
    return each;
  });
  replace(rail, ...buttons);
  studio.mode.watch((now) => buttons.forEach((each, i) => press(each, modes[i] === now)));
  return rail;
}

function stage(studio: Studio, actions: Actions, compare: Compare, field: FieldPanel, progress: Progress): HTMLElement {
  const bar = h("div", { class: "stage-top" });
  const hint = h("p", { class: "hint" });
  studio.mode.watch((mode) => {
    replace(bar, mode?.toolbar?.());
    hint.textContent = mode ? t(mode.hint) : "";
  });
  return h(
    "div",
    { class: "stage" },
    studio.viewport.element,
    bar,
    axisGizmo(studio.viewport) as unknown as HTMLElement,
    viewTools(studio, actions, compare),
    field.legend.element,
    hint,
    progress.element,
  );
}

function dock(studio: Studio): HTMLElement {
  const element = h("div", { class: "dock-place" });
  const show = (): void => replace(element, studio.mode.value?.dock?.() ?? studio.pinned.value);
  studio.mode.watch(show);
  studio.pinned.onChange(show);
  return element;
}

function inspector(studio: Studio, field: FieldPanel): HTMLElement {
  const element = h("aside", { class: "inspector", "aria-label": t("properties") });
  const { body: layers, tools } = layersPanel(studio);
  const ofMode = h("div", { class: "mode-section" });
  studio.mode.watch((mode) => {
    const panel = mode?.panel?.();
    replace(ofMode, panel && section(t(panel.title), panel.body, `mode-${mode!.id}`));
  });
  replace(
    element,
    section(t("layers"), layers, "layers", tools),
    ofMode,
    section(t("properties"), propertiesPanel(studio), "properties"),
    section(t("field"), field.body, "field"),
    section(t("history"), historyPanel(studio), "history"),
  );
  return element;
}

function acceptDrops(root: HTMLElement, opening: Opening): void {
  const veil = h("div", { class: "drop-veil", hidden: true }, icon("import", 40) as unknown as Node, h("strong", null, t("dropHere")));
  const files = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  root.addEventListener("dragover", (event) => {
    if (!files(event)) return;
    event.preventDefault();
    if (!veil.isConnected) root.append(veil);
    veil.hidden = false;
  });
  root.addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) veil.hidden = true;
  });
  root.addEventListener("drop", (event) => {
    veil.hidden = true;
    if (!files(event)) return;
    event.preventDefault();
    void opening.take([...(event.dataTransfer?.files ?? [])]);
  });
}
