// Files to and from the server: up in pieces over the same channel, down as bytes in an answer.

import type { Studio } from "../studio";
import { t } from "../core/strings";

/** Send files; the server keeps them together under one name, so that an OBJ finds its materials. */
export async function upload(studio: Studio, files: File[], onProgress: (part: number) => void): Promise<string | null> {
  const caps = studio.session.catalogue.value?.caps;
  if (!caps) return null;
  const total = files.reduce((sum, file) => sum + file.size, 0);
  if (total > caps.upload) {
    studio.toasts.error(`${t("uploadTooLarge")}: ${Math.round(caps.upload / 1e6)} MB`);
    return null;
  }
  const begun = await studio.ask("upload.begin", { files: files.map((file) => ({ name: file.name, size: file.size })) });
  if (!begun) return null;
  const name = begun.head["upload"] as string;
  let sent = 0;
  for (const [at, file] of files.entries()) {
    for (let from = 0; from < file.size; from += caps.chunk) {
      const bytes = new Uint8Array(await file.slice(from, from + caps.chunk).arrayBuffer());
      if (!(await studio.ask("upload.chunk", { upload: name, file: at }, { bytes }))) return null;
      sent += bytes.length;
      onProgress(total ? sent / total : 1);
    }
  }
  return name;
}

export function save(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export function pickFiles(onFiles: (files: File[]) => void): void {
  const input = document.createElement("input");
  input.type = "file";
  input.multiple = true;
  input.addEventListener("change", () => onFiles([...(input.files ?? [])]));
  input.click();
}
