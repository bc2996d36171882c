// How control points look: selected, locked, following softly, under the pointer.

import type { paletteOf } from "../view/colors";
import type { Handles } from "../view/handles";
import type { ControlPoints } from "./control_points";
import type { PointDrag } from "./point_drag";

export function paintPoints(
  handles: Handles,
  palette: ReturnType<typeof paletteOf>,
  points: ControlPoints | null,
  held: PointDrag,
  hovered: number | null,
): void {
  handles.setColors(
    (index) => {
      if (points?.selected.has(index)) return palette.selected;
      if (points?.locked.has(index)) return palette.locked;
      const weight = held.weight(index);
      if (weight > 0) return palette.handle.clone().lerp(palette.selected, weight);
      return index === hovered ? palette.hovered : palette.handle;
    },
    (index) => (index === hovered ? 1.35 : points?.selected.has(index) ? 1.2 : 1),
    palette.lattice,
  );
}
