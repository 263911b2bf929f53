// The tabs beside the pictures.

import { $ } from "./dom.js";
import { Events } from "./events.js";

/** @type {Record<string, number>} */
const STEPS = { ArrowRight: 1, ArrowLeft: -1 };

const names = () => [...document.querySelectorAll("nav [role=tab]")].map(({ id }) => id.slice("tab-".length));

/** @extends {Events<{shown: string}>} */
export class Tabs extends Events {
  /** @param {string} wanted the tab that is to be open; it may come later */
  constructor(wanted) {
    super();
    this.wanted = wanted;
    this.current = "";
    const nav = document.querySelector("nav");
    nav.onclick = ({ target }) => target instanceof Element && target.id.startsWith("tab-") && this.show(target.id.slice("tab-".length));
    nav.onkeydown = ({ key }) => {
      if (!STEPS[key]) return;
      this.next(STEPS[key]);
      $(`tab-${this.current}`).focus();
    };
    this.show(wanted);
  }

  next(by = 1) {
    const all = names();
    this.show(all.at((all.indexOf(this.current) + by) % all.length));
  }

  /** @param {string} name of a tab; the first one where there is none of that name */
  show(name) {
    const all = names();
    this.current = all.includes(name) ? name : all[0];
    for (const tab of all) {
      const on = tab === this.current;
      $(tab).hidden = !on;
      $(`tab-${tab}`).setAttribute("aria-selected", String(on));
      $(`tab-${tab}`).tabIndex = on ? 0 : -1;
    }
    this.emit("shown", this.current);
  }

  /** A tab has come. @param {string} name */
  added(name) {
    if (this.wanted === name) this.show(name);
  }
}
