// What a picture may show: a radar, the first radar at another range scale, or, for experts, its view through another frustum.

import { number } from "./messages.js";
import { UNIT_M } from "./grid.js";
import { scaled } from "./radar.js";

const FRUSTA = ["sweep", "oblique", "symmetric"];
const HALF_TURN_DEG = 180; // a symmetric frustum sees less

/** @typedef {import("./main.js").App} App */

/** @param {App} app whether its first radar sees too much for a symmetric frustum */
export function isWide({ panes }) {
  return number(panes[0].info?.settings?.sector_deg) >= HALF_TURN_DEG;
}

/** "scale 12 NM": its metres; 0: it is none. */
export function scaleOf(source) {
  const [kind, value, unit] = source.split(" ");
  return kind === "scale" && UNIT_M[unit] ? Number(value) * UNIT_M[unit] : 0;
}

/** What a RenderOnce changes of the first radar's settings. @param {string} source */
export function changesOf(source, settings) {
  const scale_m = scaleOf(source);
  return scale_m ? scaled(settings, scale_m) : { frustum: source.slice(8).toUpperCase() };
}

/** Range scales as sources: "scale 12 NM". */
const scalesOf = ({ controls }) => (controls ? controls.scales_m.map((metres) => `scale ${+(metres / UNIT_M[controls.scaleUnit]).toPrecision(6)} ${controls.scaleUnit}`) : []);

/** @param {App} app @returns {string} what the second picture shows unasked; nothing: there is no other */
export function otherSource(app) {
  const radars = app.link.welcome?.radars ?? [];
  const rendersNothing = Boolean(app.debrief?.state);
  const [kind, name] = app.kept.b.split(/ (.*)/);
  if (kind === "radar" && radars.includes(name)) return app.kept.b;
  if (!rendersNothing && ((kind === "scale" && scaleOf(app.kept.b)) || (kind === "frustum" && FRUSTA.includes(name)))) return app.kept.b;
  const other = radars.find((radar) => radar !== app.panes[0].radar);
  if (other) return `radar ${other}`;
  if (rendersNothing) return "";
  const now_m = number(app.panes[0].info?.settings?.r_max_m);
  const scales = scalesOf(app);
  return scales.findLast((scale) => scaleOf(scale) < 0.9 * now_m) ?? scales.find((scale) => scaleOf(scale) > 1.1 * now_m) ?? "";
}

/** Fills the choice above each picture. @param {App} app */
export function fillSources(app) {
  if (!app.link.welcome) return;
  const radars = app.link.welcome.radars ?? [];
  const { panes } = app;
  for (const pane of panes) {
    const isFirst = pane === panes[0];
    const options = radars.map((radar) => new Option(radar, `radar ${radar}`));
    // A recording renders nothing. One that was chosen stays, and what the server says of it.
    if (!isFirst && !app.debrief?.state) {
      const scales = scalesOf(app);
      if (scaleOf(pane.source) && !scales.includes(pane.source)) scales.push(pane.source);
      options.push(...scales.map((scale) => new Option(`range ${scale.slice(6)}`, scale)));
      const kinds = FRUSTA.filter((kind) => kind === pane.frustum || (app.kept.expert && (kind !== "symmetric" || !isWide(app))));
      options.push(...kinds.map((kind) => new Option(`${kind}, same view`, `frustum ${kind}`)));
    }
    pane.pick.replaceChildren(...options);
    if (!options.some(({ value }) => value === pane.source)) pane.source = isFirst ? `radar ${radars[0] ?? ""}` : otherSource(app);
    pane.pick.value = pane.source;
  }
  if (panes[1]?.source === "") app.setPanes(1);
  const two = document.getElementById("two");
  two.disabled = panes.length === 1 && !otherSource(app);
  two.title = two.disabled ? "This recording has one radar, and renders nothing else" : "One picture or two (P)";
}
