// The settings of a run, as the fields of the page have them.
import hall from "repository:targets/sim/simulator/worlds/hall.toml";
import maze from "repository:targets/sim/simulator/worlds/maze.toml";
import office from "repository:targets/sim/simulator/worlds/office.toml";
import room from "repository:targets/sim/simulator/worlds/room.toml";

/** The worlds that come with the simulator, as TOML. */
export const WORLDS: Record<string, string> = { office, maze, hall, room };

/** Everything that a link or the browser's storage keeps. */
export interface Settings {
  /** Text of the file that is run. */
  text: string;
  /** Texts of the other files, by their names. */
  files: Record<string, string>;
  /** Name of the robot for which the plan is checked. */
  robot: string;
  /** Name of the plan to run; empty for the only one. */
  plan: string;
  /** Name of a world, or `own`. */
  world: string;
  /** Text of the world `own`. */
  ownWorld: string;
  body: string;
  without: string;
  start: string;
  noise: string;
  seed: string;
  limit: string;
  battery: string;
  goal: string;
}

export const EMPTY: Settings = {
  text: "", files: {}, robot: "sim", plan: "", world: "office", ownWorld: "", body: "ideal", without: "", start: "", noise: "", seed: "", limit: "600", battery: "", goal: "",
};

/** Name of the file that is run. */
export const FILE = "plan.mdle";
/** Robots for which plans are checked. They run on `sim`. */
const ROBOTS = ["sim", "scout", "atrv", "ros2"];
/** Maximum number of letters of a text, and of any other setting; and of files beside the one that is run. */
export const LONGEST = { text: 5_000_000, ownWorld: 8_000_000, other: 200, files: 50 };

/** Returns `true` for the name of a file beside the one that is run: it may begin with folders. */
export function isName(name: string): boolean {
  return name.length <= 100 && name !== FILE && /^(?:[\p{L}\p{Nd}_-][\p{L}\p{Nd}_.-]*\/)*[\p{L}\p{Nd}_-][\p{L}\p{Nd}_.-]*\.mdle$/u.test(name);
}

/** Says what is wrong with a name that is none of a file beside the one that is run. */
export function wrongName(name: string): string {
  if (name === "") return "A file needs a name, such as part.mdle.";
  if (!name.endsWith(".mdle")) return `The name of a file ends in .mdle: ${name}.mdle`;
  if (name.length > 100) return "The name of a file has at most 100 letters.";
  return "The name of a file has letters, digits, _, - and points, and perhaps folders before a /, as leg/part.mdle.";
}

/** Returns `true` if two settings have the same value under this key. */
export function isSame(key: keyof Settings, one: Settings, other: Settings): boolean {
  return key === "files" ? JSON.stringify(one.files) === JSON.stringify(other.files) : one[key] === other[key];
}

/** Returns `true` if two settings are the same in everything. */
export function isAllSame(one: Settings, other: Settings): boolean {
  return (Object.keys(EMPTY) as (keyof Settings)[]).every((key) => isSame(key, one, other));
}

function filesOf(value: unknown): Record<string, string> {
  if (value === null || typeof value !== "object") throw new Error("files are no files");
  const files = Object.entries(value as Record<string, unknown>);
  const whole = files.reduce((sum, [, text]) => sum + (typeof text === "string" ? text.length : Infinity), 0);
  if (files.length > LONGEST.files || whole > LONGEST.text || !files.every(([name]) => isName(name))) throw new Error("files are not as they can be");
  return Object.fromEntries(files) as Record<string, string>;
}

/** Takes the known settings of an object of unknown origin; throws if one is no text or too long. */
export function settingsOf(object: unknown): Settings {
  if (object === null || typeof object !== "object") throw new Error("no settings");
  const settings = { ...EMPTY };
  for (const key of Object.keys(EMPTY) as (keyof Settings)[]) {
    const value = (object as Record<string, unknown>)[key];
    if (value === undefined) continue;
    if (key === "files") {
      settings.files = filesOf(value);
      continue;
    }
    const most = key === "text" || key === "ownWorld" ? LONGEST[key] : LONGEST.other;
    if (typeof value !== "string" || value.length > most) throw new Error(`${key} is no text of at most ${most} letters`);
    settings[key] = value;
  }
  if (settings.world !== "own" && !(settings.world in WORLDS)) throw new Error(`there is no world ${settings.world}`);
  if (!ROBOTS.includes(settings.robot)) throw new Error(`there is no robot ${settings.robot}`);
  if (!["ideal", "scout", "atrv"].includes(settings.body)) throw new Error(`there is no body ${settings.body}`);
  return settings;
}

/** The plan files of the settings for the module. */
export function draftOf({ text, files, robot }: Settings): { text: string; files: Record<string, string>; robot: string } {
  return { text, files, robot };
}

/** The world of the settings as TOML. */
export function worldText(settings: Settings): string {
  return settings.world === "own" ? settings.ownWorld : WORLDS[settings.world] ?? "";
}

/** The setup of a run for the module; throws a sentence about the field at fault. */
export function setupOf(settings: Settings): Record<string, unknown> {
  const seed = settings.seed.trim();
  if (!/^\d{0,15}$/.test(seed)) throw new Error("seed: expected a whole number of at most 15 digits, or nothing");
  const limit = Number(settings.limit);
  if (!(limit > 0 && limit <= 3600)) throw new Error("time limit: expected seconds, more than 0 and at most 3600");
  const battery = settings.battery.trim();
  if (!/^\d{0,3}$/.test(battery)) throw new Error("battery: expected a whole percentage from 0 to 100, or nothing");
  return {
    ...draftOf(settings), plan: settings.plan || null, world: worldText(settings),
    world_name: settings.world === "own" ? "world.toml" : settings.world, body: settings.body, without: settings.without,
    start: settings.start.trim(), start_noise: settings.noise.trim(), seed: seed === "" ? null : Number(seed), limit,
    battery: battery === "" ? null : Number(battery), goal: settings.goal.trim(),
  };
}

/** The command that makes the same run natively. */
export function command(settings: Settings): string {
  const words = ["mdle run plan.mdle --target sim"];
  const quoted = (text: string) => (/^[\w.,-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const option = (name: string, value: string) => {
    if (value.trim() !== "") words.push(`--${name}=${quoted(value.trim())}`);
  };
  option("plan", settings.plan);
  option("world", settings.world === "own" ? "world.toml" : settings.world);
  option("body", settings.body === "ideal" ? "" : settings.body);
  option("without", settings.without);
  option("start", settings.start);
  option("start-noise", settings.noise);
  option("seed", settings.seed);
  option("battery", settings.battery);
  option("goal", settings.goal);
  option("timeout", settings.limit);
  return `${words.join(" ")} --speed=max`;
}
