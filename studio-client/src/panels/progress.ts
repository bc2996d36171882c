// Long work: what is being done, how far it is, and a way to stop it.

import { h } from "../core/dom";
import { t, tWord } from "../core/strings";
import type { Session } from "../transport/session";
import { iconButton } from "./controls";

const PATIENCE = 250; // milliseconds before anything is shown

export interface ProgressBar {
  show: (part: number | null) => void;
  end: () => void;
}

export class Progress {
  readonly element = h("div", { class: "progress-list" });
  private readonly jobs = new Map<string, ProgressBar>();

  constructor(session: Session) {
    session.on("progress", ({ head }) => {
      const { job, title, part, cancellable } = head as { job: string; title: string; part: number | null; cancellable: boolean };
      const bar = this.jobs.get(job) ?? this.begin(tWord("job_", title), cancellable ? () => void session.ask("job.cancel", { job }) : undefined);
      this.jobs.set(job, bar);
      bar.show(part);
    });
    session.on("progress-end", ({ head }) => {
      this.jobs.get(head["job"] as string)?.end();
      this.jobs.delete(head["job"] as string);
    });
    session.status.onChange(() => {
      for (const bar of this.jobs.values()) bar.end();
      this.jobs.clear();
    });
  }

  begin(title: string, onCancel?: () => void): ProgressBar {
    const fill = h("div", { class: "progress-fill indeterminate" });
    const element = h(
      "div",
      { class: "progress", role: "progressbar", "aria-label": title },
      h("span", { class: "progress-title" }, title),
      onCancel && iconButton("close", t("cancel"), onCancel),
      h("div", { class: "progress-track" }, fill),
    );
    const later = window.setTimeout(() => this.element.append(element), PATIENCE);
    return {
      show: (part) => {
        fill.classList.toggle("indeterminate", part === null);
        fill.style.width = part === null ? "" : `${100 * part}%`;
      },
      end: () => {
        clearTimeout(later);
        element.remove();
      },
    };
  }
}
