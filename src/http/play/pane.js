// One picture of a control polygon and its curves in SVG, in which points are drawn, dragged, inserted and deleted.

import { s, short } from "./dom.js";
import { Pieces, pathOf } from "./pieces.js";
import { tangentsOf } from "./polygon.js";

/** Movement in pixels below which a press is a tap. Half of it makes taps of fingers into drags; twice of it makes
    drags jump. */
const TAP = 5;
const TANGENT_PX = 52;
/** Edges of a control polygon that is drawn dashed: each dash of a longer one costs more time than it tells. */
const MOST_DASHED = 60;
/** Points of a curve, and of a control polygon that is not dashed, that are drawn as one path. Half of it makes more
    elements than are worth a drag; twice of it draws twice as much anew when a point moves. */
const CURVE_PIECE = 128;
const POLYGON_PIECE = 8;

/** Sets an attribute where it is another: what stays as it is need not be drawn again. */
function put(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** Where a pane looks: the point in its centre, and pixels a unit. */
export class View {
  x = 0;
  y = 0;
  scale = 40;

  /** Looks at all points, in a pane of this size. */
  fit(points, width, height) {
    if (points.length === 0 || width < 10) return;
    const of = (axis) => points.map((point) => point[axis]);
    const [left, right] = [Math.min(...of(0)), Math.max(...of(0))];
    const [low, high] = [Math.min(...of(1)), Math.max(...of(1))];
    this.x = (left + right) / 2;
    this.y = (low + high) / 2;
    const scale = Math.min(width * 0.72 / (right - left || 1), (height - 150) * 0.9 / (high - low || 1));
    this.scale = Math.max(scale, 1e-6);
  }
}

export class Pane {
  #view;
  #edit;
  #layers;
  #points = [];
  #pieces = { polygons: [], curves: [] };
  #size = [0, 0];
  /** Where points and edges were drawn last. */
  #drawn = { points: [], edges: [] };
  #fingers = new Map();
  #pressed = null;

  /** A pane that looks through `view` and calls `edit` back: add, insert, move, turn, remove, select, viewed. */
  constructor(view, edit) {
    this.#view = view;
    this.#edit = edit;
    const layer = (name) => s("g", { class: name });
    const names = ["combs", "dashes", "polygons", "edges", "curves", "marks", "tangents", "points"];
    this.#layers = Object.fromEntries(names.map((name) => [name, layer(name)]));
    this.svg = s("svg", { role: "group", "aria-label": "Control polygon and curve", tabindex: "-1" });
    this.svg.append(...Object.values(this.#layers));
    this.title = document.createElement("p");
    this.title.className = "title";
    this.title.hidden = true;
    this.element = document.createElement("div");
    this.element.className = "pane";
    this.element.append(this.svg, this.title);
    this.svg.onpointerdown = (event) => this.#press(event);
    this.svg.onpointermove = (event) => this.#drag(event);
    this.svg.onpointerup = (event) => this.#release(event);
    this.svg.onpointercancel = (event) => this.#release(event);
    this.svg.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    this.svg.onkeydown = (event) => this.#key(event);
  }

  get size() {
    return [this.element.clientWidth, this.element.clientHeight];
  }

  /** Pixels of a point of the plane. */
  #seen(x, y) {
    const [width, height] = this.#size;
    return [width / 2 + (x - this.#view.x) * this.#view.scale, height / 2 - (y - this.#view.y) * this.#view.scale];
  }

  /** The point of the plane at a pointer. */
  #place({ clientX, clientY }) {
    const box = this.svg.getBoundingClientRect();
    const x = this.#view.x + (clientX - box.left - box.width / 2) / this.#view.scale;
    const y = this.#view.y - (clientY - box.top - box.height / 2) / this.#view.scale;
    return [x, y];
  }

  /** Dots at points: strokes of no length with round ends. */
  #dots(flat, width) {
    const parts = [];
    for (let at = 0; at < flat.length; at += width) {
      const [x, y] = this.#seen(flat[at], flat[at + 1]);
      parts.push(`M${x.toFixed(1)} ${y.toFixed(1)}h0`);
    }
    return parts.join("");
  }

  /** Has as many children in a layer as there are things, made once and changed later. */
  #matched(layer, count, make) {
    const group = this.#layers[layer];
    while (group.childElementCount > count) group.lastChild.remove();
    while (group.childElementCount < count) group.append(make(group.childElementCount));
    return group.children;
  }

  #paths(layer, given) {
    const found = this.#matched(layer, given.length, () => s("path"));
    given.forEach(({ name, d }, at) => {
      put(found[at], "class", name);
      put(found[at], "d", d);
    });
  }

  /** Draws paths of many points, `size` of them in one piece. */
  #strands(layer, given, size) {
    const groups = this.#matched(layer, given.length, () => s("g"));
    const pieces = this.#pieces[layer];
    pieces.length = Math.min(pieces.length, given.length);
    const [x, y] = this.#seen(0, 0);
    given.forEach(({ name, flat, width, closed }, at) => {
      put(groups[at], "class", name);
      pieces[at] ??= new Pieces(groups[at], size);
      pieces[at].draw({ flat, width, closed }, { x, y, scale: this.#view.scale });
    });
  }

  /** Draws the polygon and the curves `{ name, flat, width, closed }`, dots and combs given alike. */
  draw({ polygon, selected, curves, dots, combs, show, turning }) {
    // asked before anything is changed, so that the page is not laid out twice
    this.#size = this.size;
    const { points, closed } = polygon;
    const seen = points.map(([x, y]) => this.#seen(x, y));
    const [x, y] = this.#seen(0, 0);
    const view = { x, y, scale: this.#view.scale };
    const whole = (flat, width, round) => pathOf({ flat, width }, view, 0, flat.length / width - 1, round ? "Z" : "");
    const line = { flat: points.flatMap(([px, py]) => [px, py]), width: 2, closed };
    const [isShown, isMany] = [show.polygon && points.length > 1, points.length > MOST_DASHED];
    this.#paths("dashes", isShown && !isMany ? [{ name: "polygon", d: whole(line.flat, 2, closed) }] : []);
    this.#strands("polygons", isShown && isMany ? [{ ...line, name: "polygon many" }] : [], POLYGON_PIECE);
    this.#strands("curves", curves.map((curve) => ({ ...curve, name: `curve ${curve.name}` })), CURVE_PIECE);
    this.#paths("combs", combs.map(({ name, flat, closed: round, teeth }) => (
      { name, d: teeth ? this.#teeth(flat) : whole(flat, 2, round) })));
    this.#paths("marks", dots.map(({ name, flat, width }) => ({ name: `dots ${name}`, d: this.#dots(flat, width) })));
    this.#drawEdges(seen, closed);
    this.#drawPoints(seen, polygon, selected);
    this.#drawTangents(seen, turning ? tangentsOf(polygon) : []);
    this.#drawGrid();
  }

  #teeth(flat) {
    const parts = [];
    for (let at = 0; at < flat.length; at += 4) {
      const [a, b] = [this.#seen(flat[at], flat[at + 1]), this.#seen(flat[at + 2], flat[at + 3])];
      parts.push(`M${a[0].toFixed(1)} ${a[1].toFixed(1)}L${b[0].toFixed(1)} ${b[1].toFixed(1)}`);
    }
    return parts.join("");
  }

  #drawEdges(seen, closed) {
    const n = seen.length < 2 ? 0 : seen.length - (closed && seen.length > 2 ? 0 : 1);
    const lines = this.#matched("edges", n, (at) => s("line", { class: "edge", "data-edge": at }));
    const last = this.#drawn.edges;
    last.length = Math.min(last.length, n);
    for (let i = 0; i < n; i += 1) {
      const ends = [...seen[i], ...seen[(i + 1) % seen.length]];
      if (last[i]?.every((value, at) => value === ends[at])) continue;
      last[i] = ends;
      ["x1", "y1", "x2", "y2"].forEach((name, at) => lines[i].setAttribute(name, ends[at].toFixed(1)));
    }
  }

  #drawPoints(seen, polygon, selected) {
    const corners = new Set(polygon.corners ?? []);
    this.#points = this.#matched("points", seen.length, (at) => s(
      "g", { class: "point", tabindex: "0", role: "button", "data-point": at }, s("circle", { class: "reach", r: 15 }),
      s("circle", { class: "dot", r: 6 }),
    ));
    const last = this.#drawn.points;
    last.length = Math.min(last.length, seen.length);
    seen.forEach(([x, y], at) => {
      const [px, py] = polygon.points[at];
      const now = [x, y, px, py, corners.has(at), at === selected];
      if (last[at]?.every((value, i) => value === now[i])) return;
      last[at] = now;
      const point = this.#points[at];
      put(point, "transform", `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
      point.classList.toggle("corner", corners.has(at));
      point.classList.toggle("selected", at === selected);
      const kind = corners.has(at) ? "Corner point" : "Point";
      put(point, "aria-label", `${kind} ${at + 1} at ${short(px)}, ${short(py)}`);
    });
  }

  #drawTangents(seen, tangents) {
    const marks = this.#matched("tangents", tangents.length, () => s(
      "g", {}, s("line", { class: "tangent" }), s("circle", { class: "tangent-tip", r: 6 }),
    ));
    tangents.forEach(([dx, dy], at) => {
      const [x, y] = seen[at];
      const size = TANGENT_PX / (Math.hypot(dx, dy) || 1);
      const [tx, ty] = [x + dx * size, y - dy * size];
      const [line, tip] = marks[at].children;
      for (const [name, value] of Object.entries({ x1: x, y1: y, x2: tx, y2: ty })) line.setAttribute(name, value);
      tip.setAttribute("cx", tx);
      tip.setAttribute("cy", ty);
      tip.dataset.tangent = at;
    });
  }

  /** The grid is a background, which costs nothing when the curve is drawn again. */
  #drawGrid() {
    const { scale } = this.#view;
    let step = 10 ** Math.ceil(Math.log10(28 / scale));
    if (step * scale > 140) step /= 5;
    else if (step * scale > 70) step /= 2;
    const size = step * scale;
    const [x, y] = this.#seen(0, 0).map((place) => (place + size / 2) % size - size);
    const { style } = this.element;
    style.backgroundSize = `${size.toFixed(3)}px ${size.toFixed(3)}px`;
    style.backgroundPosition = `${x.toFixed(1)}px ${y.toFixed(1)}px`;
  }

  /** Puts the focus on a point. */
  focus(at) {
    this.#points[at]?.focus({ preventScroll: true });
  }

  #press(event) {
    if (event.button > 0) return;
    this.svg.setPointerCapture(event.pointerId);
    this.#fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (this.#fingers.size === 2) {
      this.#pressed = { kind: "pinch", span: this.#span() };
      return;
    }
    const { target } = event;
    const point = target.closest?.("[data-point]");
    const start = { x: event.clientX, y: event.clientY, moved: false };
    if (point) {
      this.#pressed = { kind: "point", at: Number(point.dataset.point), ...start };
      this.#edit.select(this.#pressed.at);
      this.focus(this.#pressed.at);
    } else if (target.dataset?.tangent !== undefined) {
      this.#pressed = { kind: "tangent", at: Number(target.dataset.tangent), ...start };
    } else if (target.dataset?.edge !== undefined) {
      const at = this.#edit.insert(Number(target.dataset.edge), this.#place(event));
      this.#pressed = { kind: "point", at, ...start, moved: true };
    } else {
      this.#pressed = { kind: "view", from: [this.#view.x, this.#view.y], ...start };
    }
    event.preventDefault();
  }

  #drag(event) {
    if (!this.#pressed || !this.#fingers.has(event.pointerId)) return;
    this.#fingers.set(event.pointerId, [event.clientX, event.clientY]);
    const pressed = this.#pressed;
    if (pressed.kind === "pinch") {
      const span = this.#span();
      this.#zoom(span.length / pressed.span.length, { clientX: span.x, clientY: span.y });
      this.#view.x -= (span.x - pressed.span.x) / this.#view.scale;
      this.#view.y += (span.y - pressed.span.y) / this.#view.scale;
      pressed.span = span;
      this.#edit.viewed();
      return;
    }
    const [dx, dy] = [event.clientX - pressed.x, event.clientY - pressed.y];
    if (!pressed.moved && Math.hypot(dx, dy) < TAP) return;
    pressed.moved = true;
    if (pressed.kind === "point") this.#edit.move(pressed.at, this.#place(event), true);
    else if (pressed.kind === "tangent") this.#edit.turn(pressed.at, this.#place(event), true);
    else if (pressed.kind === "view") {
      this.#view.x = pressed.from[0] - dx / this.#view.scale;
      this.#view.y = pressed.from[1] + dy / this.#view.scale;
      this.#edit.viewed();
    }
  }

  #release(event) {
    this.#fingers.delete(event.pointerId);
    const pressed = this.#pressed;
    this.#pressed = null;
    if (!pressed || pressed.kind === "pinch") return;
    const isTap = !pressed.moved && event.type === "pointerup";
    if (pressed.kind === "view" && isTap) this.#edit.add(this.#place(event));
    else if (pressed.kind !== "view" && pressed.moved) this.#edit.done();
  }

  #span() {
    const [[ax, ay], [bx, by]] = [...this.#fingers.values()];
    return { x: (ax + bx) / 2, y: (ay + by) / 2, length: Math.hypot(ax - bx, ay - by) || 1 };
  }

  #wheel(event) {
    event.preventDefault();
    this.#zoom(Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0015)), event);
    this.#edit.viewed();
  }

  #zoom(factor, place) {
    const [x, y] = this.#place(place);
    const scale = Math.min(Math.max(this.#view.scale * factor, 1e-5), 1e7);
    this.#view.x = x + (this.#view.x - x) * this.#view.scale / scale;
    this.#view.y = y + (this.#view.y - y) * this.#view.scale / scale;
    this.#view.scale = scale;
  }

  #key(event) {
    const point = event.target.closest?.("[data-point]");
    if (!point) return;
    const at = Number(point.dataset.point);
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (steps) {
      const size = (event.shiftKey ? 24 : event.altKey ? 1 : 6) / this.#view.scale;
      this.#edit.move(at, steps, false, size);
    } else if (event.key === "Delete" || event.key === "Backspace") this.#edit.remove(at);
    else if (event.key === "Insert" || event.key === "i") this.focus(this.#edit.split(at));
    else if (event.key === "c" && !event.ctrlKey && !event.metaKey) this.#edit.corner(at);
    else if (event.key === "Enter" || event.key === " ") this.#edit.select(at);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
