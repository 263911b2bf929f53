// What the page shows of its connection: scene and role, the question for a token, the button that tries again.

import { $, dialogOf, inputOf } from "./dom.js";

/** @type {Record<string, string>} */
const ROLES = { viewer: "You may watch", controller: "You may set a radar that nobody else controls", admin: "You may set any radar" };
/** What the button says, by the state of the connection. @type {Record<string, string>} */
const AGAIN = { token: "enter a token", refused: "load again", lost: "connect now" };

export class Greeting {
  /** @param {import("./stream.js").Link} link */
  constructor(link) {
    this.link = link;
    this.dialog = dialogOf("ask");
    const token = inputOf("token");
    this.dialog.onclose = () => {
      if (this.dialog.returnValue !== "ok" || !token.value) return;
      link.token = token.value;
      token.value = "";
      link.open();
    };
    $("again").onclick = () => this.#again();
  }

  /** What helps a page that does not come back by itself, or not yet. */
  #again() {
    const { kind } = this.link.state;
    if (kind === "token") this.#ask();
    else if (kind === "refused") location.reload();
    else this.link.open();
  }

  #ask() {
    const { text } = this.link.state;
    $("ask-text").textContent = text ? `The server does not accept this one: ${text}` : "This server wants a token.";
    this.dialog.returnValue = "";
    if (!this.dialog.open) this.dialog.showModal();
  }

  /** @param {import("./stream.js").LinkState} state */
  show({ kind }) {
    document.body.classList.toggle("stale", kind !== "live" && kind !== "connecting");
    document.body.dataset.link = kind;
    if (kind !== "live" && kind !== "silent") $("role").textContent = "";
    if (kind === "token") this.#ask();
    else if (kind === "live") this.dialog.close();
    $("again").hidden = !AGAIN[kind];
    $("again").textContent = AGAIN[kind] ?? "connect now";
  }

  /** @param {import("../wire.js").Welcome} welcome */
  welcome({ scene_name, server_version, server_name, role }) {
    $("scene").textContent = [scene_name, server_version].filter(Boolean).join(" · ");
    $("scene").title = `Scene and version of ${server_name ?? "the server"}`;
    document.title = `obliq · ${scene_name ?? ""}`;
    $("role").textContent = role ?? "";
    $("role").title = ROLES[role] ?? "";
  }
}
