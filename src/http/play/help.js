// The help of the page: what it is, and its keys.

import { at, h } from "./dom.js";

const KEYS = [
  ["Tab", "from point to point"],
  ["Arrows", "move the point (Shift: further, Alt: by a pixel); turn a surface where no vertex is chosen"],
  ["Enter", "choose the point that has the focus"],
  ["I", "insert a point behind this one"],
  ["C", "make it a corner, or smooth again"],
  ["Delete", "delete the point"],
  ["N, Shift+N", "surfaces: choose the next or the last vertex; Esc chooses none"],
  ["+, −", "zoom a surface"],
  ["[, ]", "one level less, one more"],
  ["L", "show level by level"],
  ["F", "look at all of it"],
  ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo"],
  ["?", "this help"],
];

/** Opens the help. */
export function openHelp() {
  const dialog = at("help");
  const keys = KEYS.flatMap(([names, what]) => [
    h("dt", {}, names.split(", ").flatMap((name, n) => [n > 0 ? " " : "", h("kbd", {}, name)])), h("dd", {}, what)]);
  const link = (href, words) => h("a", { href }, words);
  dialog.replaceChildren(h("div", {},
    h("div", { class: "head" }, h("h2", { id: "help-title" }, "Subdivision, to play with"),
      h("button", { type: "button", class: "icon", "aria-label": "Close", onclick: () => dialog.close() }, "✕")),
    h("p", {}, "A control polygon or a control mesh is refined by a rule, again and again, and comes to a smooth curve "
      + "or surface. Drag its points, step through the levels, choose another rule, and take the result with you."),
    h("p", {}, "Everything you see is the answer of this service to one job, which “Download and share” shows. ",
      link("/docs", "Reference"), " · ", link("/openapi.json", "OpenAPI document"), " · ",
      link("/v1/presets", "presets"), " · ", link("/v1/operators", "operators"), " · ", link("/v1/formats", "formats")),
    h("h3", {}, "Keys"), h("dl", { class: "keys" }, ...keys),
    h("h3", {}, "Fingers"),
    h("p", {}, "Tap to add a point, drag a point or an edge, drag the paper to move it, pinch to zoom."),
  ));
  dialog.showModal();
}
