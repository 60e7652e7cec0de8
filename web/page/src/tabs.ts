// Tabs: one panel is shown, arrows move between them.
import { byId, element } from "./dom";

const NAMES = ["plan", "why", "transitions", "signals", "batch", "world"];

/** Makes the tabs; `shown` is called when another panel is shown. */
export function tabs(list: HTMLElement, shown: (name: string) => void): void {
  const buttons = NAMES.map((name) => {
    const title = name[0]?.toUpperCase() + name.slice(1);
    const tab = element("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `panel-${name}` }, title);
    tab.addEventListener("click", () => show(name));
    return tab;
  });
  list.append(...buttons);
  list.addEventListener("keydown", ({ key }) => {
    const step = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
    if (step === 0) return;
    const at = buttons.findIndex((tab) => tab.getAttribute("aria-selected") === "true");
    const next = (at + step + NAMES.length) % NAMES.length;
    show(NAMES[next] ?? "plan");
    buttons[next]?.focus();
  });
  const show = (name: string) => {
    NAMES.forEach((known, place) => {
      byId(`panel-${known}`).hidden = known !== name;
      buttons[place]?.setAttribute("aria-selected", String(known === name));
      buttons[place]?.setAttribute("tabindex", known === name ? "0" : "-1");
    });
    shown(name);
  };
  show("plan");
}
