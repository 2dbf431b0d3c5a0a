// <planish-view src="...">: a model of the service in a page of one's own, to turn and to zoom.
//
//     <script type="module" src="https://planish.example/play/planish-view.js"></script>
//     <planish-view src="https://planish.example/v1/render?job=..." alt="A vase"></planish-view>
//
// `src` is an address that answers glTF or GLB: `GET /v1/render?job=...`, an artifact, or a signed link. A glTF with
// levels of detail is shown coarse at first. Further attributes: `alt`, `wireframe`, `flat`, `azimuth`, `elevation`
// (degrees), `color` (as CSS has it). Events: `level` for each level that is shown, `load` after the last one, `error`.

import { load } from "./gltf.js";
import { handle } from "./hand.js";
import { ball } from "./space.js";
import { Viewer } from "./viewer.js";

const STYLE = `
  :host { display: block; position: relative; min-height: 12rem; aspect-ratio: 4 / 3; }
  canvas { width: 100%; height: 100%; display: block; touch-action: none; cursor: grab; position: absolute; inset: 0; }
  canvas:active { cursor: grabbing; }
  p { position: absolute; inset: auto 0 0; margin: 0; padding: .6rem; font: 14px/1.4 system-ui, sans-serif;
    text-align: center; }
  [hidden] { display: none; }
`;

class PlanishView extends HTMLElement {
  static observedAttributes = ["src", "alt", "wireframe", "flat", "azimuth", "elevation", "color"];
  #viewer = null;
  #canvas = document.createElement("canvas");
  #words = document.createElement("p");
  #loading = null;
  #color = null;
  #last = null;

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    const style = new CSSStyleSheet();
    style.replaceSync(STYLE);
    root.adoptedStyleSheets = [style];
    this.#canvas.tabIndex = 0;
    this.#canvas.setAttribute("role", "img");
    this.#words.hidden = true;
    this.#words.setAttribute("role", "status");
    root.append(this.#canvas, this.#words);
  }

  connectedCallback() {
    if (!this.#viewer) {
      try {
        this.#viewer = new Viewer(this.#canvas);
      } catch (fault) {
        this.#tell(fault.message);
        return;
      }
      handle(this.#viewer);
      this.#viewer.onrestored = () => this.#last && this.#show(this.#last);
    }
    this.#look();
    this.#load();
  }

  disconnectedCallback() {
    this.#loading?.abort();
    this.#loading = null;
  }

  attributeChangedCallback(name, last, value) {
    if (!this.#viewer || !this.isConnected || last === value) return;
    if (name === "src") this.#load();
    else this.#look();
  }

  #look() {
    const { camera } = this.#viewer;
    for (const name of ["azimuth", "elevation"]) {
      const value = Number(this.getAttribute(name) ?? NaN);
      if (Number.isFinite(value)) camera[name] = value;
    }
    this.#canvas.setAttribute("aria-label", this.getAttribute("alt") ?? "A model; arrows turn it");
    this.#viewer.showsWires = this.hasAttribute("wireframe");
    this.#viewer.faceted = this.hasAttribute("flat") || Boolean(this.#last?.faceted);
    const front = cssColor(this.getAttribute("color")) ?? this.#color ?? [0.62, 0.72, 0.93];
    this.#viewer.setColors({ front, back: front.map((x) => x * 0.85) });
  }

  async #load() {
    this.#loading?.abort();
    const src = this.getAttribute("src");
    if (!src) return;
    const mine = new AbortController();
    this.#loading = mine;
    let isFirst = true;
    try {
      await load(src, (model) => {
        if (mine.signal.aborted) return;
        this.#color = model.color;
        this.#show(model);
        if (isFirst) this.#viewer.measure();
        if (isFirst) this.#viewer.camera.fit(ball(model.positions), this.#viewer.aspect);
        isFirst = false;
        this.#tell("");
        const detail = { level: model.level, of: model.of, triangles: model.triangles.length / 3 };
        this.dispatchEvent(new CustomEvent("level", { detail }));
      }, mine.signal);
      this.dispatchEvent(new Event("load"));
    } catch (fault) {
      if (mine.signal.aborted) return;
      this.#tell(`This model cannot be shown: ${fault.message}`);
      this.dispatchEvent(new ErrorEvent("error", { message: fault.message }));
    }
  }

  #show(model) {
    this.#last = model;
    const wires = new Uint32Array(model.triangles.length * 2);
    model.triangles.forEach((v, at) => {
      wires[2 * at] = v;
      wires[2 * at + 1] = model.triangles[at % 3 === 2 ? at - 2 : at + 1];
    });
    this.#look();
    this.#viewer.setSurface({ ...model, wires });
  }

  #tell(text) {
    this.#words.textContent = text;
    this.#words.hidden = text === "";
  }
}

/** A colour as three numbers from 0 to 1, or null. */
function cssColor(text) {
  if (!text) return null;
  const brush = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  brush.fillStyle = text;
  brush.fillRect(0, 0, 1, 1);
  return [...brush.getImageData(0, 0, 1, 1).data.slice(0, 3)].map((x) => x / 255);
}

customElements.define("planish-view", PlanishView);
