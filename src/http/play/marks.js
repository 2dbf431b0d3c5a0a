// Lines and dots over a surface, in named groups of which those rows are sent that changed.

import { arrayOf, filled, refill } from "./buffers.js";

/** The ends and the sides of a line, as its four vertices have them, and the two triangles over these. */
const SIDES = [[0, -1], [1, -1], [0, 1], [1, 1]];
const HALVES = [0, 1, 2, 2, 1, 3];
/** Numbers of a line as it is given (two ends, a colour), of one of its vertices (with its side), and of a dot. */
const LINE = 10;
const LINE_VERTEX = 12;
const DOT = 8;
/** Most rows that are sent one by one when they change. */
const MOST_SENT = 24;

export class Marks {
  #gl;
  #programs;
  #layers;
  #touch;
  #groups = new Map();

  /** Marks that tell `layers` where they change by `touch(rows, step, to, from)`. */
  constructor(gl, programs, layers, touch) {
    this.#gl = gl;
    this.#programs = programs;
    this.#layers = layers;
    this.#touch = touch;
  }

  /** Shows rows of a kind, "lines" or "dots", in place of those that the group had. */
  set(name, kind, rows, options) {
    const size = kind === "lines" ? LINE : DOT;
    const values = Float32Array.from(rows);
    const known = this.#groups.get(name);
    if (known?.rows.length === values.length) {
      Object.assign(known, options);
      this.#change(known, values, size);
      return;
    }
    this.#layers.forget();
    if (known) this.#delete(known);
    this.#groups.set(name, { kind, rows: values, ...options, ...this.#group(kind, values, values.length / size) });
  }

  /** Sends the rows of a group that changed, and tells where they were and where they are. */
  #change(group, values, size) {
    const changed = [];
    for (let row = 0; row < values.length; row += size) {
      let at = row;
      while (at < row + size && values[at] === group.rows[at]) at += 1;
      if (at < row + size) changed.push(row);
    }
    for (const rows of [group.rows, values]) {
      for (const row of changed) this.#touch(rows, 3, row + (group.kind === "lines" ? 6 : 3), row);
    }
    group.rows = values;
    const width = group.kind === "lines" ? 4 * LINE_VERTEX : DOT;
    const send = (from, to) => {
      const part = values.subarray(from, to);
      refill(this.#gl, group.buffer, group.kind === "lines" ? sides(part) : part, from / size * width * 4);
    };
    if (changed.length <= MOST_SENT) for (const row of changed) send(row, row + size);
    else send(0, values.length);
  }

  #group(kind, values, n) {
    const gl = this.#gl;
    if (kind === "dots") {
      const buffer = filled(gl, values);
      const stride = 4 * DOT;
      const given = { position: [buffer, 3, stride], tint: [buffer, 4, stride, 12], large: [buffer, 1, stride, 28] };
      return { n, buffer, array: arrayOf(gl, this.#programs.dots, given) };
    }
    const buffer = filled(gl, sides(values));
    const order = Uint32Array.from({ length: 6 * n }, (_, at) => 4 * Math.floor(at / 6) + HALVES[at % 6]);
    const indices = filled(gl, order, gl.ELEMENT_ARRAY_BUFFER);
    const stride = 4 * LINE_VERTEX;
    const given = {
      from: [buffer, 3, stride], to: [buffer, 3, stride, 12], tint: [buffer, 4, stride, 24],
      corner: [buffer, 2, stride, 40],
    };
    return { n: 6 * n, buffer, indices, array: arrayOf(gl, this.#programs.lines, given, indices) };
  }

  #delete({ buffer, indices, array }) {
    this.#gl.deleteBuffer(buffer);
    if (indices) this.#gl.deleteBuffer(indices);
    this.#gl.deleteVertexArray(array);
  }

  /** Draws all groups, first what the surface hides of them; `paper` is the colour inside of dots. */
  draw({ matrix, size, ratio, paper }) {
    const gl = this.#gl;
    // machines that are slow see hidden lines again when nothing moves
    for (const pass of ratio < 0.7 ? ["before"] : ["behind", "before"]) {
      gl.depthMask(pass === "before");
      gl.depthFunc(pass === "before" ? gl.LEQUAL : gl.GREATER);
      for (const group of this.#groups.values()) this.#drawGroup(group, pass, { matrix, size, ratio, paper });
    }
    gl.depthMask(true);
    gl.depthFunc(gl.LEQUAL);
  }

  #drawGroup({ kind, array, n, width, behind, lift = 8e-5 }, pass, { matrix, size, ratio, paper }) {
    if (n === 0 || (pass === "behind" && behind === 0)) return;
    const gl = this.#gl;
    const { program, places } = this.#programs[kind];
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    gl.uniform1f(places.lift, pass === "before" ? lift : 0);
    gl.uniform1f(places.fade, pass === "before" ? 1 : behind);
    gl.bindVertexArray(array);
    if (kind === "lines") {
      gl.uniform2fv(places.size, size);
      gl.uniform1f(places.width, width * ratio);
      gl.drawElements(gl.TRIANGLES, n, gl.UNSIGNED_INT, 0);
    } else {
      gl.uniform3fv(places.paper, paper);
      gl.uniform1f(places.ratio, ratio);
      gl.drawArrays(gl.POINTS, 0, n);
    }
    gl.bindVertexArray(null);
  }
}

/** The four vertices of each line. */
function sides(rows) {
  const out = new Float32Array(rows.length / LINE * 4 * LINE_VERTEX);
  let to = 0;
  for (let at = 0; at < rows.length; at += LINE) {
    for (const [end, side] of SIDES) {
      for (let i = 0; i < LINE; i += 1) out[to + i] = rows[at + i];
      out[to + LINE] = end;
      out[to + LINE + 1] = side;
      to += LINE_VERTEX;
    }
  }
  return out;
}
