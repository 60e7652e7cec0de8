// The settings of this tab, kept while the page is reloaded; and those of the last tab, for a new one.
import type { Settings } from "./settings";

const KEY = "mdle-playground-1";
/** Settings of this tab that others replaced. */
const ASIDE = "mdle-playground-1-replaced";

/** Keeps settings, and returns `true` if this tab will find them again: a storage may be full or forbidden. */
export function keep(settings: Settings): boolean {
  written(() => localStorage, KEY, settings);
  if (written(() => sessionStorage, KEY, settings)) return true;
  // What was set aside may take the room.
  setAside(undefined);
  return written(() => sessionStorage, KEY, settings);
}

/** Returns the settings that were kept, if `read` accepts them. */
export function kept(read: (object: unknown) => Settings): Settings | undefined {
  return readFrom(() => sessionStorage, KEY, read) ?? readFrom(() => localStorage, KEY, read);
}

/** Sets settings aside that others have replaced, until `undefined` is set aside. */
export function setAside(settings: Settings | undefined): void {
  written(() => sessionStorage, ASIDE, settings);
}

/** Returns the settings that were set aside. */
export function wasSetAside(read: (object: unknown) => Settings): Settings | undefined {
  return readFrom(() => sessionStorage, ASIDE, read);
}

function written(storage: () => Storage, key: string, settings: Settings | undefined): boolean {
  try {
    if (settings) storage().setItem(key, JSON.stringify(settings));
    else storage().removeItem(key);
    return true;
  } catch {
    return false;
  }
}

function readFrom(storage: () => Storage, key: string, read: (object: unknown) => Settings): Settings | undefined {
  try {
    const text = storage().getItem(key);
    return text ? read(JSON.parse(text)) : undefined;
  } catch {
    // They are those of another version, or the storage is forbidden.
    return undefined;
  }
}
