// What is picked, and whose it is: a layer's, or nobody's yet.

import { Box3, Quaternion, Vector3 } from "three";
import type { Studio } from "../../studio";
import type { Layer } from "../../transport/protocol";
import { IN_HANDLE } from "../../view/marks";
import type { Picked } from "./picking";
import { RegionEdge } from "./region_edge";
import { Region, type Merge, type Part } from "./region";
import type { Method, SurfaceToolbar } from "./tools";

const KINDS = ["laplacian-edit", "arap", "skeleton-edit"];

export class Chosen {
  region = new Region(0);
  /** The layer whose region this is; null where nobody has it yet. */
  own: string | null = null;
  /** While somebody drags, what is picked stays. */
  busy: () => boolean = () => false;
  /** While another method is being bound, the one that is chosen stays. */
  waits: () => boolean = () => false;
  private asked: string | null = null;
  private mesh: number | null = null; // whose vertices are picked
  private readonly edge = new RegionEdge();

  constructor(
    private readonly studio: Studio,
    private readonly tools: SurfaceToolbar,
    /** It looks otherwise now; or it is another thing. */
    private readonly painted: () => void,
    private readonly changed: () => void,
  ) {}

  /** The active layer, if it edits the surface. */
  get layer(): Layer | null {
    const { layer } = this.studio;
    return layer && KINDS.includes(layer.kind) ? layer : null;
  }

  /** The layer whose region this is, where it is muted or another one is alone: what it does is not seen. */
  get unseen(): string | null {
    const layers = this.studio.scene?.layers ?? [];
    const layer = layers.find(({ name }) => name === this.own);
    const alone = layers.some(({ solo }) => solo);
    return layer && (layer.muted || (alone && !layer.solo)) ? layer.name : null;
  }

  /** The middle of the handle, as it is drawn. */
  get pivot(): Vector3 | null {
    const handle = this.region.indices("handle");
    if (!handle.length) return null;
    const sum = new Vector3();
    for (const vertex of handle) sum.add(this.at(vertex));
    return sum.divideScalar(handle.length);
  }

  /** Whether the handle will tear off from what stays. */
  get torn(): boolean {
    return this.edge.torn(this.region, this.studio.mesh);
  }

  /** What a limb swings about: the middle of the region's fixed edge; of the handle where there is none. */
  get joint(): Vector3 | null {
    return this.edge.middle(this.region, this.studio.mesh) ?? this.pivot;
  }

  /** How the axes of a limb lie: the third from the joint to the handle. */
  get limb(): Quaternion | null {
    const { joint, pivot } = this;
    const along = joint && pivot && pivot.clone().sub(joint);
    return along?.length() ? new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), along.normalize()) : null;
  }

  get box(): Box3 | null {
    const box = new Box3();
    for (const vertex of this.region.indices("region")) box.expandByPoint(this.at(vertex));
    return box.isEmpty() ? null : box;
  }

  holds(vertex: number): boolean {
    return (this.region.marks[vertex]! & IN_HANDLE) !== 0;
  }

  /** Another shape: nothing is picked, and the region is first. */
  begin(): void {
    const count = this.studio.mesh.pointCount;
    const mesh = this.studio.scene?.mesh?.id ?? null;
    if (this.region.marks.length === count && this.mesh === mesh) return;
    this.mesh = mesh;
    this.region = new Region(count);
    this.own = null;
    this.tools.change({ part: "region" });
  }

  /** This layer has been made of it. */
  adopt(layer: string): void {
    this.own = layer;
    this.studio.activeLayer.set(layer);
  }

  /** What the active layer is made of. */
  async load(): Promise<void> {
    const { layer } = this;
    this.asked = layer?.name ?? null;
    if (!layer) this.own = null;
    if (!layer || this.busy()) {
      this.changed();
      return;
    }
    const answer = await this.studio.ask("surface.region", { layer: layer.name });
    if (!answer || this.asked !== layer.name || this.busy()) return;
    const { region, handle } = answer.arrays;
    this.region = Region.of(this.studio.mesh.pointCount, region as Uint32Array, handle as Uint32Array);
    this.own = layer.name;
    if (!this.waits()) this.tools.change({ method: answer.head["method"] as Method });
    this.changed();
  }

  /** Where picks go; once one has ended, what is picked is no layer's any more. */
  picked(): Picked {
    let before = new Uint8Array();
    let how: Merge = "only";
    return {
      begin: (wanted) => {
        how = wanted;
        before = this.region.marks.slice();
      },
      show: (indices) => {
        if (before.length !== this.region.marks.length) return;
        this.region.marks.set(before);
        this.region.take(this.tools.now.part, indices, how);
        this.painted();
      },
      more: (indices) => {
        this.region.take(this.tools.now.part, indices, how);
        this.painted();
      },
      end: () => this.leaveLayer(),
      drop: () => {
        if (before.length === this.region.marks.length) this.region.restore(before);
        this.changed();
      },
    };
  }

  async grow(rings: number): Promise<void> {
    const { part } = this.tools.now;
    const index = this.region.indices(part);
    if (!index.length) return;
    this.replace(part, (await this.studio.ask("surface.grow", { rings }, { index }))?.arrays["index"]);
  }

  async recall(name: string, part: Part): Promise<void> {
    this.replace(part, (await this.studio.ask("surface.part", { part: name }))?.arrays["index"]);
  }

  clear(): void {
    this.region.clear("handle");
    if (this.tools.now.part === "region") this.region.clear("region");
    this.leaveLayer();
  }

  /** Give it to the active layer, in place of the layer's own. */
  async give(): Promise<void> {
    const { layer, region } = this;
    if (!layer) return;
    const arrays = { region: region.indices("region"), handle: region.indices("handle") };
    if (await this.studio.ask("surface.restructure", { layer: layer.name }, arrays)) await this.load();
  }

  private replace(part: Part, indices: ArrayLike<number> | undefined): void {
    if (!indices) return;
    this.region.take(part, Array.from(indices), "only");
    this.leaveLayer();
  }

  private leaveLayer(): void {
    this.own = null;
    this.changed();
  }

  private at(vertex: number): Vector3 {
    return new Vector3().fromArray(this.studio.mesh.positions, 3 * vertex);
  }
}
