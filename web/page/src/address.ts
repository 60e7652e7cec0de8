// The address of the page: a link with a plan in it is opened, and given up once the plan is edited, so that edits are kept.
import { fragmentOf, settingsIn } from "./link";
import { tell } from "./notice";
import { isAllSame, type Settings } from "./settings";
import { keep } from "./storage";

export class Address {
  /** The settings of the link in the address. */
  private linked: Settings | undefined;

  constructor(private now: () => Settings) {}

  /** Returns the settings of the link in the address; tells the reader of one that is no good. */
  async opened(): Promise<Settings | undefined> {
    try {
      this.linked = await settingsIn(location.hash);
    } catch (error) {
      this.linked = undefined;
      tell((error as Error).message, true);
    }
    return this.linked;
  }

  /** Keeps the settings; an address whose link has others is without the link from then on. */
  keep(): void {
    const now = this.now();
    if (!keep(now) || !this.linked || isAllSame(now, this.linked)) return;
    this.linked = undefined;
    history.replaceState(null, "", location.pathname + location.search);
  }

  /** Returns the link of settings; the address remains as it is. */
  async linkOf(settings: Settings): Promise<string> {
    return location.href.replace(/#.*$/s, "") + (await fragmentOf(settings));
  }
}
