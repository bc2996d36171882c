// The target of a fit: another mesh, translucent over the model, and how the model may move to it.

import type { Box3 } from "three";
import { pickFiles, upload } from "../../core/files";
import { h, replace } from "../../core/dom";
import { t } from "../../core/strings";
import { button, iconButton, row, segments } from "../../panels/controls";
import type { Studio } from "../../studio";
import type { Frame } from "../../transport/frame";
import { GhostMesh } from "../../view/ghost_mesh";

type Pose = "" | "rigid" | "similarity";

export class FitTarget {
  readonly element = h("div", { class: "fit-target" });
  private ghost: GhostMesh | null = null;
  private name = "";
  private pose: Pose = "";

  constructor(
    private readonly studio: Studio,
    private readonly layer: () => string | null,
  ) {}

  get shown(): boolean {
    return this.ghost?.visible ?? false;
  }

  get box(): Box3 | null {
    return this.ghost?.box ?? null;
  }

  enter(): void {
    this.ghost = new GhostMesh(this.studio.viewport);
    void this.ask({});
  }

  leave(): void {
    this.ghost?.dispose();
    this.ghost = null;
  }

  /** The colours of the page are others. */
  look(): void {
    this.ghost?.setColor(this.studio.palette.target);
  }

  build(): HTMLElement {
    const load = button(t("loadTarget"), () => pickFiles((files) => void this.take(files)), { icon: "target" });
    if (!this.name) {
      replace(this.element, h("p", { class: "muted" }, t("targetText")), h("div", { class: "button-row" }, load));
      return this.element;
    }
    const poses = [["", t("poseNone")], ["rigid", t("poseRigid")], ["similarity", t("poseSimilarity")]] as const;
    replace(
      this.element,
      h("div", { class: "target-name" }, h("span", null, this.name), iconButton("close", t("forgetTarget"), () => void this.ask({ forget: true }))),
      row(t("fitPose"), segments<Pose>(poses, this.pose, (pose) => (this.pose = pose))),
      h("div", { class: "button-row" }, button(t("fitToTarget"), () => void this.fit(), { kind: "primary", icon: "target" }), load),
    );
    return this.element;
  }

  /** Fetch what the server keeps beside the scene: another scene has none. */
  refresh(): void {
    void this.ask({});
  }

  async take(files: File[]): Promise<void> {
    if (!files.length) return;
    const name = await upload(this.studio, files, () => undefined);
    if (name === null) return;
    await this.ask({ upload: name });
    if (this.box) this.studio.frame(this.box.union(this.studio.mesh.box));
  }

  private async ask(values: Record<string, unknown>): Promise<void> {
    if (!this.studio.scene?.mesh) return;
    const answer = await this.studio.ask("model.target", values);
    if (answer) this.show(answer);
  }

  private show(answer: Frame): void {
    this.name = answer.head["name"] as string;
    if (this.name) this.ghost?.show(answer, this.studio.palette.target);
    else this.ghost?.hide();
    this.build();
  }

  private async fit(): Promise<void> {
    const layer = this.layer();
    if (layer !== null) await this.studio.ask("model.fit", { layer, pose: this.pose });
  }
}
