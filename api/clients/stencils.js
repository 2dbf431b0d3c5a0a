// Moves the points of a subdivision curve or surface in a page, with the bits of planish's own answer.
//
// A job with the output {"format": "stencils"} or {"format": "stencils-bin"} tells how its points are made of those of
// the input. That depends on connectivity, tags and plan, not on positions: it is fetched once, and applied whenever
// points move. Faces are not in it; the json output of the same job has them, over the same vertices.
//
//     import { parse, Net } from "./stencils.js";
//     const stencils = parse(await (await fetch("/v1/render", { method: "POST", body })).arrayBuffer());
//     const net = new Net(stencils, points);           // a flat array, 3 numbers a point
//     const changed = net.move(17, [0.5, 0.25, 1]);    // point 17 of the input was dragged there
//     draw(net.positions, net.normals(), changed);
//
// Exported: parse, Stencils, Net. No dependencies; for pages, workers and node.
//
// Formula. Values are the points of the input, then those of the rows, one after another; row r weighs values before
// it, and the last rows are the results. A row is the sum of its terms, which begins with 0. A term of one entry is
// weight x value. A term of k entries with one weight is weight x (symmetric sum of the values), one of k entries with
// several weights, told by -k, the symmetric sum of weight x value. The symmetric sum of 2 is a + b, of 4
// (a + c) + (b + d), of 6 the sum of a + d, b + e, c + f from the least to the greatest, coordinate by coordinate, of
// any other number the sum in order. Nothing else is rounded, so every machine has the same bits.

/** The symmetric sum of `k` numbers that `value(j)` gives. */
function symmetric(k, value) {
  if (k === 2) return value(0) + value(1);
  if (k === 4) return value(0) + value(2) + (value(1) + value(3));
  if (k === 6) {
    const [a, b, c] = [value(0) + value(3), value(1) + value(4), value(2) + value(5)];
    const [low, high] = b < a ? [b, a] : [a, b];
    if (c < low) return c + low + high;
    return c < high ? low + c + high : low + high + c;
  }
  let sum = value(0);
  for (let j = 1; j < k; j += 1) sum += value(j);
  return sum;
}

/** The weights of a result. */
export class Stencils {
  /** Of the fields of the JSON form, whose arrays may be typed ones. */
  constructor({ rows, columns, vertices, rational = false, normals = null, starts, indices, weights, terms = null }) {
    /** Number of points of the input. */
    this.columns = columns;
    /** Number of points of the result. */
    this.vertices = vertices;
    /** Number of rows; the last ones are the results. */
    this.rows = rows;
    /** Whether points have a last coordinate by which `project` divides the others. */
    this.rational = rational;
    /** Whether there are tangents, of which `normals` of a net makes normals. */
    this.hasNormals = normals !== null;
    this.pairs = normals === null ? 0 : normals.pairs;
    this.sectors = normals === null ? [] : normals.sectors;
    this.product = normals === null ? "" : normals.product;
    /** The first row of the results: `vertices` points, then two tangents for each of `pairs`. */
    this.first = rows - vertices - 2 * this.pairs;
    this.starts = Uint32Array.from(starts);
    this.indices = indices instanceof Uint32Array ? indices : Uint32Array.from(indices);
    this.weights = weights instanceof Float64Array ? weights : Float64Array.from(weights);
    this.terms = terms === null || terms.length === 0 ? null : Int32Array.from(terms);
    if (this.starts.length !== rows + 1 || this.first < 0 || this.starts[rows] !== this.indices.length
      || this.indices.length !== this.weights.length) {
      throw new Error("these are no stencils: the lengths of the arrays do not fit");
    }
    this.firstTerms = this.terms && this.#firstTerms();
  }

  /** For each row its first term. */
  #firstTerms() {
    const first = new Uint32Array(this.rows);
    let [term, at] = [0, 0];
    for (let row = 0; row < this.rows; row += 1) {
      first[row] = term;
      for (; at < this.starts[row + 1]; term += 1) at += Math.abs(this.terms[term]);
    }
    return first;
  }

  /** Makes the value of a row; `values` has `width` numbers for each point of the input and each row before it. */
  make(row, values, width) {
    if (width === 3) this.#makeInSpace(row, values);
    else for (let c = 0; c < width; c += 1) values[(this.columns + row) * width + c] = this.#sum(row, values, width, c);
  }

  /** One coordinate of the value of a row. */
  #sum(row, values, width, c) {
    const { indices, weights, terms } = this;
    const end = this.starts[row + 1];
    let sum = 0;
    if (terms === null) {
      for (let at = this.starts[row]; at < end; at += 1) sum += weights[at] * values[indices[at] * width + c];
      return sum;
    }
    for (let at = this.starts[row], term = this.firstTerms[row]; at < end; term += 1) {
      const k = Math.abs(terms[term]);
      const first = at;
      const value = (j) => values[indices[first + j] * width + c];
      if (terms[term] > 0) sum += weights[at] * symmetric(k, value);
      else sum += symmetric(k, (j) => weights[first + j] * value(j));
      at += k;
    }
    return sum;
  }

  /** The value of a row for three numbers a point: the usual terms without a call. */
  #makeInSpace(row, values) {
    const { indices, weights, terms } = this;
    const end = this.starts[row + 1];
    const out = (this.columns + row) * 3;
    let [x, y, z] = [0, 0, 0];
    let term = terms === null ? 0 : this.firstTerms[row];
    for (let at = this.starts[row]; at < end; term += 1) {
      const k = terms === null ? 1 : terms[term];
      const w = weights[at];
      const a = indices[at] * 3;
      if (k === 1) {
        x += w * values[a];
        y += w * values[a + 1];
        z += w * values[a + 2];
      } else if (k === 2) {
        const b = indices[at + 1] * 3;
        x += w * (values[a] + values[b]);
        y += w * (values[a + 1] + values[b + 1]);
        z += w * (values[a + 2] + values[b + 2]);
      } else if (k === 4) {
        const b = indices[at + 1] * 3;
        const c = indices[at + 2] * 3;
        const d = indices[at + 3] * 3;
        x += w * (values[a] + values[c] + (values[b] + values[d]));
        y += w * (values[a + 1] + values[c + 1] + (values[b + 1] + values[d + 1]));
        z += w * (values[a + 2] + values[c + 2] + (values[b + 2] + values[d + 2]));
      } else {
        for (let c = 0; c < 3; c += 1) values[out + c] = this.#sum(row, values, 3, c);
        return;
      }
      at += k;
    }
    values[out] = x;
    values[out + 1] = y;
    values[out + 2] = z;
  }

  /** All points of the result: `vertices x width`, of those of the input, `columns x width`. */
  apply(points, width = 3, out = new Float64Array(this.vertices * width)) {
    out.set(new Net(this, points, width).positions);
    return out;
  }

  /** Rational points divided by their last coordinate, which is left out. */
  project(points, width) {
    const out = new Float64Array((points.length / width) * (width - 1));
    for (let i = 0, at = 0; i < points.length; i += width) {
      for (let c = 0; c + 1 < width; c += 1, at += 1) out[at] = points[i + c] / points[i + width - 1];
    }
    return out;
  }

  /**
   * One row for each point of the result over those of the input alone: `starts`, `indices`, `weights`, as JSON has
   * them. Products are rounded otherwise than steps, so that points made of these agree up to rounding only.
   */
  flat() {
    const [columns, rows] = [[], []];
    const sum = new Float64Array(this.columns);
    const seen = new Uint32Array(this.columns);
    const last = this.first + this.vertices;
    for (let row = 0; row < last; row += 1) {
      const touched = [];
      const add = (column, weight) => {
        if (seen[column] !== row + 1) {
          seen[column] = row + 1;
          sum[column] = 0;
          touched.push(column);
        }
        sum[column] += weight;
      };
      for (let at = this.starts[row]; at < this.starts[row + 1]; at += 1) {
        const before = this.indices[at] - this.columns;
        if (before < 0) add(this.indices[at], this.weights[at]);
        else columns[before].forEach((column, k) => add(column, this.weights[at] * rows[before][k]));
      }
      columns.push(Uint32Array.from(touched).sort());
      rows.push(Float64Array.from(columns[row], (column) => sum[column]));
    }
    const starts = [0];
    for (const found of columns.slice(this.first)) starts.push(starts.at(-1) + found.length);
    const [indices, weights] = [new Uint32Array(starts.at(-1)), new Float64Array(starts.at(-1))];
    for (let v = 0; v < this.vertices; v += 1) {
      indices.set(columns[this.first + v], starts[v]);
      weights.set(rows[this.first + v], starts[v]);
    }
    return { starts: Uint32Array.from(starts), indices, weights };
  }

  /** For each value the rows that weigh it, as `starts` and `rows`; found once. */
  get dependents() {
    if (this.found) return this.found;
    const n = this.columns + this.rows;
    const starts = new Uint32Array(n + 2);
    for (const index of this.indices) starts[index + 2] += 1;
    for (let i = 2; i < n + 2; i += 1) starts[i] += starts[i - 1];
    const rows = new Uint32Array(this.indices.length);
    for (let row = 0; row < this.rows; row += 1) {
      for (let at = this.starts[row]; at < this.starts[row + 1]; at += 1) {
        const slot = this.indices[at] + 1;
        rows[starts[slot]] = row;
        starts[slot] += 1;
      }
    }
    this.found = { starts, rows };
    return this.found;
  }
}

/** Of what `parse` was given, the bytes as an aligned array; null for text and objects. */
function bytesOf(data) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  return ArrayBuffer.isView(data) ? new Uint8Array(data.buffer, data.byteOffset, data.byteLength).slice() : null;
}

const TYPES = { f64: Float64Array, u32: Uint32Array, i32: Int32Array };

/** The stencils of an answer: of its bytes, of either format, of its text, or of the object that the text says. */
export function parse(data) {
  const bytes = bytesOf(data);
  if (bytes === null) return new Stencils(typeof data === "string" ? JSON.parse(data) : data);
  const end = bytes.indexOf(10);
  const fields = JSON.parse(new TextDecoder().decode(end < 0 ? bytes : bytes.subarray(0, end)));
  let at = end + 1;
  for (const [name, type, length] of fields.arrays ?? []) {
    fields[name] = new TYPES[type](bytes.buffer, at, length);
    at += fields[name].byteLength;
  }
  return new Stencils(fields);
}

/** Sets of rows that are kept, one for each point of the input that was moved lately. */
const MOST_KEPT = 64;

/** The points of a result, and all that lies between them and those of the input. */
export class Net {
  /** The result of these points of the input, `columns x width` numbers. */
  constructor(stencils, points, width = 3) {
    this.stencils = stencils;
    this.width = width;
    this.values = new Float64Array((stencils.columns + stencils.rows) * width);
    const first = (stencils.columns + stencils.first) * width;
    /** The points of the result, `vertices x width`: always the same array, of which `move` changes some. */
    this.positions = this.values.subarray(first, first + stencils.vertices * width);
    this.marks = new Uint8Array(stencils.rows);
    this.kept = new Map();
    this.set(points);
  }

  /** Takes other points of the input for all of them. */
  set(points) {
    const { stencils, values, width } = this;
    if (points.length !== stencils.columns * width) {
      throw new Error(`${points.length} numbers for ${stencils.columns} points of ${width}`);
    }
    values.set(points);
    for (let row = 0; row < stencils.rows; row += 1) stencils.make(row, values, width);
    return this;
  }

  /** Moves a point of the input; returns which points of the result, or their normals, changed: ascending numbers. */
  move(index, point) {
    return this.moveAll([index], point);
  }

  /** Moves some points of the input, to `points`, one after another; returns what changed as `move` does. */
  moveAll(indices, points) {
    const { stencils, values, width } = this;
    indices.forEach((index, i) => {
      if (!(index >= 0 && index < stencils.columns)) throw new Error(`there is no point ${index}`);
      for (let c = 0; c < width; c += 1) values[index * width + c] = points[i * width + c];
    });
    const { rows, changed } = this.#depending(indices);
    for (const row of rows) stencils.make(row, values, width);
    return changed;
  }

  /** The rows that some points of the input take part in, in their order, and the points of the result among them. */
  #depending(indices) {
    const key = indices.join();
    const found = this.kept.get(key);
    if (found) return found;
    const { marks, stencils } = this;
    const { starts, rows: weighing } = stencils.dependents;
    const rows = [];
    const reach = (value) => {
      for (let at = starts[value]; at < starts[value + 1]; at += 1) {
        if (marks[weighing[at]] === 0) {
          marks[weighing[at]] = 1;
          rows.push(weighing[at]);
        }
      }
    };
    indices.forEach(reach);
    // rows that are found while this goes on are looked at, too
    for (let i = 0; i < rows.length; i += 1) reach(stencils.columns + rows[i]);
    for (const row of rows) marks[row] = 0;
    const sorted = Uint32Array.from(rows).sort();
    const made = { rows: sorted, changed: this.#results(sorted) };
    if (this.kept.size === MOST_KEPT) this.kept.delete(this.kept.keys().next().value);
    this.kept.set(key, made);
    return made;
  }

  /** The points of the result that these rows make, or whose tangents they make. */
  #results(rows) {
    const { first, vertices, sectors } = this.stencils;
    const found = new Set();
    for (const row of rows) {
      const at = row - first;
      if (at < 0) continue;
      const pair = at < vertices ? at : (at - vertices) >> 1;
      found.add(pair < vertices ? pair : sectors[pair - vertices]);
    }
    return Uint32Array.from(found).sort();
  }

  /**
   * Unit normals, `vertices x 3`, zero where two tangents have none; into `out` if it is given, and of some vertices
   * only if these are. Where the server has no limit normal it answers one weighted by area instead.
   */
  normals(out = new Float64Array(this.stencils.vertices * 3), some = null) {
    const { stencils, width } = this;
    if (!stencils.hasNormals || width !== 3) {
      throw new Error('there are no tangents; ask for stencils with "normals": "limit"');
    }
    const beside = new Map();
    stencils.sectors.forEach((v, i) => beside.set(v, [...(beside.get(v) ?? [v]), stencils.vertices + i]));
    const write = (v) => out.set(this.#normal(beside.get(v) ?? [v]), 3 * v);
    if (some !== null) some.forEach(write);
    else for (let v = 0; v < stencils.vertices; v += 1) write(v);
    return out;
  }

  /** The normal of a vertex with these pairs of tangents. */
  #normal(pairs) {
    const normals = pairs.map((pair) => {
      const at = 3 * (this.stencils.columns + this.stencils.first + this.stencils.vertices + 2 * pair);
      const [t, u] = [this.values.subarray(at, at + 3), this.values.subarray(at + 3, at + 6)];
      return this.stencils.product === "of tangents" ? ofTangents(t, u) : ofDirections(t, u);
    });
    if (normals.length === 1) return normals[0];
    if (normals.some((normal) => normal.every((x) => x === 0))) return [0, 0, 0];
    return direction(normals.reduce((sum, normal) => sum.map((x, c) => x + normal[c]), [0, 0, 0]));
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** The sine of the least angle between two tangents that have a normal. */
const LEAST_SINE = 1e-9;

/** A vector at length 1, whatever its length; 0 for one without a direction. */
function direction(v) {
  const largest = Math.max(Math.abs(v[0]), Math.abs(v[1]), Math.abs(v[2]));
  if (!(largest > 0) || largest === Infinity) return [0, 0, 0];
  const scaled = [v[0] / largest, v[1] / largest, v[2] / largest];
  const length = Math.sqrt(dot(scaled, scaled));
  return scaled.map((x) => x / length);
}

/** The direction of the product of the directions of two tangents. */
function ofDirections(t, u) {
  const product = cross(direction(t), direction(u));
  return Math.sqrt(dot(product, product)) > LEAST_SINE ? direction(product) : [0, 0, 0];
}

/** The direction of the product of two tangents, whose squares neither overflow nor vanish as a rule. */
function ofTangents(t, u) {
  const product = cross(t, u);
  const squares = [dot(t, t), dot(u, u), dot(product, product)];
  if (!squares.every((square) => square >= 1e-100 && square <= 1e100)) return ofDirections(t, u);
  const above = squares[2] > LEAST_SINE * LEAST_SINE * squares[0] * squares[1];
  const length = above ? Math.sqrt(squares[2]) : Infinity;
  return product.map((x) => x / length);
}
