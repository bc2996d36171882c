// Opening things: dropped or chosen files, examples, files of the server's folder, unsaved work.

import { h, replace } from "../core/dom";
import { pickFiles, upload } from "../core/files";
import { icon } from "../core/icons";
import { t } from "../core/strings";
import type { Studio } from "../studio";
import { openDialog } from "./dialog";
import { importTransform } from "./import_dialog";
import type { Progress } from "./progress";

export class Opening {
  constructor(
    private readonly studio: Studio,
    private readonly progress: Progress,
  ) {}

  choose(): void {
    pickFiles((files) => void this.take(files));
  }

  /** Meshes, models and projects are opened; of photographs the face; transforms are imported, where there is a mesh. */
  async take(files: File[]): Promise<void> {
    if (!files.length) return;
    const bar = this.progress.begin(`${t("loading")} ${files[0]!.name}`);
    try {
      const name = await upload(this.studio, files, (part) => bar.show(0.9 * part));
      if (name === null) return;
      const answer = await this.studio.ask("open.upload", { upload: name });
      if (answer?.head["photograph"]) await this.studio.ask("face.open", { upload: name });
      else if (answer?.head["transform"]) importTransform(this.studio, name, answer.head["transform"] as string);
      else if (answer) this.opened(answer.head["notes"] as string[]);
    } finally {
      bar.end();
    }
  }

  async open(command: string, values: Record<string, unknown>): Promise<void> {
    const bar = this.progress.begin(t("loading"));
    const answer = await this.studio.ask(command, values);
    bar.end();
    if (answer) this.opened((answer.head["notes"] as string[] | undefined) ?? []);
  }

  async browse(): Promise<void> {
    const list = h("div", { class: "file-list" });
    const { close } = openDialog(this.studio.root, t("folder"), list);
    const show = async (folder: string): Promise<void> => {
      const answer = await this.studio.ask("folder.list", { folder });
      if (!answer) return;
      const { folders, files } = answer.head as { folders: string[]; files: string[] };
      const up = folder === "" ? null : folder.split("/").slice(0, -1).join("/");
      const entry = (name: string, symbol: "open" | "file", run: () => void): HTMLElement =>
        h("button", { type: "button", class: "file-entry", onclick: run }, icon(symbol) as unknown as Node, h("span", null, name));
      replace(
        list,
        up !== null && entry("..", "open", () => void show(up)),
        ...folders.map((name) => entry(name, "open", () => void show(folder ? `${folder}/${name}` : name))),
        ...files.map((name) =>
          entry(name, "file", () => {
            close();
            void this.open("open.path", { path: folder ? `${folder}/${name}` : name });
          }),
        ),
        !folders.length && !files.length && h("p", { class: "muted" }, t("emptyFolder")),
      );
    };
    await show("");
  }

  private opened(notes: string[]): void {
    this.studio.frame();
    for (const note of notes) this.studio.toasts.info(note);
  }
}
