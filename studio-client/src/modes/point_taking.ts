// What a click takes: one control point, or a whole ring, row or layer of a lattice.

import type { Studio } from "../studio";
import type { ControlPoints } from "./control_points";
import type { Axis, PointTools } from "./points_tools";

export class PointTaking {
  constructor(
    private readonly studio: Studio,
    private readonly tools: PointTools,
  ) {}

  /** What belongs to a control point, as the tools say. */
  with(points: ControlPoints, index: number): number[] {
    const { take } = this.tools.now;
    if (take === "ring") return points.rowOf(index, 0);
    if (take === "row") return points.rowOf(index, 1);
    return take === "layer" ? this.layer(points, index) : [index];
  }

  /** A layer across the axis of a round lattice; of a box, the one that faces the eye. */
  layer(points: ControlPoints, index: number): number[] {
    return points.layerOf(index, points.round ? 2 : this.facing(points));
  }

  /** The layer with a number along an axis. */
  numbered(points: ControlPoints, axis: Axis, number: number): number[] {
    const wanted = Math.min(Math.max(number, 0), points.layers(axis) - 1);
    const first = everyOne(points).find((each) => points.place(each)![axis] === wanted);
    return first === undefined ? [] : points.layerOf(first, axis);
  }

  /** All; none where all are chosen. */
  all(points: ControlPoints): number[] {
    return points.selected.size === points.count ? [] : everyOne(points);
  }

  /** The lattice axis that looks most towards the eye. */
  private facing(points: ControlPoints): Axis {
    const eye = this.studio.viewport.cameras.direction();
    const facing = points.axes.map((axis) => Math.abs(axis.dot(eye)));
    return facing.indexOf(Math.max(...facing)) as Axis;
  }
}

const everyOne = (points: ControlPoints): number[] => [...Array(points.count).keys()];
