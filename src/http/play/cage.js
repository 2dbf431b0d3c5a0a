// The control mesh over a surface: how it is drawn, picked and moved.

import { edgesOf, faceAt, middle } from "./mesh.js";
import { add, scaled } from "./space.js";

/** Pixels within which a vertex or an edge is taken, by a mouse and by a finger. Half of it is missed; twice of it
    takes what was meant for the one beside. */
const REACH = { mouse: 12, touch: 24, pen: 16 };
/** Most vertices that are drawn as dots to take. */
const MOST_DOTS = 20_000;

const RED = [0.86, 0.15, 0.2];
const GREEN = [0.07, 0.58, 0.34];
const PURPLE = [0.55, 0.27, 0.85];

/** How tags name edges, whatever their direction. */
export const tags = { edgeName: ([a, b]) => (a < b ? `${a}-${b}` : `${b}-${a}`) };

export class Net {
  chosen = -1;
  colors = { control: [0.8, 0.4, 0], soft: [0.9, 0.6, 0.2], ink: [0, 0, 0], accent: [0, 0, 1], line: [0, 0, 0.4, 0.8] };
  #viewer;
  #to;
  #mesh = null;
  #edges = [];
  #edgesOf = null;
  #isShown = false;
  #grabbed = -1;
  #hovered = null;
  #pointer = "mouse";

  /** A control mesh in a viewer; `to` is told of what hands do: moved, chosen, edge, vertex, face, viewed, tool. */
  constructor(viewer, to) {
    this.#viewer = viewer;
    this.#to = to;
  }

  setColors({ control, soft, ink, accent, dark }) {
    const line = [...(dark ? [0.9, 0.94, 1] : accent.map((x) => x * 0.5)), 0.85];
    Object.assign(this.colors, { control, soft, ink, accent, line });
  }

  /** Chooses a vertex; -1 none. */
  choose(vertex) {
    this.chosen = vertex;
    if (this.#mesh) this.draw(this.#mesh, this.#isShown);
    this.#to.chosen();
  }

  /** Draws the mesh with its tags. */
  draw(mesh, isShown) {
    this.#mesh = mesh;
    this.#isShown = isShown;
    if (this.#edgesOf !== mesh.faces) {
      this.#edgesOf = mesh.faces;
      this.#edges = [...edgesOf(mesh.faces, mesh.positions.length).values()];
    }
    if (this.chosen >= mesh.positions.length) this.chosen = -1;
    this.#drawLines(mesh, isShown);
    this.#drawDots(mesh, isShown);
  }

  #drawLines(mesh, isShown) {
    const { soft, accent } = this.colors;
    const colored = new Map();
    for (const edge of mesh.latitude ?? []) colored.set(tags.edgeName(edge), [...GREEN, 1]);
    for (const edge of mesh.longitude ?? []) colored.set(tags.edgeName(edge), [...PURPLE, 1]);
    for (const { edge, sharpness } of mesh.creases ?? []) {
      colored.set(tags.edgeName(edge), [...RED, Math.min(0.45 + sharpness / 10, 1)]);
    }
    if (this.#hovered?.edge) colored.set(tags.edgeName(this.#hovered.edge), [...accent, 1]);
    const usual = [...soft, 0.85];
    const [plain, tagged] = [[], []];
    for (const { ends } of this.#edges) {
      const color = colored.size > 0 ? colored.get(tags.edgeName(ends)) : undefined;
      if (!color && !isShown) continue;
      const [[ax, ay, az], [bx, by, bz]] = [mesh.positions[ends[0]], mesh.positions[ends[1]]];
      const [r, g, b, alpha] = color ?? usual;
      (color ? tagged : plain).push(ax, ay, az, bx, by, bz, r, g, b, alpha);
    }
    for (const face of isShown ? mesh.holes ?? [] : []) {
      const center = middle(mesh, face);
      for (const v of mesh.faces[face]) plain.push(...mesh.positions[v], ...center, ...RED, 0.6);
    }
    this.#viewer.setLines("net", plain, { width: 1.5, behind: 0.22 });
    this.#viewer.setLines("tags", isShown ? tagged : [], { width: 3.2, behind: 0.4 });
  }

  #drawDots(mesh, isShown) {
    const { control, ink, accent } = this.colors;
    const corners = new Set((mesh.corners ?? []).map(({ vertex }) => vertex));
    const rows = [];
    const n = isShown ? Math.min(mesh.positions.length, MOST_DOTS) : 0;
    const usual = n <= 150 ? 11 : this.#viewer.size[0] < 600 ? 4.5 : 6.5;
    // the second last number says how full a dot is
    for (let v = 0; v < n; v += 1) {
      const isChosen = v === this.chosen;
      const color = isChosen ? ink : this.#hovered?.vertex === v ? accent : corners.has(v) ? RED : control;
      const [[x, y, z], [r, g, b]] = [mesh.positions[v], color];
      rows.push(x, y, z, r, g, b, isChosen || corners.has(v) ? 1 : 0, isChosen ? 13 : usual);
    }
    this.#viewer.setDots("vertices", rows, { behind: 0.25 });
  }

  /** The vertex next to a pixel, or -1; of those as near, the one in front. */
  #vertexAt(x, y) {
    const reach = REACH[this.#pointer] ?? REACH.mouse;
    let best = { vertex: -1, rank: Infinity };
    this.#mesh.positions.forEach((position, vertex) => {
      const [px, py, depth] = this.#viewer.seen(position);
      const distance = Math.hypot(px - x, py - y);
      const rank = distance / reach + depth / this.#viewer.camera.radius;
      if (distance <= reach && rank < best.rank) best = { vertex, rank };
    });
    return best.vertex;
  }

  /** The edge next to a pixel, or null. */
  #edgeAt(x, y) {
    const reach = REACH[this.#pointer] ?? REACH.mouse;
    let best = { edge: null, rank: Infinity };
    for (const { ends } of this.#edges) {
      const [[ax, ay, ad], [bx, by, bd]] = ends.map((v) => this.#viewer.seen(this.#mesh.positions[v]));
      const [dx, dy] = [bx - ax, by - ay];
      const t = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
      const distance = Math.hypot(x - ax - t * dx, y - ay - t * dy);
      const rank = distance / reach + (ad + t * (bd - ad)) / this.#viewer.camera.radius;
      if (distance <= reach && rank < best.rank) best = { edge: ends, rank };
    }
    return best.edge;
  }

  press(x, y, event) {
    this.#pointer = event.pointerType;
    if (this.#to.tool() !== "move" || !this.#isShown) return false;
    const vertex = this.#vertexAt(x, y);
    if (vertex >= 0) this.choose(vertex);
    this.#grabbed = vertex;
    return vertex >= 0;
  }

  drag(dx, dy) {
    this.#shift(this.#grabbed, dx, dy);
    this.#to.moved(true);
  }

  release(moved) {
    this.#grabbed = -1;
    if (moved) this.#to.moved(false);
  }

  tap(x, y) {
    const tool = this.#to.tool();
    if (tool === "move") {
      if (this.#vertexAt(x, y) < 0 && this.chosen >= 0) this.choose(-1);
    } else if (tool === "corner") {
      const vertex = this.#vertexAt(x, y);
      if (vertex >= 0) this.#to.vertex(vertex);
    } else if (tool === "hole") {
      const face = faceAt(this.#mesh, this.#viewer.ray(x, y));
      if (face >= 0) this.#to.face(face);
    } else {
      const edge = this.#edgeAt(x, y);
      if (edge) this.#to.edge(edge);
    }
  }

  hover(x, y) {
    if (!this.#mesh || !this.#isShown) return;
    this.#pointer = "mouse";
    const tool = this.#to.tool();
    const takesVertices = tool === "move" || tool === "corner";
    const vertex = takesVertices ? this.#vertexAt(x, y) : -1;
    const edge = takesVertices || tool === "hole" ? null : this.#edgeAt(x, y);
    if (vertex === (this.#hovered?.vertex ?? -1) && edge === (this.#hovered?.edge ?? null)) return;
    this.#hovered = { vertex, edge };
    this.#viewer.canvas.style.cursor = vertex >= 0 || edge ? "pointer" : "";
    this.draw(this.#mesh, this.#isShown);
  }

  viewed() {
    this.#to.viewed();
  }

  /** Moves a vertex in the plane of view by pixels. */
  #shift(vertex, dx, dy) {
    const { camera } = this.#viewer;
    const position = this.#mesh.positions[vertex];
    const size = camera.pixel(this.#viewer.size[1], this.#viewer.depth(position));
    const [right, up] = camera.axes;
    const to = add(position, add(scaled(right, dx * size), scaled(up, -dy * size)));
    // as many decimals as a tenth of a pixel has, which keeps jobs short
    const decimals = Math.min(Math.max(Math.ceil(-Math.log10(size)) + 1, 0), 12);
    to.forEach((value, axis) => { position[axis] = Number(value.toFixed(decimals)); });
  }

  key(event) {
    const n = this.#mesh.positions.length;
    if (event.key === "n" || event.key === "N") {
      this.choose(event.shiftKey ? (this.chosen <= 0 ? n : this.chosen) - 1 : (this.chosen + 1) % n);
      event.preventDefault();
      return true;
    }
    if (event.key === "Escape" && this.chosen >= 0) {
      this.choose(-1);
      return true;
    }
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (this.chosen < 0 || !steps) return this.#tag(event);
    const size = event.shiftKey ? 24 : event.altKey ? 1 : 6;
    this.#shift(this.chosen, steps[0] * size, steps[1] * size);
    this.#to.moved(false);
    event.preventDefault();
    return true;
  }

  /** Keys that tag the chosen vertex. */
  #tag(event) {
    if (event.key !== "c" || this.chosen < 0) return false;
    this.#to.vertex(this.chosen);
    event.preventDefault();
    return true;
  }
}
