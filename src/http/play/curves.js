// The stage for curves: one or two panes, the shapes that follow the control polygon, and its tools.

import { at, count, h, say, tool, warn, write } from "./dom.js";
import { output } from "./lines.js";
import { Pane, View } from "./pane.js";
import { comb, insert, nearestEdge, remove, rounded, tangentsOf, toggleCorner } from "./polygon.js";
import { Refiner } from "./refiner.js";
import { changed, current, state, view } from "./state.js";

/** Curves of more levels than so many points are not drawn level by level, nor their points and combs. */
const MOST_DOTS = 4000;

export class Curves {
  #view = new View();
  #panes;
  #selected = -1;
  #shapes = new Map();
  #refiners = new Map();
  #frame = 0;
  #failed;
  /** What is wrong, by the names of the shapes. */
  #faults = new Map();
  /** Curves drawn since the page was opened. */
  drawn = 0;

  constructor(failed) {
    this.#failed = failed;
    const edit = {
      add: (place) => this.add(place), insert: (edge, place) => this.#insert(edge, place),
      move: (...given) => this.#move(...given), turn: (...given) => this.#turn(...given),
      remove: (point) => this.remove(point), select: (point) => this.select(point),
      split: (point) => this.#split(point), corner: (point) => this.corner(point),
      done: () => changed("points"),
      viewed: () => {
        const { x, y, scale } = this.#view;
        view.curves = [x, y, scale].map((value) => Number(value.toPrecision(6)));
        changed("view", true);
        this.draw();
      },
    };
    this.#panes = [new Pane(this.#view, edit), new Pane(this.#view, edit)];
    output.region = () => this.#region;
  }

  get #polygon() {
    return state.curves.input.polygon;
  }

  /** Puts the stage into the page. */
  open() {
    at("panes").replaceChildren(...this.#panes.map(({ element }) => element));
    this.#panes[1].element.hidden = true;
    this.tools();
    this.look();
  }

  /** Stops what is under way. */
  close() {
    for (const refiner of this.#refiners.values()) refiner.stop();
    this.#refiners.clear();
    this.#shapes.clear();
    this.#faults.clear();
  }

  /** Looks at the whole polygon. */
  fit() {
    this.#view.fit(this.#polygon.points, ...this.#panes[0].size);
    view.curves = null;
    changed("view", true);
    this.draw();
  }

  /** Looks as the address says, else at the whole polygon. */
  look() {
    const kept = view.curves;
    this.fit();
    if (kept) [this.#view.x, this.#view.y, this.#view.scale] = kept;
    view.curves = kept;
  }

  /** What is seen once the view was moved, null while all is. Pictures of curves in space look from elsewhere. */
  get #region() {
    if (!view.curves || this.#polygon.points.some((point) => point.length !== 2)) return null;
    const [x, y, scale] = view.curves;
    return { x, y, scale, size: this.#panes[0].size };
  }

  /** The shape of the job that is shown, as the service or its stencils answered it. */
  shown() {
    return this.#shapes.get("main") ?? null;
  }

  /** Requests for shapes so far. */
  get requests() {
    return [...this.#refiners.values()].reduce((sum, refiner) => sum + refiner.requests, 0);
  }

  /** Whether answers are on their way. */
  get busy() {
    return [...this.#refiners.values()].some((refiner) => refiner.busy);
  }

  /** Has all shapes follow what is in the document. */
  update() {
    const { input, plan, levels, other } = state.curves;
    const { show } = state;
    if (this.#selected >= input.polygon.points.length) this.#selected = -1;
    const wanted = new Map([["main", { input, plan, levels }]]);
    if (show.limits) wanted.set("limits", { input, plan, levels });
    if (other) wanted.set("other", { input, plan: other, levels });
    const steps = show.levels && typeof levels === "number" ? levels - 1 : 0;
    for (let level = 1; level <= steps; level += 1) wanted.set(`level ${level}`, { input, plan, levels: level });
    for (const name of [...this.#refiners.keys()].filter((known) => !wanted.has(known))) {
      this.#refiners.get(name).stop();
      this.#refiners.delete(name);
      this.#shapes.delete(name);
      if (this.#faults.has(name)) this.#fault(name, null);
    }
    if (input.polygon.points.length < 2) this.#shapes.clear();
    else for (const [name, job] of wanted) this.#refiner(name).update(job);
    this.draw();
  }

  #refiner(name) {
    if (!this.#refiners.has(name)) {
      const shown = (shape) => {
        this.#shapes.set(name, shape);
        if (name === "main") warn(shape.warnings ?? []);
        this.#fault(name, null);
        this.draw();
      };
      const options = { positions: name === "limits" ? "limit" : "refined" };
      const failed = (fault) => {
        if (name !== "main") this.#shapes.delete(name);
        this.#fault(name, fault);
        this.draw();
      };
      this.#refiners.set(name, new Refiner(shown, failed, options));
    }
    return this.#refiners.get(name);
  }

  /** Tells what is wrong with a shape, or that nothing is: of several, what is wrong with the one of the scheme. */
  #fault(name, fault) {
    if (fault) this.#faults.set(name, fault);
    else if (!this.#faults.delete(name) && (name !== "main" || this.#faults.size > 0)) return;
    const [worst] = [...this.#faults.keys()].sort((a, b) => (b === "main") - (a === "main"));
    const found = this.#faults.get(worst) ?? null;
    if (worst !== "other" || !found.errors) {
      this.#failed(found);
      return;
    }
    const errors = found.errors.map((one) => ({ ...one, pointer: one.pointer?.replace(/^\/plan/, "/other") }));
    this.#failed(Object.assign(new Error(found.message), { errors }));
  }

  /** Draws in the next frame. */
  draw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#draw();
    });
  }

  #draw() {
    const { show } = state;
    const [first, second] = this.#panes;
    const beside = show.side && this.#shapes.has("other");
    const wasHidden = second.element.hidden;
    second.element.hidden = !beside;
    if (wasHidden === beside) this.#view.fit(this.#polygon.points, ...first.size);
    for (const pane of beside ? [first, second] : [first]) this.#drawPane(pane, beside && pane === second, beside);
    first.title.hidden = second.title.hidden = !beside;
    first.title.textContent = titleOf(state.curves.plan);
    second.title.textContent = state.curves.other ? titleOf(state.curves.other) : "";
    const main = this.#shapes.get("main");
    write(at("counts"), main ? `${count(main.flat.length / main.width)} points` : "");
    this.drawn += 1;
  }

  #drawPane(pane, isSecond, beside) {
    const { show } = state;
    const shape = (name) => this.#shapes.get(name);
    const main = shape(isSecond ? "other" : "main");
    const curves = [];
    if (!isSecond) {
      for (const [name, level] of this.#shapes) if (name.startsWith("level")) curves.push({ ...level, name: "level" });
    }
    if (shape("other") && !beside) curves.push({ ...shape("other"), name: "other" });
    if (main) curves.push({ ...main, name: isSecond ? "other" : "main" });
    const few = main && main.flat.length / main.width <= MOST_DOTS;
    const dots = [];
    if (show.samples && few) dots.push({ ...main, name: "samples" });
    if (show.limits && shape("limits") && !isSecond && few) {
      dots.push({ ...shape("limits"), name: "limits" }, { ...shape("limits"), name: "limits-inside" });
    }
    const combs = [];
    if (show.comb && few) {
      const { teeth, ends } = comb(main.flat, main.width, main.closed);
      combs.push({ name: "comb", flat: teeth, teeth: true }, { name: "comb-end", flat: ends, closed: main.closed });
    }
    const polygon = this.#polygon;
    const turning = Boolean(polygon.tangents);
    pane.draw({ polygon, selected: this.#selected, curves, dots, combs, show, turning });
  }

  /** The tools over the stage. */
  tools() {
    at("tools").replaceChildren(
      tool("tool-closed", "closed", "Closed", "Close or open the polygon", () => this.#toggleClosed()),
      tool("tool-corner", "corner", "Corner", "Make the chosen point a corner (C)", () => this.corner(this.#selected)),
      tool("tool-delete", "delete", "Delete", "Delete the chosen point (Delete)", () => this.remove(this.#selected)),
      tool("tool-tangents", "tangents", "Tangents", "Give each point a tangent to turn", () => this.#toggleTangents()),
      h("hr"),
      tool("tool-clear", "draw", "Draw anew", "Begin with no points", () => this.#clear()),
      tool("tool-fit", "fit", "Fit", "Look at all of it (F)", () => this.fit()),
    );
    this.refreshTools();
  }

  /** Has the tools say how things stand. */
  refreshTools() {
    const { closed, corners = [], tangents } = this.#polygon;
    const chosen = this.#selected >= 0;
    at("tool-closed").setAttribute("aria-pressed", String(Boolean(closed)));
    at("tool-corner").setAttribute("aria-pressed", String(chosen && corners.includes(this.#selected)));
    at("tool-corner").disabled = !chosen;
    at("tool-delete").disabled = !chosen;
    at("tool-tangents").setAttribute("aria-pressed", String(Boolean(tangents)));
    at("tool-tangents").hidden = !tangents && !this.takesTangents;
    const n = this.#polygon.points.length;
    write(at("hint"), n < 3
      ? "Tap the paper to put points." : "Drag a point: the curve follows. Tap the paper to add points.");
  }

  /** Chooses a point. */
  select(point) {
    this.#selected = point;
    this.refreshTools();
    this.draw();
  }

  /** Adds a point: at the end while the polygon is open or short, else in the edge next to it. */
  add(place) {
    const polygon = this.#polygon;
    const { points, closed } = polygon;
    const index = closed && points.length > 2 ? nearestEdge(polygon, place) + 1 : points.length;
    this.#put(index, place);
    changed("points");
  }

  #put(index, [x, y]) {
    insert(this.#polygon, index, [rounded(x, this.#view.scale), rounded(y, this.#view.scale)]);
    this.select(index);
    say(`Point ${index + 1} of ${this.#polygon.points.length} added`);
    return index;
  }

  #insert(edge, place) {
    const index = this.#put(edge + 1, place);
    changed("points", true);
    return index;
  }

  #split(point) {
    const { points, closed } = this.#polygon;
    const next = point + 1 < points.length ? point + 1 : closed ? 0 : point - 1;
    const middle = [0, 1].map((axis) => (points[point][axis] + points[next][axis]) / 2);
    const index = this.#put(Math.max(point, next > point ? point : next) + (next < point && !closed ? 0 : 1), middle);
    changed("points");
    this.#draw();
    return index;
  }

  #move(point, to, live, size = 0) {
    const was = this.#polygon.points[point];
    const [x, y] = size ? [was[0] + to[0] * size, was[1] + to[1] * size] : to;
    was[0] = rounded(x, this.#view.scale);
    was[1] = rounded(y, this.#view.scale);
    changed("points", live);
  }

  #turn(point, to, live) {
    const polygon = this.#polygon;
    const [px, py] = polygon.points[point];
    const [dx, dy] = [to[0] - px, to[1] - py];
    const length = Math.hypot(dx, dy);
    if (length === 0) return;
    polygon.tangents[point] = [rounded(dx / length, 1e3), rounded(dy / length, 1e3)];
    changed("points", live);
  }

  /** Takes a point out. */
  remove(point) {
    const polygon = this.#polygon;
    if (point < 0 || point >= polygon.points.length) return;
    remove(polygon, point);
    say(`Point ${point + 1} deleted, ${polygon.points.length} left`);
    this.select(Math.min(point, polygon.points.length - 1));
    changed("points");
    this.#draw();
    this.#panes[0].focus(this.#selected);
  }

  /** Makes a point a corner, or smooth again. */
  corner(point) {
    if (point < 0) return;
    toggleCorner(this.#polygon, point);
    changed("points");
    this.refreshTools();
  }

  #toggleClosed() {
    this.#polygon.closed = !this.#polygon.closed;
    changed("points");
    this.refreshTools();
  }

  #toggleTangents() {
    const polygon = this.#polygon;
    if (polygon.tangents) delete polygon.tangents;
    else polygon.tangents = tangentsOf(polygon).map((tangent) => tangent.map((value) => rounded(value, 1e3)));
    changed("points");
    this.refreshTools();
  }

  #clear() {
    current().input = { polygon: { points: [], closed: this.#polygon.closed } };
    this.select(-1);
    changed("points");
  }

  /** What the analysis is asked about. */
  question() {
    return { plan: state.curves.plan, matrices: { points: 5, closed: Boolean(this.#polygon.closed) } };
  }

  /** Keys of the stage that belong to no point. */
  key(event) {
    if (event.key === "f") this.fit();
    else return false;
    return true;
  }
}

/** A plan in a few words. */
export const titleOf = (plan) => plan.preset ?? (plan.word ? `word ${plan.word}` : "no scheme");
