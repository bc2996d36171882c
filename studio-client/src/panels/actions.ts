// What commands do, whether a button, a menu or a key asks for them.

import { save } from "../core/files";
import { t } from "../core/strings";
import { dragEnded, dragInHand } from "../modes/layer_drag";
import type { Studio } from "../studio";
import { openMenu } from "./deformer_menu";
import { openExport } from "./export_dialog";
import { openHelp } from "./help";
import type { Opening } from "./opening";
import type { Tours } from "./tour";

export class Actions {
  constructor(
    private readonly studio: Studio,
    private readonly opening: Opening,
    private readonly tours: Tours,
  ) {}

  undo(): void {
    void this.go("history.undo", () => this.studio.mode.value?.undo?.() ?? false);
  }

  redo(): void {
    void this.go("history.redo");
  }

  /** What is in hand is given up, and nothing else; what was let go of just now is an entry first. */
  private async go(command: string, instead: () => boolean = () => false): Promise<void> {
    if (dragInHand() && this.studio.mode.value?.key?.(new KeyboardEvent("keydown", { key: "Escape" }))) return;
    await dragEnded();
    if (!instead()) await this.studio.ask(command);
  }

  home(): void {
    if (this.studio.scene?.mesh) void this.studio.ask("scene.close");
  }

  export(): void {
    openExport(this.studio);
  }

  help(): void {
    openHelp(this.studio, this.tours);
  }

  openMenu(anchor: HTMLElement): void {
    openMenu(this.studio.root, anchor, [
      { label: t("openFile"), icon: "open", keys: "Ctrl-O", run: () => this.opening.choose() },
      { label: t("openFromFolder"), icon: "file", run: () => void this.opening.browse() },
      null,
      { label: t("home"), icon: "home", run: () => this.home() },
    ]);
  }

  open(): void {
    this.opening.choose();
  }

  /** The project goes where the browser puts downloads; the server remembers that it was saved. */
  async saveProject(): Promise<void> {
    const answer = await this.studio.ask("project.save");
    if (!answer) return;
    const name = answer.head["name"] as string;
    save(new Blob([answer.arrays["file"] as Uint8Array<ArrayBuffer>]), name);
    this.studio.toasts.info(`${t("saved")}: ${name}`);
  }

  save(): void {
    if (this.studio.scene?.mesh) void this.saveProject();
  }

  frame(): void {
    const box = this.studio.mode.value?.selectionBox?.() ?? undefined;
    this.studio.frame(box);
  }
}
