// What a picture may show: a radar, or the first picture's view rendered through another frustum.

import { number } from "./messages.js";

const FRUSTA = ["sweep", "oblique", "symmetric"];
const HALF_TURN_DEG = 180; // a symmetric frustum sees less

/** @typedef {import("./main.js").App} App */

/** @param {App} app whether its first radar sees too much for a symmetric frustum */
export function isWide({ panes }) {
  return number(panes[0].info?.settings?.sector_deg) >= HALF_TURN_DEG;
}

/** @param {App} app @returns {string} what the second picture shows unasked; nothing: there is no other */
export function otherSource(app) {
  const radars = app.link.welcome?.radars ?? [];
  const rendersNothing = Boolean(app.debrief?.state);
  const [kind, name] = app.kept.b.split(/ (.*)/);
  if (kind === "radar" ? radars.includes(name) : FRUSTA.includes(name) && !rendersNothing) return app.kept.b;
  const other = radars.find((radar) => radar !== app.panes[0].radar);
  if (other) return `radar ${other}`;
  const own = String(app.panes[0].info?.settings?.frustum ?? "").toLowerCase();
  const allowed = isWide(app) ? ["oblique", "sweep"] : ["oblique", "symmetric"];
  return rendersNothing ? "" : `frustum ${allowed.find((one) => one !== own)}`;
}

/** Fills the choice above each picture. @param {App} app */
export function fillSources(app) {
  const radars = app.link.welcome?.radars ?? [];
  const { panes } = app;
  for (const pane of panes) {
    const isFirst = pane === panes[0];
    const options = radars.map((radar) => new Option(radar, `radar ${radar}`));
    // A recording renders nothing. One that was chosen stays, and what the server says of it.
    const kinds = FRUSTA.filter((kind) => !app.debrief?.state && (kind !== "symmetric" || !isWide(app) || kind === pane.frustum));
    if (!isFirst) options.push(...kinds.map((kind) => new Option(`${kind}, same view`, `frustum ${kind}`)));
    pane.pick.replaceChildren(...options);
    if (!options.some(({ value }) => value === pane.source)) pane.source = isFirst ? `radar ${radars[0] ?? ""}` : otherSource(app);
    pane.pick.value = pane.source;
  }
  if (panes[1]?.source === "") app.setPanes(1);
  const two = document.getElementById("two");
  two.disabled = panes.length === 1 && !otherSource(app);
  two.title = two.disabled ? "This recording has one radar, and renders nothing else" : "One picture or two (P)";
}
