// Clicks on a canvas, while drags go on turning the view.

import type { Viewport } from "./viewport";

const SLOP = 4; // pixels that a click may wander

/** Call at each click, with its pixel from the canvas's upper left corner; gives what ends it. */
export function onClick({ canvas }: Viewport, run: (x: number, y: number, event: PointerEvent) => void): () => void {
  const end = new AbortController();
  const { signal } = end;
  let from: PointerEvent | null = null;
  const down = (event: PointerEvent): void => {
    from = event.button === 0 ? event : null;
  };
  const up = (event: PointerEvent): void => {
    if (!from || Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > SLOP) return;
    const box = canvas.getBoundingClientRect();
    run(event.clientX - box.left, event.clientY - box.top, event);
  };
  canvas.addEventListener("pointerdown", down, { signal });
  canvas.addEventListener("pointerup", up, { signal });
  return () => end.abort();
}
