// Elements without markup: text that comes from files only ever becomes text.

type Child = Node | string | null | undefined | false;
type Props = Record<string, unknown>;

/** An element with properties, listeners (`onclick`), attributes (`aria-label`, `data-x`, `role`) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props | null = null,
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props ?? {})) assign(element, name, value);
  append(element, children);
  return element;
}

function assign(element: HTMLElement, name: string, value: unknown): void {
  if (value === undefined || value === null) return;
  if (name === "class") element.className = String(value);
  else if (name.startsWith("on") && typeof value === "function") {
    element.addEventListener(name.slice(2), value as EventListener);
  } else if (name === "style" && typeof value === "object") Object.assign(element.style, value);
  else if (name in element && !name.includes("-") && name !== "list") Reflect.set(element, name, value);
  else element.setAttribute(name, String(value));
}

export function append(element: Element, children: Child[]): void {
  for (const child of children) if (child) element.append(child);
}

export function replace(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Whether keys typed now belong to a text field. */
export function isTyping(event: Event): boolean {
  const target = event.composedPath()[0];
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return !["checkbox", "range", "button", "radio", "color"].includes(target.type);
  return target.isContentEditable || target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement;
}
