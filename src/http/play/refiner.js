// One refined shape that follows its job: by the service's answers, and while points move by stencils in the page.
//
// Stencils depend on everything of a job but positions. Once they are there, moving a point needs no request, and the
// result has the same bits as the service's own answer.

import { Latest, catalogue, refined, render } from "./service.js";

/** How long a job stays as it is before its stencils are fetched. Half of it fetches some in vain while sliders move;
    twice of it answers the first moments of more drags by requests. */
const CALM_MS = 120;

/** Most numbers in the input of a job whose stencils are fetched: larger ones follow by requests. */
const MOST_NUMBERS = 200_000;

/** Most points of which each finds what depends on it; more are as soon all made anew. */
const MOST_MOVED = 4;

/** The format of weights of points, where the service lists it. */
const FORMAT = "stencils-bin";

const stencils = () => import("./stencils.js");

/** Positions of points, one behind the other, with the number of coordinates of each. */
export function flattened(points) {
  const width = points[0]?.length ?? 0;
  const flat = new Float64Array(points.length * width);
  for (let i = 0; i < points.length; i += 1) for (let j = 0; j < width; j += 1) flat[i * width + j] = points[i][j];
  return { flat, width };
}

const positionsOf = (input) => input.polygon?.points ?? input.mesh.positions;

/** Everything of a job that its stencils depend on. */
function structure({ input, plan, levels }) {
  const { points, positions, ...rest } = input.polygon ?? input.mesh;
  const { polygon, mesh, ...beside } = input;
  return JSON.stringify([(points ?? positions).length, rest, beside, plan, levels]);
}

/** Has a net follow its points. Returns which points of the result moved, or null for all of them. */
function follow(net, points) {
  const { values, width } = net;
  const moved = [];
  for (let i = 0; i < points.length; i += 1) {
    for (let j = 0; j < width; j += 1) {
      if (values[i * width + j] === points[i][j]) continue;
      moved.push(i);
      break;
    }
  }
  if (moved.length <= MOST_MOVED) return net.moveAll(moved, moved.flatMap((i) => points[i]));
  net.set(flattened(points).flat);
  return null;
}

export class Refiner {
  #shown;
  #options;
  #net = null;
  #faces = null;
  #wanted = "";
  #timer = 0;
  #requests;
  #refused = new Set();
  /** How many requests for shapes were made, for those who count. */
  requests = 0;

  /**
   * Hands results to `shown`: `{ flat, width, closed, faces, isolines, level, bound }`, faults to `failed`; `moved` are
   * the points that moved since the last result, where others did not. `options` are those of the json output.
   */
  constructor(shown, failed, options = {}) {
    this.#shown = shown;
    this.#options = options;
    // what was stopped tells of nothing any more
    this.#requests = new Latest((job, key) => this.#fetch(job, key), (fault) => {
      if (this.#wanted) failed(fault);
    });
  }

  /** Whether an answer is on its way. */
  get busy() {
    return this.#requests.busy;
  }

  /** Shows the job; `live` while something is dragged. */
  update(job) {
    const key = structure(job);
    const points = positionsOf(job.input);
    if (this.#net?.key === key) {
      this.#wanted = key;
      this.#showNet(follow(this.#net.net, points));
      return;
    }
    this.#wanted = key;
    if (key !== this.#net?.key) this.#net = null;
    this.#requests.ask(job, key);
  }

  #showNet(moved) {
    const { net, told } = this.#net;
    const { stencils } = net;
    // rational points are divided, all of them by a copy
    if (stencils.rational) this.#shown({ ...told, flat: stencils.project(net.positions, net.width) });
    else this.#shown({ ...told, flat: net.positions, moved });
  }

  /** Forgets what is under way. */
  stop() {
    clearTimeout(this.#timer);
    this.#wanted = "";
    this.#net = null;
  }

  async #fetch(job, key) {
    if (key !== this.#wanted) return;
    this.requests += 1;
    const answer = await refined(job, this.#options);
    // while a slider moves, what comes is a little older than what is wanted; stencils are newer
    if (!this.#wanted || this.#net) return;
    const { points, positions, ...rest } = answer;
    const told = { ...flattened(points ?? positions), ...rest };
    this.#faces = { key, told };
    this.#shown(told);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#prepare(job, key), CALM_MS);
  }

  async #prepare(job, key) {
    const points = positionsOf(job.input);
    const { width } = flattened(points.slice(0, 1));
    if (points.length * width > MOST_NUMBERS || this.#refused.has(JSON.stringify(job.plan))) return;
    try {
      if (!(await catalogue("formats")).some(({ name }) => name === FORMAT)) return;
      const { parse, Net } = await stencils();
      const answer = await render(job, { format: FORMAT, positions: this.#options.positions ?? "refined" });
      const parsed = parse(await answer.arrayBuffer());
      if (key !== this.#wanted || this.#faces?.key !== key || parsed.columns !== points.length) return;
      const { flat } = flattened(points);
      this.#net = { key, net: new Net(parsed, flat, width), told: this.#faces.told };
      // points may have moved since the last answer, and answers under way are passed over from now on
      const { net, told } = this.#net;
      if (!parsed.rational && told.flat.some((value, i) => value !== net.positions[i])) this.#showNet(null);
    } catch {
      // schemes without weights go on by requests
      this.#refused.add(JSON.stringify(job.plan));
    }
  }
}
