// Pointers on the canvas go to the mode first; what it leaves turns the view.

import type { Studio } from "../studio";
import type { Pointer } from "./mode";

export function listen(studio: Studio): void {
  const { canvas, element, cameras } = studio.viewport;
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
      if (!studio.mode.value?.down?.(sample(event))) return;
      captured = event.pointerId;
      cameras.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
    },
    true,
  );
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerId === captured) studio.mode.value?.move?.(sample(event));
    else if (event.buttons === 0) studio.mode.value?.hover?.(sample(event));
  });
  const release = (event: PointerEvent): void => {
    if (event.pointerId !== captured) return;
    captured = null;
    cameras.controls.enabled = true;
    studio.mode.value?.up?.(sample(event));
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("blur", () => element.classList.remove("by-pointer"));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
}
