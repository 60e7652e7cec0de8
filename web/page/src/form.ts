// The fields of the setup: which plan is run, and which values are refused.
import type { Ready } from "./answers";
import { byId, element } from "./dom";
import type { Module } from "./module";
import { type Settings, setupOf } from "./settings";

export const FIELDS = ["robot", "plan", "world", "body", "seed", "start", "noise", "without", "limit", "battery", "goal"] as const;
type Name = (typeof FIELDS)[number];

/** The fields that sentences of the module name otherwise. */
const NAMED: Record<string, Name> = { "time limit": "limit", "start noise": "noise" };

export const field = (name: Name) => byId<HTMLInputElement | HTMLSelectElement>(name);

/** Plans of the text that no other plan uses, in order. */
let roots: string[] = [];
/** The plan that `auto` stands for. */
let automatic = "";

/** Offers the plans of a text without errors. */
export function offerPlans(plans: string[], found: string[]): void {
  roots = found;
  // A plan that is taken apart while it is edited stays the one that is run.
  if (!roots.includes(automatic)) automatic = roots[0] ?? "";
  const chosen = field("plan").value;
  showPlans(plans, plans.includes(chosen) ? chosen : "");
}

/** Shows the plans to choose from. */
export function showPlans(plans: string[], chosen: string): void {
  const names = [...new Set([...plans, ...(chosen ? [chosen] : [])])];
  const auto = element("option", { value: "" }, roots.length > 1 ? `auto: ${automatic}` : "auto");
  field("plan").replaceChildren(auto, ...names.map((name) => element("option", { value: name }, name)));
  field("plan").value = chosen;
}

/** Forgets the plans of another text. */
export function forgetPlans(chosen: string): void {
  [roots, automatic] = [[], ""];
  showPlans([], chosen);
}

/** The plan that is run; empty for the only one that no other uses. */
export function planToRun(): string {
  return field("plan").value || (roots.length > 1 ? automatic : "");
}

/** Says which plan is run if the text leaves it open, and on which robot if it is checked for another. */
export function choices(): string {
  const robot = field("robot").value;
  const other = robot === "sim" ? "" : `The plan is checked for the robot ${robot}. Here it runs on the simulated robot; the command mdle run --target ${robot} drives the real one.`;
  return [choiceOfPlan(), other].filter((sentence) => sentence !== "").join(" ");
}

function choiceOfPlan(): string {
  if (field("plan").value !== "" || roots.length < 2) return "";
  return `The text has ${roots.length} plans that no other uses: ${roots.join(", ")}. ${automatic} is run; the field Plan chooses another.`;
}

/** Marks the field that a sentence of a refusal names. */
export function refuse(sentence: string): void {
  const [, prefix = ""] = /^([a-z ]+):/.exec(sentence) ?? [];
  const named = NAMED[prefix] ?? prefix;
  for (const name of FIELDS) {
    if (name === named) field(name).setAttribute("aria-invalid", "true");
    else field(name).removeAttribute("aria-invalid");
  }
  byId("refusal").textContent = FIELDS.some((name) => name === named) && named !== "world" ? sentence : "";
}

/** Asks the module whether the setup can be run, and marks the field that cannot. Returns the floor with the robot. */
export async function checkSetup(module: Module, settings: Settings): Promise<Ready | undefined> {
  try {
    const ready = await module.ask<Ready>({ ask: "ready", ...setupOf(settings), text: "", files: {} });
    refuse("");
    return ready;
  } catch (error) {
    refuse((error as Error).message);
    return undefined;
  }
}
