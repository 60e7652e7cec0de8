// Settings in the fragment of a link, which a browser sends to nobody. `#1.…` is packed; `#plan=…` is a text as it is.
import { EMPTY, isSame, settingsOf, type Settings } from "./settings";

/** Maximum number of bytes of an unpacked link. */
const LONGEST = 16_000_000;

async function piped(bytes: Uint8Array<ArrayBuffer>, through: CompressionStream | DecompressionStream): Promise<Uint8Array> {
  const reader = new Blob([bytes]).stream().pipeThrough(through).getReader();
  const parts: Uint8Array[] = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    length += value.length;
    if (length > LONGEST) throw new Error("too long");
  }
  const whole = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

/** Returns the fragment of these settings, with `#`. */
export async function fragmentOf(settings: Settings): Promise<string> {
  const given = Object.entries(settings).filter(([key]) => !isSame(key as keyof Settings, settings, EMPTY) && (key !== "ownWorld" || settings.world === "own"));
  const bytes = new TextEncoder().encode(JSON.stringify(Object.fromEntries(given)));
  const packed = await piped(bytes, new CompressionStream("deflate-raw"));
  const letters = Array.from(packed, (byte) => String.fromCharCode(byte)).join("");
  return `#1.${btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** Returns the settings of a fragment, or `undefined` if it has none; throws a sentence about a link that is no good. */
export async function settingsIn(fragment: string): Promise<Settings | undefined> {
  if (fragment.length < 2) return undefined;
  if (fragment.startsWith("#plan=")) {
    try {
      return settingsOf({ text: decodeURIComponent(fragment.slice("#plan=".length)) });
    } catch {
      throw new Error("The plan in this link cannot be read.");
    }
  }
  const [, version, packed] = /^#(\d+)\.([\w-]*)$/.exec(fragment) ?? [];
  if (version === undefined) throw new Error("This link has no plan in it.");
  if (version !== "1") throw new Error("This link was made by another version of the playground.");
  try {
    const bytes = Uint8Array.from(atob((packed ?? "").replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
    const text = new TextDecoder("utf-8", { fatal: true }).decode(await piped(bytes, new DecompressionStream("deflate-raw")));
    return settingsOf(JSON.parse(text));
  } catch {
    throw new Error("This link is cut or damaged: copy it again, whole.");
  }
}
