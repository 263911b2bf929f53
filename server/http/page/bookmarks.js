// Bookmarks of the exercise: a list that all stations see; in a recording each takes all of them to its place.

import { $, buttonOf, inputOf, make } from "./dom.js";
import { Events } from "./events.js";
import { number } from "./messages.js";
import { refusalText } from "./stream.js";

const MOST_SHOWN = 50; // the newest

/** @typedef {import("../wire.js").ExerciseEvent} ExerciseEvent */

/** A client has set one. @extends {Events<{news: string}>} */
export class Bookmarks extends Events {
  /** @param {import("./stream.js").Link} link @param {import("./debrief.js").Debrief} debrief */
  constructor(link, debrief) {
    super();
    this.link = link;
    this.debrief = debrief;
    /** @type {ExerciseEvent[]} */
    this.list = [];
    this.refusal = "";
    this.isKnown = false; // by the server
    link.on("ExerciseEvents", ({ body }) => this.#take(body));
    debrief.on("begun", () => this.show());
    $("mark").onclick = () => this.add();
    $("mark-text").onkeydown = ({ key }) => {
      if (key === "Enter") this.add();
    };
    this.show();
  }

  /** Behind a Welcome: what there is, and from then on what comes. @param {import("../wire.js").Welcome} welcome */
  async begin(welcome) {
    this.list = [];
    this.isKnown = number(welcome.minor) >= 2;
    this.show();
    if (!this.isKnown) return;
    for (let after = "0", more = true; more; ) {
      const page = await this.link.ask("GetEvents", { after, follow: true }).catch(() => (/** @type {import("../wire.js").ExerciseEvents} */ ({})));
      this.#keep(page.events ?? []);
      after = page.events?.at(-1)?.number ?? after;
      more = Boolean(page.more);
    }
    this.show();
  }

  /** @param {import("../wire.js").ExerciseEvents} body that answers nothing */
  #take(body) {
    const fresh = this.#keep(body.events ?? []);
    for (const { by, text } of fresh) this.emit("news", `Bookmark by ${by}: ${text}`);
    if (fresh.length) this.show();
  }

  /** @param {ExerciseEvent[]} events */
  #keep(events) {
    const marks = events.filter(({ kind }) => kind === "BOOKMARK_EVENT");
    this.list.push(...marks);
    return marks;
  }

  async add() {
    const field = inputOf("mark-text");
    const text = field.value.trim();
    if (text) await this.#ask(() => this.link.ask("AddBookmark", { text }));
    if (text && !this.refusal) field.value = "";
  }

  /** @param {() => Promise<unknown>} what */
  async #ask(what) {
    this.refusal = "";
    try {
      await what();
    } catch (error) {
      this.refusal = refusalText(error);
    }
    this.show();
  }

  show() {
    const isViewer = this.link.welcome?.role === "viewer";
    for (const id of ["mark", "mark-text"]) buttonOf(id).disabled = !this.isKnown || isViewer;
    $("mark").title = isViewer ? "Marking needs a token of the role controller" : "Mark this moment, for all stations (Enter)";
    $("mark-refusal").textContent = this.refusal;
    const replays = this.debrief.isOn;
    $("marks").replaceChildren(...this.list.slice(-MOST_SHOWN).reverse().map((event) => {
      const utc = new Date(Number(BigInt(event.utc_ns ?? 0) / 1000000n)).toISOString();
      return make("button", {
        textContent: `${utc.slice(11, 19)}Z ${event.text}`, title: `${event.text}\n${utc}, by ${event.by}${replays ? "; all stations go there" : ""}`,
        disabled: !replays || isViewer, onclick: () => this.#ask(() => this.link.ask("SetReplay", { seek_bookmark: event.number })),
      });
    }));
  }
}
