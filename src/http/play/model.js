// A surface in buffers, whole or parted into what moves and the rest.

import { arrayOf, filled, refill } from "./buffers.js";

export class Model {
  #gl;
  #programs;
  #layers;
  #touch;
  #whole = null;
  #part = null;

  /** A surface that tells `layers` where it changes by `touch(rows, step, to, from)`. */
  constructor(gl, programs, layers, touch) {
    this.#gl = gl;
    this.#programs = programs;
    this.#layers = layers;
    this.#touch = touch;
  }

  /** The meshes to draw: what stays, and what moves, which is null where nothing is known to stay. */
  get meshes() {
    return this.#part ? { still: this.#part.rest, moving: this.#part.mesh } : { still: this.#whole, moving: null };
  }

  /** Takes positions and normals of vertices, triangles, the ends of edges; with `part` nothing else changed. */
  set({ positions, normals, triangles, wires, part }) {
    if (this.#whole?.of !== triangles || this.#whole.count !== positions.length) {
      this.clear();
      const made = this.#mesh({ positions: Float32Array.from(positions), normals, triangles, wires });
      this.#whole = Object.assign(made, { of: triangles, count: positions.length });
    } else if (part && this.#part?.of === part) {
      this.#move(positions, normals);
      return;
    } else {
      refill(this.#gl, this.#whole.positions, Float32Array.from(positions));
      refill(this.#gl, this.#whole.normals, normals);
    }
    this.#layers.forget();
    this.#dropPart();
    if (part) this.#part = this.#parted(part, positions, normals);
  }

  /** Shows no surface. */
  clear() {
    this.#dropPart();
    if (this.#whole) this.#delete(this.#whole, ["positions", "normals"]);
    this.#whole = null;
    this.#layers.forget();
  }

  #mesh({ positions, normals, triangles, wires }) {
    const buffers = { positions: filled(this.#gl, positions), normals: filled(this.#gl, normals) };
    return this.#indexed(buffers, { triangles, wires });
  }

  /** Triangles and wires over buffers of positions and normals. */
  #indexed(buffers, { triangles, wires = new Uint32Array(0) }) {
    const gl = this.#gl;
    const target = gl.ELEMENT_ARRAY_BUFFER;
    const [indices, ends] = [filled(gl, triangles, target), filled(gl, wires, target)];
    const given = { position: [buffers.positions, 3], normal: [buffers.normals, 3] };
    return {
      ...buffers, indices, ends, n: triangles.length, nWires: wires.length,
      faces: arrayOf(gl, this.#programs.surface, given, indices),
      lines: arrayOf(gl, this.#programs.wires, given, ends),
    };
  }

  #parted(part, positions, normals) {
    const { vertices, triangles, wires, rest } = part;
    const n = 3 * vertices.length;
    const taken = { positions: new Float32Array(n), normals: new Float32Array(n) };
    take(vertices, positions, taken.positions);
    take(vertices, normals, taken.normals);
    const mesh = this.#mesh({ ...taken, triangles, wires });
    return { of: part, taken, mesh, rest: this.#indexed(this.#whole, rest) };
  }

  /** Moves the part, and tells where it was and where it is. */
  #move(positions, normals) {
    const { of, taken, mesh } = this.#part;
    this.#touch(taken.positions, 3, taken.positions.length);
    take(of.vertices, positions, taken.positions);
    take(of.vertices, normals, taken.normals);
    this.#touch(taken.positions, 3, taken.positions.length);
    refill(this.#gl, mesh.positions, taken.positions);
    refill(this.#gl, mesh.normals, taken.normals);
  }

  #dropPart() {
    if (!this.#part) return;
    this.#delete(this.#part.mesh, ["positions", "normals"]);
    this.#delete(this.#part.rest, []);
    this.#part = null;
  }

  #delete(mesh, more) {
    for (const name of ["indices", "ends", ...more]) this.#gl.deleteBuffer(mesh[name]);
    for (const name of ["faces", "lines"]) this.#gl.deleteVertexArray(mesh[name]);
  }
}

/** Copies the three numbers of each of these vertices, one behind the other. */
function take(vertices, from, out) {
  for (let i = 0; i < vertices.length; i += 1) {
    const at = 3 * vertices[i];
    out[3 * i] = from[at];
    out[3 * i + 1] = from[at + 1];
    out[3 * i + 2] = from[at + 2];
  }
}
