// The words in a picture's corners: what an operator wants to know of it without looking away.

import { put } from "../dom.js";
import { UNIT_M } from "./grid.js";
import { UP_WORDS } from "./heading.js";
import { bearingText, minutesText } from "../readout.js";
import { modeWord } from "../mode.js";
import { number } from "../messages.js";

const MARKUP = `<div class="annun upper left"></div><div class="annun upper right"></div><div class="annun lower left"><b class="mode"></b><span></span></div>`;
/** @typedef {import("../../wire.js").RadarSettings} RadarSettings */

const MINUS = "−";

/**
 * A range as operators say it: two decimals below 1, one below 10.
 * @param {number} metres
 * @param {import("./grid.js").Unit} unit
 */
export function rangeText(metres, unit) {
  const value = metres / UNIT_M[unit];
  return `${+value.toFixed(value < 1 ? 2 : value < 99.95 ? 1 : 0)} ${unit}`;
}

const signed = (/** @type {number} */ value, /** @type {number} */ digits) => {
  const text = Math.abs(value).toFixed(digits);
  return `${Number(text) === 0 ? "" : value < 0 ? MINUS : "+"}${text}`;
};

/** "TURNING 24 RPM", "SECTOR 120° 60°/s", "ALL ROUND". @param {RadarSettings} s @param {import("./pane.js").Pane} pane */
function scanText(s, pane) {
  if (pane.isRendered) return "RENDERED ONCE";
  const rate = number(s.scan_rate_deg_s);
  if (s.scan_mode === "CIRCULAR_SCAN") return `TURNING ${+(rate / 6).toFixed(1)} RPM`;
  const sector = `SECTOR ${+number(s.sector_deg).toFixed(1)}°`;
  return s.scan_mode === "SECTOR_SCAN" ? `${sector} ${+rate.toFixed(1)}°/s` : number(s.sector_deg) >= 360 ? "ALL ROUND" : sector;
}

/** Gain, sea and rain knobs, tilt: those that the radar has. @param {RadarSettings} s @param {import("../../wire.js").Pose} pose */
function knobTexts(s, pose) {
  const texts = [`GAIN ${signed(number(s.receiver_gain_db), 0)} dB`];
  const stc_m = number(s.stc_range_m);
  texts.push(stc_m > 0 ? `SEA ${rangeText(stc_m, "NM")} ${MINUS}${number(s.stc_db).toFixed(0)} dB` : "SEA OFF");
  const ftc_us = number(s.ftc_us);
  texts.push(ftc_us > 0 ? `RAIN ${+ftc_us.toFixed(1)} µs` : "RAIN OFF");
  if (s.beam_elevation && s.beam_elevation !== "OFF_ELEVATION") texts.push(`TILT ${pose.tilt_auto ? "AUTO" : `${signed(number(pose.tilt_deg), 1)}°`}`);
  return texts;
}

export class Annunciators {
  /** @param {HTMLElement} element of the picture */
  constructor(element) {
    element.insertAdjacentHTML("beforeend", MARKUP);
    const [upperLeft, upperRight, mode, lowerLeft] = element.querySelectorAll(".annun.upper, .annun.lower > *");
    this.upperLeft = upperLeft;
    this.upperRight = upperRight;
    this.mode = mode;
    this.lowerLeft = lowerLeft;
  }

  /** @param {import("./pane.js").Pane} pane */
  show(pane) {
    const { bins: { descriptor: d, placement }, ppi, info, heading, look } = pane;
    if (!d || !placement) return;
    const s = d.settings;
    const pose = pane.newestPose ?? d.pose ?? {};
    const { ringStep } = ppi;
    const stops = [info?.transmit_off && "STBY", info?.frozen && "FRZ"].filter(Boolean).join(" ");
    const { up } = heading.up(look.up, placement);
    const ahead = heading.heading_deg;
    this.#put(this.upperLeft, [
      `RNG ${rangeText(placement.rMax_m, look.unit)}${look.rings && ringStep ? `  RINGS ${+ringStep.step.toPrecision(4)}` : ""}`,
      [scanText(s, pane), stops].filter(Boolean).join("  "),
      ...(look.trails ? [`TRAILS ${look.trails} min ${look.relative ? "R" : "T"}`] : []),
    ]);
    this.#put(this.upperRight, [
      `${UP_WORDS[up]}  ${up === "north" ? "T" : "R"}`,
      ahead === null ? `BRG ${bearingText(placement.bearing_deg)} T` : `HDG ${bearingText(ahead)} T`,
      ...(heading.course_deg === null ? [] : [`CRS ${bearingText(heading.course_deg)} T  ${(heading.speed_mps * 3600 / UNIT_M.NM).toFixed(0)} kt`]),
      minutesText(number(pose.latitude_deg), "N", "S"),
      minutesText(number(pose.longitude_deg), "E", "W"),
      `HGT ${number(pose.height_m).toFixed(0)} m${pose.height_reference === "GROUND" ? " AGL" : ""}`,
    ]);
    this.#put(this.mode, [modeWord(s)]);
    this.#put(this.lowerLeft, knobTexts(s, pose));
  }

  /** @param {Element} element @param {string[]} lines */
  #put(element, lines) {
    put(element, lines.join("\n"));
  }
}
