// The line at the bottom: the shape's size, and whether the server is there.

import { h, replace } from "../core/dom";
import { t, type StringKey } from "../core/strings";
import type { Studio } from "../studio";
import type { Status } from "../transport/transport";
import { shortNumber } from "./controls";

const TEXTS: Record<Status, StringKey> = { connecting: "connecting", open: "connected", lost: "lost", refused: "refused" };

export function statusBar(studio: Studio): HTMLElement {
  const facts = h("span", { class: "facts" });
  const link = h("span", { class: "link", role: "status" });
  studio.session.scene.watch((scene) => {
    const mesh = scene?.mesh;
    const grouped = (count: number): string => count.toLocaleString("en").replaceAll(",", " ");
    const size = mesh ? mesh.bounds[1].map((high, i) => shortNumber(Number((high - mesh.bounds[0][i]!).toPrecision(4)))) : [];
    replace(
      facts,
      mesh ? h("span", null, `${grouped(mesh.points)} ${t("vertices")}`) : null,
      mesh ? h("span", null, `${grouped(mesh.faces)} ${t("faces")}`) : null,
      mesh ? h("span", null, size.join(" × ")) : null,
    );
  });
  studio.session.status.watch((status) => {
    link.className = `link ${status}`;
    link.textContent = t(TEXTS[status]);
  });
  return h("footer", { class: "status" }, facts, h("span", { class: "spacer" }), link);
}
