// Pointers on the canvas go to the mode first; what it leaves turns the view.

import type { Studio } from "../studio";
import type { Viewport } from "../view/viewport";
import type { Mode, Pointer } from "./mode";

/** Who takes pointers. */
export type Taker = Pick<Mode, "down" | "move" | "up" | "hover">;

export const listen = (studio: Studio): void => void listenOn(studio.viewport, () => studio.mode.value);

/** Listen to the pointers on a canvas; gives what ends it. */
export function listenOn({ canvas, element, cameras }: Viewport, taker: () => Taker | null): () => void {
  const end = new AbortController();
  const { signal } = end;
  const sample = (event: PointerEvent): Pointer => {
    const box = canvas.getBoundingClientRect();
    return {
      x: event.clientX - box.left,
      y: event.clientY - box.top,
      shift: event.shiftKey,
      alt: event.altKey,
      ctrl: event.ctrlKey || event.metaKey,
      touch: event.pointerType === "touch",
    };
  };
  let captured: number | null = null;
  // In the capture phase, on the parent: before the listeners that orbit.
  element.addEventListener(
    "pointerdown",
    (event) => {
      if (event.target !== canvas || event.button !== 0 || captured !== null) return;
      element.classList.add("by-pointer"); // no ring around the canvas for those who see where they click
      canvas.focus({ preventScroll: true });
      if (!taker()?.down?.(sample(event))) return;
      captured = event.pointerId;
      cameras.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
    },
    { capture: true, signal },
  );
  const move = (event: PointerEvent): void => {
    if (event.pointerId === captured) taker()?.move?.(sample(event));
    else if (event.buttons === 0) taker()?.hover?.(sample(event));
  };
  const release = (event: PointerEvent): void => {
    if (event.pointerId !== captured) return;
    captured = null;
    cameras.controls.enabled = true;
    taker()?.up?.(sample(event));
  };
  canvas.addEventListener("pointermove", move, { signal });
  canvas.addEventListener("pointerup", release, { signal });
  canvas.addEventListener("pointercancel", release, { signal });
  canvas.addEventListener("blur", () => element.classList.remove("by-pointer"), { signal });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
  return () => end.abort();
}
