// The page: a WebSocket to the server that served it.

import { mount } from "./app";
import { h } from "./core/dom";
import { t } from "./core/strings";
import { exposeForTests } from "./testing";
import { WebSocketTransport } from "./transport/websocket";

const parameters = new URLSearchParams(location.search);
const scheme = location.protocol === "https:" ? "wss" : "ws";
const address = new URL("socket", location.href);
address.protocol = `${scheme}:`;
address.search = "";

document.body.classList.add("page");
try {
  const on = (name: string): boolean => parameters.get(name) !== "off";
  const app = mount(document.body, new WebSocketTransport(address.href), { antialias: on("antialias"), guides: on("guides") });
  exposeForTests(app);
} catch (error) {
  document.body.replaceChildren(h("p", { class: "fatal" }, `${t("noWebGL")} ${error instanceof Error ? error.message : ""}`));
}
