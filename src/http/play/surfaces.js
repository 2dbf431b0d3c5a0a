// The stage for surfaces: a viewer, the surface that follows the control mesh, and its tools.

import { at, count, h, notice, say, tool, warn, write } from "./dom.js";
import { handle } from "./hand.js";
import { Net, tags } from "./cage.js";
import { Hard } from "./hard.js";
import { edgesOf, extraordinary, lineThrough, normalsOf, setList, toggled, trianglesOf, wiresOf } from "./mesh.js";
import { partOf, trianglesAt, turn } from "./part.js";
import { FILES, HINTS, TOOLS, numbersSection, pictureSection } from "./told.js";
import { output } from "./lines.js";
import { Refiner } from "./refiner.js";
import { meshOf } from "./service.js";
import { ball } from "./space.js";
import { changed, state, view } from "./state.js";
import { Viewer } from "./viewer.js";

/** Most faces of a surface that the page shows: twice of it takes phones more than a second. */
const MOST_FACES = 300_000;
/** The largest part of the vertices of a surface that moves apart from the rest: more is as soon drawn as a whole. */
const LARGEST_PART = 0.5;
/** Angle in degrees beyond which an edge looks hard where the mesh has tags of sharpness, or is shown unrefined. */
const HARD = 30;

export class Surfaces {
  #viewer;
  #net;
  #refiner = null;
  #shape = null;
  #topology = null;
  #tool = "move";
  #sharpness = 10;
  #failed;
  #told;
  #picture;
  #element;
  #hard = new Hard(HARD);
  #isLive = false;
  #ofFile = { mesh: null, warnings: [] };

  constructor(failed) {
    this.#failed = failed;
    const about = "Surface; arrows turn it, N chooses a vertex";
    const canvas = h("canvas", { tabindex: "0", role: "application", "aria-label": about });
    this.#element = h("div", { class: "pane" }, canvas);
    this.#viewer = new Viewer(canvas, { opaque: true });
    this.#net = new Net(this.#viewer, {
      tool: () => this.#tool, moved: (live) => changed("points", live), chosen: () => this.refreshTools(),
      edge: (edge) => this.#tapEdge(edge), vertex: (vertex) => this.#tapVertex(vertex),
      face: (face) => this.#tapFace(face),
      viewed: () => {
        view.surfaces = this.#viewer.camera.looks;
        changed("view", true);
        this.#picture.follow();
      },
    });
    handle(this.#viewer, this.#net);
    this.#viewer.onrestored = () => {
      this.#drawNet();
      this.#show(this.#shape);
    };
    this.#told = numbersSection();
    this.#picture = pictureSection(() => this.#viewer.camera.ofPictures);
    output.camera = () => this.#viewer.camera.ofPictures;
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.#paint());
  }

  get #mesh() {
    return state.surfaces.input.mesh;
  }

  /** Puts the stage into the page. */
  open() {
    at("panes").replaceChildren(this.#element);
    this.#drops();
    this.tools();
    this.#paint();
  }

  /** Stops what is under way. */
  close() {
    this.#refiner?.stop();
    this.#refiner = null;
    const stage = at("stage");
    stage.ondragover = stage.ondragleave = stage.ondrop = null;
  }

  /** Looks at the whole mesh. */
  fit() {
    this.#viewer.measure();
    this.#viewer.camera.up = state.surfaces.input.up ?? "y";
    this.#viewer.camera.fit(ball(this.#mesh.positions.flat()), this.#viewer.aspect);
    view.surfaces = null;
    changed("view", true);
    this.#picture.follow();
    this.draw();
  }

  /** Looks as the address says, else at the whole mesh. */
  look() {
    const kept = view.surfaces;
    this.fit();
    if (kept) this.#viewer.camera.looks = kept;
    view.surfaces = kept;
    this.#picture.restore();
  }

  draw() {
    this.#viewer.draw();
  }

  /** The shape of the job that is shown, as the service or its stencils answered it. */
  shown() {
    return this.#shape;
  }

  get requests() {
    return this.#refiner?.requests ?? 0;
  }

  /** Whether an answer is on its way. */
  get busy() {
    return Boolean(this.#refiner?.busy);
  }

  /** Frames drawn since the page was opened. */
  get drawn() {
    return this.#viewer.drawn;
  }

  /** Where a vertex of the control mesh is on the canvas, for scripts. */
  seen(vertex) {
    return this.#viewer.seen(this.#mesh.positions[vertex]);
  }

  /** Has the surface follow the document. */
  update(what, live) {
    const { input, plan, levels } = state.surfaces;
    const { show } = state;
    const wanted = `${show.limit} ${show.isolines}`;
    if (this.#refiner?.wanted !== wanted) {
      this.#refiner?.stop();
      const options = { positions: show.limit ? "limit" : "refined", ...(show.isolines ? { isolines: true } : {}) };
      this.#refiner = new Refiner((shape) => this.#show(shape), this.#failed, options);
      this.#refiner.wanted = wanted;
    }
    Object.assign(this.#viewer, { showsSurface: show.surface, showsWires: show.wireframe, faceted: show.flat });
    this.#drawNet();
    if (what === "show" && this.#shape) this.#show(this.#shape);
    this.#isLive = live;
    this.#refiner.update({ input, plan, levels });
    this.#isLive = false;
    if (!live) {
      this.#told.follow({ input, plan, levels });
      this.#picture.follow();
    }
  }

  /** Shows a refined shape. */
  #show(shape) {
    if (!shape || state.mode !== "surfaces") return;
    this.#shape = shape;
    this.#failed(null);
    const { flat, faces, warnings = [] } = shape;
    warn([...(this.#ofFile.mesh === this.#mesh ? this.#ofFile.warnings : []), ...warnings]);
    if (this.#topology?.of !== faces) {
      const triangles = trianglesOf(faces);
      this.#topology = { of: faces, triangles, wires: wiresOf(faces, flat.length / 3) };
      this.#topology.around = trianglesAt(triangles, flat.length / 3);
      this.#topology.normals = new Float32Array(flat.length);
      write(at("counts"), `${count(faces.length)} faces`);
    }
    if (this.#looksHard() && !state.show.flat) this.#showHard(shape);
    else this.#showSmooth(shape);
    this.#drawIsolines(shape);
    this.#drawExtraordinary();
  }

  /** Shows a surface with normals by its faces; the part alone that follows a point where others do not move. */
  #showSmooth({ flat, moved: now }) {
    const topology = this.#topology;
    // when a hand lets go nothing has moved any more
    const moved = now?.length === 0 ? topology.part?.moved : now;
    const { triangles, wires, normals, around } = topology;
    const isPart = moved && topology.isTurned && moved.length < LARGEST_PART * flat.length / 3;
    if (isPart && topology.part?.moved !== moved) topology.part = { moved, ...partOf(topology, moved) };
    if (isPart) turn(topology.part.turned, flat, triangles, around, normals);
    else normalsOf(flat, triangles, normals);
    topology.isTurned = true;
    const part = isPart ? topology.part : null;
    this.#viewer.setSurface({ positions: flat, normals, triangles, wires, part });
  }

  #looksHard() {
    const { creases, corners } = this.#mesh;
    return state.surfaces.levels === 0 || creases?.length > 0 || corners?.length > 0;
  }

  /** Shows a surface whose edges may be hard. */
  #showHard({ flat, faces, moved }) {
    const topology = this.#topology;
    topology.isTurned = false;
    const isPart = this.#isLive && moved && moved.length < LARGEST_PART * flat.length / 3;
    const followed = isPart ? this.#hard.moved(flat, faces, moved) : null;
    this.#viewer.setSurface(followed ?? this.#hard.whole(flat, faces));
  }

  #drawIsolines({ flat, isolines }) {
    const rows = [];
    const place = (v) => [flat[3 * v], flat[3 * v + 1], flat[3 * v + 2]];
    for (const line of state.show.isolines ? isolines ?? [] : []) {
      for (let i = 1; i < line.length; i += 1) {
        rows.push(...place(line[i - 1]), ...place(line[i]), ...this.#net.colors.line);
      }
    }
    this.#viewer.setLines("isolines", rows, { width: 1.6, behind: 0 });
  }

  /** Extraordinary vertices where the surface has them: images of vertices of the input come first in the result. */
  #drawExtraordinary() {
    const rows = [];
    if (state.show.extraordinary) {
      const mesh = this.#mesh;
      const isPrimal = this.#shape.flat.length / 3 >= mesh.positions.length;
      for (const v of extraordinary(mesh)) {
        const place = isPrimal ? [...this.#shape.flat.slice(3 * v, 3 * v + 3)] : mesh.positions[v];
        rows.push(...place, 0.95, 0.74, 0.1, 1, 12);
      }
    }
    this.#viewer.setDots("extraordinary", rows, { behind: 0.1, lift: 0.004 });
  }

  #drawNet() {
    this.#net.draw(this.#mesh, state.show.net || this.#tool !== "move");
  }

  #paint() {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => {
      const text = style.getPropertyValue(name).trim().slice(1);
      return [0, 2, 4].map((from) => parseInt(text.slice(from, from + 2), 16) / 255);
    };
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const [control, soft] = [color("--control"), color("--control-soft")];
    this.#net.setColors({ control, soft, ink: color("--ink"), accent: color("--accent"), dark });
    this.#viewer.setColors({
      paper: color("--stage"), front: dark ? [0.45, 0.56, 0.82] : [0.62, 0.72, 0.93],
      back: dark ? [0.5, 0.42, 0.36] : [0.82, 0.72, 0.62],
      wire: dark ? [0.03, 0.05, 0.1, 0.45] : [0.08, 0.14, 0.32, 0.3],
    });
    this.#drawNet();
    if (this.#shape) this.#show(this.#shape);
  }

  /** The tools over the stage. */
  tools() {
    const file = h("input", { type: "file", id: "file", class: "unseen", tabindex: "-1", "aria-label": "Mesh file" });
    file.onchange = () => file.files[0] && this.#read(file.files[0]);
    const slider = h("input", { type: "range", id: "sharpness", min: 0.5, max: 10, step: 0.5, value: this.#sharpness });
    const shown = h("output", { id: "sharpness-shown", for: "sharpness" });
    const tell = () => { shown.textContent = this.#sharpness >= 10 ? "∞" : this.#sharpness; };
    slider.oninput = () => {
      this.#sharpness = Number(slider.value);
      tell();
    };
    tell();
    at("tools").replaceChildren(
      ...TOOLS.map(([name, word, title]) => tool(`tool-${name}`, name, word, title, () => this.#choose(name))),
      h("label", { id: "sharpness-label" }, "Sharpness ", shown, slider), h("hr"),
      tool("tool-open", "open", "Open a file", FILES, () => file.click()), file,
      tool("tool-fit", "fit", "Fit", "Look at all of it (F)", () => this.fit()),
    );
    this.refreshTools();
  }

  /** Has the tools say how things stand. */
  refreshTools() {
    if (!at("tool-move")) return;
    for (const [name] of TOOLS) at(`tool-${name}`).setAttribute("aria-pressed", String(name === this.#tool));
    at("sharpness-label").hidden = !["crease", "corner"].includes(this.#tool);
    const chosen = this.#net.chosen;
    write(at("hint"), chosen >= 0 && this.#tool === "move"
      ? `Vertex ${chosen} of ${this.#mesh.positions.length}. Arrows move it.` : HINTS[this.#tool]);
  }

  #choose(name) {
    this.#tool = name;
    this.#net.choose(-1);
    this.#drawNet();
    this.refreshTools();
    say(HINTS[name]);
  }

  #tapEdge(edge) {
    const mesh = this.#mesh;
    if (this.#tool === "crease") {
      setList(mesh, "creases", toggled(mesh.creases, edge, { edge, sharpness: this.#sharpness }, (one) => one.edge));
    } else {
      const line = lineThrough(mesh.faces, mesh.positions.length, edge);
      const list = mesh[this.#tool] ?? [];
      const known = new Set(list.map(tags.edgeName));
      const isTagged = known.has(tags.edgeName(edge));
      const names = new Set(line.map(tags.edgeName));
      const rest = list.filter((one) => !names.has(tags.edgeName(one)));
      setList(mesh, this.#tool, isTagged ? rest : [...rest, ...line]);
    }
    changed("plan");
  }

  #tapVertex(vertex) {
    const mesh = this.#mesh;
    const rest = (mesh.corners ?? []).filter((one) => one.vertex !== vertex);
    const isNew = rest.length === (mesh.corners ?? []).length;
    setList(mesh, "corners", isNew ? [...rest, { vertex, sharpness: this.#sharpness }] : rest);
    changed("plan");
  }

  #tapFace(face) {
    const holes = new Set(this.#mesh.holes ?? []);
    if (!holes.delete(face)) holes.add(face);
    setList(this.#mesh, "holes", [...holes].sort((a, b) => a - b));
    changed("plan");
  }

  #drops() {
    const stage = at("stage");
    stage.ondragover = (event) => {
      event.preventDefault();
      stage.classList.add("dropping");
    };
    stage.ondragleave = () => stage.classList.remove("dropping");
    stage.ondrop = (event) => {
      event.preventDefault();
      stage.classList.remove("dropping");
      if (event.dataTransfer.files[0]) this.#read(event.dataTransfer.files[0]);
    };
  }

  async #read(file) {
    try {
      const { input, warnings } = await meshOf(file);
      if (!input.mesh.positions || !input.mesh.faces) throw new Error(`${file.name} holds no faces.`);
      state.surfaces.input = input;
      this.#ofFile = { mesh: input.mesh, warnings };
      const most = this.mostLevels();
      if (typeof state.surfaces.levels === "number") state.surfaces.levels = Math.min(state.surfaces.levels, most);
      changed("all");
      this.fit();
      at("examples").value = "";
      say(`${file.name} was read`);
    } catch (fault) {
      notice(fault.message);
    }
  }

  /** The most levels that the page can show. */
  mostLevels() {
    const corners = this.#mesh.faces.reduce((sum, face) => sum + face.length, 0) || 1;
    return Math.min(Math.max(Math.floor(Math.log(MOST_FACES / corners) / Math.log(4)) + 1, 1), 8);
  }

  /** What the analysis is asked about: the scheme around the vertices that this mesh has. */
  question() {
    const mesh = this.#mesh;
    const valence = new Map();
    for (const { ends } of edgesOf(mesh.faces, mesh.positions.length).values()) {
      for (const v of ends) valence.set(v, (valence.get(v) ?? 0) + 1);
    }
    const found = [...new Set(valence.values())].filter((n) => n >= 3 && n <= 12).sort((a, b) => a - b).slice(0, 6);
    return { plan: state.surfaces.plan, valences: found.length > 0 ? found : [4], boundaries: [2] };
  }

  /** Sections of the panel. */
  sections() {
    return [this.#told.section, this.#picture.section];
  }

  /** What can be shown. */
  checks(check) {
    return [
      check("surface", "Surface"), check("net", "Control mesh"), check("wireframe", "Wireframe"),
      check("isolines", "Isolines", "The edges of the control mesh on the surface"),
      check("extraordinary", "Extraordinary", "Vertices of another valence than regular ones"),
      check("limit", "Limit surface", "Moves the vertices of the level to their limit"), check("flat", "Flat faces"),
    ];
  }

  /** Keys of the stage. */
  key(event) {
    if (event.key === "f") this.fit();
    else return false;
    return true;
  }
}
