// The fixed edge of a region: vertices that stay, and share an edge with one that does not.

import { Vector3 } from "three";
import { IN_REGION } from "../../view/marks";
import type { MeshView } from "../../view/mesh_view";
import type { Region } from "./region";

export class RegionEdge {
  private known: { region: Region; version: number; points: number[] } | null = null;

  /** The mean of its vertices as they are drawn; null where all of the shape may move. */
  middle(region: Region, mesh: MeshView): Vector3 | null {
    if (this.known?.region !== region || this.known.version !== region.version) {
      this.known = { region, version: region.version, points: found(region, mesh) };
    }
    const { points } = this.known;
    const sum = new Vector3();
    for (const point of points) sum.add(new Vector3().fromArray(mesh.positions, 3 * point));
    return points.length ? sum.divideScalar(points.length) : null;
  }
}

function found(region: Region, mesh: MeshView): number[] {
  const edge = new Set<number>();
  const corners = mesh.target.geometry.index!.array;
  for (let at = 0; at < corners.length; at += 3) {
    const points = [0, 1, 2].map((corner) => mesh.pointOf(corners[at + corner]!));
    const fixed = points.filter((point) => !(region.marks[point]! & IN_REGION));
    if (fixed.length < 3) for (const point of fixed) edge.add(point);
  }
  return [...edge];
}
