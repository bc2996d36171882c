// The fixed edge of a region: vertices that stay, and share a triangle with one that does not.

import { Vector3 } from "three";
import { IN_HANDLE, IN_REGION } from "../../view/marks";
import type { MeshView } from "../../view/mesh_view";
import type { Region } from "./region";

interface Edge {
  points: number[];
  /** Whether a vertex of the handle is next to it: what is between them cannot bend. */
  torn: boolean;
}

export class RegionEdge {
  private known: (Edge & { region: Region; version: number }) | null = null;

  /** The mean of its vertices as they are drawn; null where all of the shape may move. */
  middle(region: Region, mesh: MeshView): Vector3 | null {
    const { points } = this.of(region, mesh);
    const sum = new Vector3();
    for (const point of points) sum.add(new Vector3().fromArray(mesh.positions, 3 * point));
    return points.length ? sum.divideScalar(points.length) : null;
  }

  /** Whether the handle will tear off from what stays. */
  torn(region: Region, mesh: MeshView): boolean {
    return this.of(region, mesh).torn;
  }

  private of(region: Region, mesh: MeshView): Edge {
    if (this.known?.region !== region || this.known.version !== region.version) {
      this.known = { region, version: region.version, ...found(region, mesh) };
    }
    return this.known;
  }
}

function found({ marks }: Region, mesh: MeshView): Edge {
  const edge = new Set<number>();
  let torn = false;
  const corners = mesh.target.geometry.index!.array;
  for (let at = 0; at < corners.length; at += 3) {
    const [a, b, c] = [mesh.pointOf(corners[at]!), mesh.pointOf(corners[at + 1]!), mesh.pointOf(corners[at + 2]!)];
    const any = marks[a]! | marks[b]! | marks[c]!;
    if (!(any & IN_REGION) || marks[a]! & marks[b]! & marks[c]! & IN_REGION) continue;
    torn ||= (any & IN_HANDLE) !== 0;
    for (const point of [a, b, c]) if (!(marks[point]! & IN_REGION)) edge.add(point);
  }
  return { points: [...edge], torn };
}
