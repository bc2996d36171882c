// A tool that moves over the object, or an object that moves through a tool: the gizmo places the active layer as a
// whole, and each place is a key at the playhead.

import { Matrix4, Vector3 } from "three";
import { Gizmo, type Tool } from "../../view/gizmo";
import { Way } from "../../view/way";
import type { Studio } from "../../studio";
import { LayerDrag } from "../layer_drag";

export class Placer {
  tool: Tool = "translate";
  private gizmo: Gizmo | null = null;
  private way: Way | null = null;
  private drag: LayerDrag | null = null;
  private pivot: Vector3 | null = null;
  private stops: (() => void)[] = [];

  constructor(private readonly studio: Studio) {}

  get on(): boolean {
    return this.gizmo !== null;
  }

  /** The camera may be another one than before. */
  useCamera(): void {
    this.gizmo?.useCamera();
  }

  /** Where the gizmo stands on the canvas; null where there is none. */
  get screen(): { x: number; y: number } | null {
    return this.gizmo && this.pivot ? this.studio.viewport.project(this.pivot) : null;
  }

  start(): void {
    if (this.on) return;
    const { viewport, session, activeLayer } = this.studio;
    this.gizmo = new Gizmo(viewport);
    this.way = new Way(viewport);
    this.gizmo.onBegin = () => {
      const layer = activeLayer.value;
      if (layer !== null) this.drag = new LayerDrag(this.studio, "place", { layer });
    };
    this.gizmo.onMove = (matrix) => this.drag?.move({ matrix: rows(matrix) }, {});
    this.gizmo.onEnd = () => void this.finish();
    this.gizmo.setTool(this.tool);
    this.stops = [session.scene.onChange(() => void this.load()), activeLayer.onChange(() => void this.load())];
    void this.load();
  }

  stop(): void {
    for (const stop of this.stops) stop();
    this.gizmo?.dispose();
    this.way?.dispose();
    this.gizmo = this.way = this.pivot = null;
    this.studio.viewport.request();
  }

  setTool(tool: Tool): void {
    this.tool = tool;
    this.gizmo?.setTool(tool);
  }

  /** Let go without finishing. */
  cancel(): boolean {
    const { drag } = this;
    if (!drag) return false;
    this.drag = null;
    this.gizmo?.cancel();
    void drag.cancel();
    return true;
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.drag = null;
    await drag?.commit();
    await this.load();
  }

  private async load(): Promise<void> {
    if (this.drag) return;
    const layer = this.studio.activeLayer.value;
    const answer = layer === null || !this.studio.scene?.mesh ? null : await this.studio.ask("place.get", { layer });
    if (!this.gizmo) return;
    const { placeable, pivot } = (answer?.head ?? {}) as { placeable?: boolean; pivot?: number[] };
    this.pivot = placeable && pivot ? new Vector3().fromArray(pivot) : null;
    this.gizmo.place(this.pivot);
    const none = new Float64Array();
    const [way, keys] = [answer?.arrays["way"] ?? none, answer?.arrays["keys"] ?? none] as Float64Array[];
    this.way?.show(way!, keys!, this.studio.palette.selected);
  }
}

/** A matrix as its rows, one after another. */
const rows = (matrix: Matrix4): number[] => matrix.clone().transpose().elements.slice();
