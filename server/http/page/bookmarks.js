// Bookmarks of the exercise: a list that all stations see; in a recording each takes all of them to its place.

import { number } from "./messages.js";
import { refusalText } from "./form.js";

const MOST_SHOWN = 50; // the newest

const $ = (id) => document.getElementById(id);

export class Bookmarks {
  /** @param {import("./main.js").App} app */
  constructor(app) {
    this.app = app;
    this.list = []; // ExerciseEvent
    this.refusal = "";
    $("mark").onclick = () => this.add();
    $("mark-text").onkeydown = ({ key }) => {
      if (key === "Enter") this.add();
    };
    this.show();
  }

  /** Behind a Welcome: what there is, and from then on what comes. */
  async begin(welcome) {
    this.list = [];
    this.isKnown = number(welcome.minor) >= 2;
    this.show();
    if (!this.isKnown) return;
    for (let after = 0, more = true; more; ) {
      const page = await this.app.link.ask("GetEvents", { after: String(after), follow: true }).catch(() => ({}));
      this.#keep(page.events ?? []);
      after = page.events?.at(-1)?.number ?? after;
      more = Boolean(page.more);
    }
    this.show();
  }

  /** @param {import("./messages.js").Message} message ExerciseEvents that answer nothing */
  take({ body }) {
    const fresh = this.#keep(body.events ?? []);
    for (const { by, text } of fresh) this.app.tellNews(`Bookmark by ${by}: ${text}`);
    if (fresh.length) this.show();
  }

  #keep(events) {
    const marks = events.filter(({ kind }) => kind === "BOOKMARK_EVENT");
    this.list.push(...marks);
    return marks;
  }

  async add() {
    const text = $("mark-text").value.trim();
    if (text) await this.#ask("AddBookmark", { text });
    if (text && !this.refusal) $("mark-text").value = "";
  }

  async #ask(type, body) {
    this.refusal = "";
    try {
      await this.app.link.ask(type, body);
    } catch (error) {
      this.refusal = refusalText(error);
    }
    this.show();
  }

  show() {
    const { link, debrief } = this.app;
    const isViewer = link?.welcome?.role === "viewer";
    for (const id of ["mark", "mark-text"]) $(id).disabled = !this.isKnown || isViewer;
    $("mark").title = isViewer ? "Marking needs a token of the role controller" : "Mark this moment, for all stations (Enter)";
    $("mark-refusal").textContent = this.refusal;
    const replays = Boolean(debrief?.state);
    $("marks").replaceChildren(...this.list.slice(-MOST_SHOWN).reverse().map((event) => {
      const item = document.createElement("button");
      const utc = new Date(Number(BigInt(event.utc_ns ?? 0) / 1000000n)).toISOString();
      item.textContent = `${utc.slice(11, 19)}Z ${event.text}`;
      item.title = `${event.text}\n${utc}, by ${event.by}${replays ? "; all stations go there" : ""}`;
      item.disabled = !replays || isViewer;
      item.onclick = () => this.#ask("SetReplay", { seek_bookmark: event.number });
      return item;
    }));
  }
}
