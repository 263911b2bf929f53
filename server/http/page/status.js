// The sentences above and on the pictures.

import { $, put } from "./dom.js";
import { sentences } from "./words.js";

const NEWS_MS = 12000;

/** @typedef {Omit<import("./words.js").Facts, "news">} Facts */

export class StatusLine {
  constructor() {
    this.news = { text: "", until_ms: 0 };
    this.words = $("words");
    this.words.onclick = () => this.words.classList.toggle("all");
    this.words.onkeydown = ({ key }) => {
      if (key === "Enter") this.words.click();
    };
  }

  /** Is said for some seconds, whatever the page shows. @param {string} text */
  tell(text) {
    this.news = { text, until_ms: performance.now() + NEWS_MS };
  }

  /** @param {Facts} facts */
  show(facts) {
    const news = performance.now() < this.news.until_ms ? this.news.text : "";
    const said = sentences({ ...facts, news });
    const { words } = this;
    const text = said.map((sentence) => sentence.text).join(" ");
    put(words, text);
    words.title = text;
    words.tabIndex = words.scrollHeight > words.clientHeight + 1 || words.classList.contains("all") ? 0 : -1; // opened by a click
    words.dataset.grave = String(said[0]?.grave ?? 0);
    for (const pane of facts.panes) {
      const own = said.find(({ banner, panes }) => banner && (panes?.includes(pane) ?? true));
      pane.tell(own?.banner ?? "");
    }
  }
}
