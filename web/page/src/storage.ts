// The settings of this tab, kept while the page is reloaded; and those of the last tab, for a new one.
import type { Settings } from "./settings";

const KEY = "mdle-playground-1";

/** Keeps settings; where the browser keeps nothing, nothing is kept. */
export function keep(settings: Settings): void {
  for (const storage of [() => sessionStorage, () => localStorage]) {
    try {
      storage().setItem(KEY, JSON.stringify(settings));
    } catch {
      // The storage is full or forbidden.
    }
  }
}

/** Returns the settings that were kept, if `read` accepts them. */
export function kept(read: (object: unknown) => Settings): Settings | undefined {
  for (const storage of [() => sessionStorage, () => localStorage]) {
    try {
      const text = storage().getItem(KEY);
      if (text) return read(JSON.parse(text));
    } catch {
      // They are those of another version, or the storage is forbidden.
    }
  }
  return undefined;
}
