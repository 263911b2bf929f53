// The picture as a PNG, with its legend and a caption.

import { bearingText, distanceText } from "./readout.js";
import { modeWord } from "./mode.js";
import { number } from "./messages.js";

const LINE_PX = 18;
const FONT = '12px "DejaVu Sans Mono", ui-monospace, Menlo, Consolas, monospace';

/** @typedef {import("./picture/pane.js").Pane} Pane */
/** @typedef {{look: import("./look.js").Look, link: import("./stream.js").Link}} Parts */

const timeText = (/** @type {Pane} */ { bins }) => `${new Date(bins.newest?.utc_ms ?? 0).toISOString().slice(0, 19)}Z`;

/** What a caption says of a picture. @param {Pane} pane @param {Parts} parts */
export function captionOf(pane, { look, link }) {
  const { descriptor: d, placement, scale } = pane.bins;
  const pose = d.pose ?? {};
  /** @param {number} value @param {string} positive @param {string} negative */
  const signed = (value, positive, negative) => `${Math.abs(value).toFixed(5)}° ${value < 0 ? negative : positive}`;
  const compensated = scale.compensated && pane.bins.mayCompensate ? " with r²" : "";
  return [
    [link.welcome?.scene_name ?? d.scene_name, pane.pick.selectedOptions[0]?.text ?? d.radar, modeWord(d.settings), timeText(pane),
      pane.isRendered ? "rendered once" : `frame ${d.frame_id ?? 0}`].filter(Boolean).join(" · "),
    `${signed(number(pose.latitude_deg), "N", "S")} ${signed(number(pose.longitude_deg), "E", "W")}, ` +
      `${number(pose.height_m).toFixed(0)} m, bearing ${bearingText(number(pose.bearing_deg))} · ` +
      `${distanceText(placement.r0_m, look.unit)} to ${distanceText(placement.rMax_m, look.unit)}`,
    `video ${scale.low_dB.toFixed(0)} to ${(scale.low_dB + scale.span_dB).toFixed(0)} dB re ${d.power_unit}${compensated} · ` +
      `${pane.ppi.isSlant ? "slant range" : "ground range"}, ${look.up} up · ${look.palette}`,
  ];
}

/** @param {Parts & {panes: Pane[]}} parts @returns {HTMLCanvasElement} all pictures side by side */
export function pictureOf({ look, link, panes: all }) {
  const panes = all.filter(({ bins }) => bins.descriptor);
  const width = panes.reduce((sum, { ppi }) => sum + ppi.canvases[1].width, 0);
  const height = Math.max(...panes.map(({ ppi }) => ppi.canvases[1].height));
  const canvas = document.createElement("canvas");
  const density = panes[0].ppi.density;
  canvas.width = width;
  canvas.height = height + Math.ceil((3 * LINE_PX + 12) * density);
  const c = canvas.getContext("2d");
  c.fillStyle = "#070b0e";
  c.fillRect(0, 0, canvas.width, canvas.height);
  let left = 0;
  for (const pane of panes) {
    const [picture, grid, marks] = pane.ppi.canvases;
    c.drawImage(picture, left, 0, grid.width, grid.height);
    if (pane.trails.canvas) c.drawImage(pane.trails.canvas, left, 0, grid.width, grid.height);
    c.drawImage(grid, left, 0);
    c.drawImage(marks, left, 0);
    c.save();
    c.translate(left, height);
    c.scale(density, density);
    c.font = FONT;
    c.fillStyle = "#c9d8d4";
    captionOf(pane, { look, link }).forEach((line, k) => c.fillText(line, 10, (k + 1) * LINE_PX, grid.width / density - 20));
    c.restore();
    left += grid.width;
  }
  return canvas;
}

/** @param {Parts & {panes: Pane[]}} parts */
export function savePicture(parts) {
  const shown = parts.panes.find(({ bins }) => bins.descriptor);
  if (!shown) return;
  pictureOf(parts).toBlob((blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `obliq_${parts.panes[0].radar}_${timeText(shown).replaceAll(":", "")}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }, "image/png");
}
