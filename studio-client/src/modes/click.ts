// Clicks on the canvas that no handle took: a press that turns the view is none.

import type { Viewport } from "../view/viewport";

const SLOP = 4; // pixels that a click may wander

/** Listen to clicks, in CSS pixels from the canvas's upper left corner; gives what ends it. */
export function listenClicks({ canvas }: Viewport, click: (x: number, y: number, shift: boolean) => void): () => void {
  const end = new AbortController();
  let from: { x: number; y: number } | null = null;
  canvas.addEventListener(
    "pointerdown",
    (event) => {
      from = event.button === 0 ? { x: event.clientX, y: event.clientY } : null;
    },
    { signal: end.signal },
  );
  canvas.addEventListener(
    "pointerup",
    (event) => {
      const box = canvas.getBoundingClientRect();
      const still = from && Math.hypot(event.clientX - from.x, event.clientY - from.y) < SLOP;
      from = null;
      if (still) click(event.clientX - box.left, event.clientY - box.top, event.shiftKey);
    },
    { signal: end.signal },
  );
  return () => end.abort();
}
