// Plans to begin with, each with the settings of its tests in the repository.
import branching from "repository:plans/branching.mdle";
import dock from "repository:plans/dock.mdle";
import tour from "repository:plans/lab_tour.mdle";
import patrol from "repository:plans/patrol.mdle";
import retreat from "repository:plans/retreat.mdle";
import sentry from "repository:plans/sentry.mdle";
import wall from "repository:plans/wall_following.mdle";
import { EMPTY, type Settings } from "./settings";

export interface Example {
  name: string;
  settings: Partial<Settings>;
}

export const EXAMPLES: Example[] = [
  { name: "Dock: a first plan", settings: { text: dock, world: "room", start: "0.7,0.7,0" } },
  { name: "Lab tour: the tour of the paper", settings: { text: tour, world: "office" } },
  { name: "Lab tour on a Scout, with noise", settings: { text: tour, world: "office", body: "scout", seed: "4" } },
  { name: "Wall following: by one sonar", settings: { text: wall, world: "room", start: "1,0.8,0" } },
  { name: "Retreat: exploring by touch", settings: { text: retreat, world: "room", body: "scout", seed: "1", limit: "180" } },
  { name: "Branching: by what has happened", settings: { text: branching, world: "hall", start: "1.5,5,0" } },
  { name: "Patrol: a plan with parameters", settings: { text: patrol, world: "hall", start: "3,5,0" } },
  { name: "Sentry: a loop without end", settings: { text: sentry, world: "room", limit: "120" } },
];

/** The settings of an example. */
export function settingsOfExample(example: Example): Settings {
  return { ...EMPTY, ...example.settings };
}
