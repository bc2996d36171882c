// Keys: the mode's own first, then those that mean the same everywhere.

import { isTyping } from "./core/dom";
import type { Mode } from "./modes/mode";
import type { Actions } from "./panels/actions";
import type { Compare } from "./panels/view_tools";
import type { Studio } from "./studio";

interface Parts {
  actions: Actions;
  compare: Compare;
  modes: Mode[];
  setMode: (id: string) => void;
}

export function listenKeys(studio: Studio, { actions, compare, modes, setMode }: Parts): () => void {
  const { settings } = studio;
  const withControl: Record<string, () => void> = {
    z: () => actions.undo(),
    y: () => actions.redo(),
    s: () => actions.save(),
    o: () => actions.open(),
    e: () => actions.export(),
  };
  const plain: Record<string, () => void> = {
    f: () => actions.frame(),
    w: () => settings.change({ wireframe: !settings.now.wireframe }),
    p: () => settings.change({ orthographic: !settings.now.orthographic }),
    c: () => void compare.hold(true),
    "?": () => actions.help(),
  };
  for (const mode of modes) plain[mode.shortcut] = () => setMode(mode.id);

  const down = (event: KeyboardEvent): void => {
    if (isTyping(event) || studio.root.querySelector("dialog[open]")) return;
    const key = event.key.toLowerCase();
    const control = event.ctrlKey || event.metaKey;
    if (control && key === "z" && event.shiftKey) actions.redo();
    else if (control && withControl[key]) withControl[key]();
    else if (control || event.altKey || !studio.scene?.mesh) return;
    else if (event.target instanceof HTMLElement && event.target.tagName === "BUTTON" && (key === " " || key === "enter")) return;
    else if (!event.repeat && studio.mode.value?.key?.(event)) event.stopPropagation();
    else if (!event.repeat && plain[key]) plain[key]();
    else return;
    event.preventDefault();
  };
  const up = (event: KeyboardEvent): void => {
    if (event.key.toLowerCase() === "c" && !isTyping(event)) void compare.hold(false);
  };
  const target = studio.root === document.body ? window : studio.root;
  target.addEventListener("keydown", down as EventListener);
  target.addEventListener("keyup", up as EventListener);
  return () => {
    target.removeEventListener("keydown", down as EventListener);
    target.removeEventListener("keyup", up as EventListener);
  };
}
