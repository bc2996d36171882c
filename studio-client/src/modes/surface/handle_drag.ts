// The handle in hand: by a gizmo in each view, or by the surface itself; what has moved goes to the server as a map.

import { Matrix4, Plane, Vector3 } from "three";
import type { Studio } from "../../studio";
import type { Frame, Numbers } from "../../transport/frame";
import { Gizmo } from "../../view/gizmo";
import type { Viewport } from "../../view/viewport";
import { LayerDrag } from "../layer_drag";
import type { Pointer } from "../mode";
import type { Convergence } from "./convergence";
import type { MethodSwitch } from "./method_switch";
import type { Chosen } from "./chosen";
import type { SurfaceToolbar } from "./tools";

export class HandleDrag {
  gizmos: Gizmo[] = [];
  axis: 0 | 1 | 2 | null = null;
  private drag: LayerDrag | null = null;
  private matrix: Float64Array | null = null;
  private grab: { plane: Plane; at: Vector3 } | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly tools: SurfaceToolbar,
    private readonly chosen: Chosen,
    private readonly convergence: Convergence,
    private readonly switching: MethodSwitch,
    /** The skeleton has gone along. */
    private readonly carried: (points: Numbers) => void,
  ) {}

  get active(): boolean {
    return this.drag !== null;
  }

  /** Whether the surface itself is held. */
  get grabbed(): boolean {
    return this.grab !== null;
  }

  /** A gizmo in each of some views. */
  showIn(views: Viewport[]): void {
    for (const gizmo of this.gizmos) gizmo.dispose();
    this.gizmos = views.map((view) => {
      const gizmo = new Gizmo(view);
      gizmo.onBegin = () => this.hold();
      gizmo.onMove = (matrix) => this.put(matrix);
      gizmo.onEnd = () => void this.finish();
      return gizmo;
    });
    this.followTools();
  }

  followTools(): void {
    const { mover } = this.tools;
    for (const gizmo of this.gizmos) {
      if (mover) gizmo.setTool(mover);
      gizmo.setAxis(this.axis);
    }
  }

  place(): void {
    const { mover, now } = this.tools;
    const swings = now.method === "skeleton" && mover !== "translate"; // it sees what the handle does about the joint
    const at = mover === null || this.chosen.unseen !== null ? null : swings ? this.chosen.joint : this.chosen.pivot;
    const turn = swings ? this.chosen.limb : null;
    for (const gizmo of this.gizmos) {
      gizmo.useCamera();
      gizmo.place(at, turn);
    }
  }

  /** A place on the ring that twists a limb. */
  get ring(): Vector3 | null {
    const [gizmo] = this.gizmos;
    const { joint, limb } = this.chosen;
    if (!gizmo || !joint || !limb) return null;
    const along = new Vector3(0, 0, 1).applyQuaternion(limb);
    return joint.add(along.cross(this.studio.viewport.cameras.direction()).setLength(gizmo.radius(joint)));
  }

  /** The pointer takes hold of the handle itself, to move it in the plane of the view. */
  take(pointer: Pointer): boolean {
    const { mesh, viewport } = this.studio;
    const hit = mesh.object.visible && viewport.ray(pointer.x, pointer.y).intersectObject(mesh.target, false)[0];
    if (!hit || !hit.face || this.tools.mover !== "translate" || this.chosen.unseen !== null) return false;
    const { a, b, c } = hit.face;
    if (![a, b, c].some((vertex) => this.chosen.holds(mesh.pointOf(vertex)))) return false;
    const plane = new Plane().setFromNormalAndCoplanarPoint(viewport.cameras.direction(), hit.point);
    this.grab = { plane, at: hit.point };
    this.hold();
    return true;
  }

  pull(pointer: Pointer): void {
    const { plane, at } = this.grab!;
    const to = this.studio.viewport.ray(pointer.x, pointer.y).ray.intersectPlane(plane, new Vector3());
    if (!to) return;
    const by = to.sub(at);
    const kept = this.axis === null ? by : new Vector3().setComponent(this.axis, by.getComponent(this.axis));
    this.put(new Matrix4().makeTranslation(kept));
  }

  release(): void {
    this.grab = null;
    void this.finish();
  }

  /** The same handle by another method. */
  send(): void {
    const { method } = this.tools.now;
    this.drag?.move({ method }, this.matrix ? { matrix: this.matrix } : {});
  }

  cancel(): void {
    void this.drag?.cancel();
    this.drag = this.grab = null;
    this.convergence.begin();
    for (const gizmo of this.gizmos) gizmo.cancel();
  }

  dispose(): void {
    this.cancel();
    for (const gizmo of this.gizmos) gizmo.dispose();
    this.gizmos = [];
  }

  private hold(): void {
    const { own, region } = this.chosen;
    this.convergence.begin();
    this.matrix = null;
    const begin = { layer: own ?? "", method: this.tools.now.method };
    const structure = own === null ? { region: region.indices("region"), handle: region.indices("handle") } : {};
    this.drag = new LayerDrag(this.studio, "surface", begin, (arrays, head) => this.answered(arrays, head), structure);
    void this.drag.begun.then((answer) => answer && this.switching.take(answer.head));
  }

  private put(matrix: Matrix4): void {
    this.matrix = new Float64Array(matrix.elements);
    this.send();
  }

  /** What an answer says beside the points; where an iteration has not converged, it goes on. */
  private answered(arrays: Record<string, Numbers>, head: Frame["head"]): void {
    this.switching.take(head);
    if (arrays["skeleton"]) this.carried(arrays["skeleton"]);
    if (!arrays["energies"] || !this.drag) return;
    const converged = arrays["converged"]![0] === 1;
    this.convergence.add(arrays["energies"], converged);
    if (!converged && this.matrix) this.send();
  }

  private async finish(): Promise<void> {
    const { drag } = this;
    this.drag = null; // an iteration goes no further: the server finishes it
    this.convergence.end();
    if (!drag) return;
    const { waits } = this.switching;
    const kept = drag.commit();
    const layer = (await drag.begun)?.head["layer"] as string | undefined;
    if ((await kept) && layer !== undefined) this.chosen.adopt(layer);
    if (waits && this.chosen.own !== null) await this.switching.exchange(this.chosen.own, this.tools.now.method);
    await this.chosen.load();
  }
}
