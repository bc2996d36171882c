// The pointer on a landmark, or on a place of the shape that becomes one while it is held: dragged, it is seen elsewhere.

import { Plane, Vector3 } from "three";
import type { Studio } from "../../studio";
import { LayerDrag } from "../layer_drag";
import type { Pointer } from "../mode";
import type { ModelState } from "./model_state";

const SLOP = 3; // pixels that a click may wander

/** A landmark under the pointer, or one that is only being made. */
interface Grab {
  index: number | null;
  plane: Plane;
  offset: Vector3;
  from: Pointer;
  to: Pointer;
  moved: boolean;
  released: boolean;
}

export interface GripActions {
  model: () => ModelState | null;
  /** Fetch the model as it is now. */
  load: () => Promise<void>;
  choose: (landmark: number) => void;
  /** A landmark is elsewhere; it has been let go. */
  moved: () => void;
  ended: () => void;
}

export class LandmarkGrip {
  private grab: Grab | null = null;
  private drag: LayerDrag | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly actions: GripActions,
  ) {}

  /** Whether something is held. */
  get holds(): boolean {
    return this.grab !== null;
  }

  /** Whether the shape follows it, or its end has not been answered yet. */
  get drags(): boolean {
    return this.drag !== null;
  }

  take(pointer: Pointer, model: ModelState, landmark: number): void {
    this.grab = this.at(pointer, model.landmark(landmark), landmark);
  }

  /** Make a vertex a landmark; what the pointer does meanwhile is made up for. */
  async place(pointer: Pointer, model: ModelState, vertex: number): Promise<void> {
    const grab = this.at(pointer, new Vector3().fromArray(this.studio.mesh.positions, 3 * vertex), null);
    this.grab = grab;
    const answer = await this.studio.ask("model.landmark", { layer: model.layer, vertex });
    if (this.grab !== grab) return;
    if (!answer) {
      this.grab = null;
      return;
    }
    await this.actions.load();
    grab.index = answer.head["landmark"] as number;
    this.actions.choose(grab.index);
    if (grab.moved) this.pull(grab);
    if (grab.released) await this.finish();
  }

  move(pointer: Pointer): void {
    const { grab } = this;
    if (!grab) return;
    grab.to = pointer;
    grab.moved ||= Math.hypot(pointer.x - grab.from.x, pointer.y - grab.from.y) >= SLOP;
    if (grab.moved && grab.index !== null) this.pull(grab);
  }

  letGo(): void {
    const { grab } = this;
    if (!grab) return;
    grab.released = true;
    if (grab.index !== null) void this.finish();
  }

  cancel(): void {
    void this.drag?.cancel().then(() => this.actions.ended());
    this.drag = this.grab = null;
  }

  private at(from: Pointer, place: Vector3, index: number | null): Grab {
    const plane = new Plane().setFromNormalAndCoplanarPoint(this.studio.viewport.cameras.direction(), place);
    const under = this.studio.viewport.ray(from.x, from.y).ray.intersectPlane(plane, new Vector3()) ?? place;
    return { index, plane, offset: place.clone().sub(under), from, to: from, moved: false, released: false };
  }

  private pull(grab: Grab): void {
    const model = this.actions.model();
    const to = this.studio.viewport.ray(grab.to.x, grab.to.y).ray.intersectPlane(grab.plane, new Vector3());
    if (!model || !to || grab.index === null) return;
    this.drag ??= new LayerDrag(this.studio, "model", { layer: model.layer, label: "landmark" });
    const goal = to.add(grab.offset).toArray();
    model.positions.set(goal, 3 * grab.index);
    this.actions.moved();
    this.drag.move({}, { index: Uint32Array.of(grab.index), positions: new Float64Array(goal) });
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.grab = null;
    if (!drag) return;
    await drag.commit();
    this.drag = null;
    this.actions.ended();
  }
}
