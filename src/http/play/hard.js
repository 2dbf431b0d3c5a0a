// A surface with hard edges: whole, and while a point moves that part alone which follows it.

import { hardened, trianglesOf, wiresOf } from "./mesh.js";
import { parted, turn, turnedBy } from "./part.js";

export class Hard {
  #degrees;
  #faces = null;
  #made = null;
  #part = null;

  /** Of surfaces whose edges of more than `degrees` look hard. */
  constructor(degrees) {
    this.#degrees = degrees;
  }

  /** The surface of these positions as viewers take it; which edges are hard is found anew. */
  whole(flat, faces) {
    const { positions, normals, faces: split, joined } = hardened(flat, faces, this.#degrees);
    if (this.#faces !== faces) {
      const triangles = trianglesOf(split);
      this.#faces = faces;
      this.#made = { triangles, wires: wiresOf(split, positions.length / 3), vertices: Uint32Array.from(faces.flat()) };
    }
    Object.assign(this.#made, { positions, normals, joined, around: null });
    this.#part = null;
    const { triangles, wires } = this.#made;
    return { positions, normals, triangles, wires };
  }

  /**
   * The same surface where the vertices `moved` have moved, and no others; edges stay hard or smooth as they were. Null
   * where the surface was not made before. `topology` has the triangles of the surface and those at each vertex.
   */
  moved(flat, faces, topology, moved) {
    if (this.#faces !== faces) return null;
    if (this.#part?.moved !== moved) this.#parted(topology, moved);
    const { positions, normals, triangles, wires, around, vertices } = this.#made;
    for (const corner of this.#part.corners) {
      const from = 3 * vertices[corner];
      for (let axis = 0; axis < 3; axis += 1) positions[3 * corner + axis] = flat[from + axis];
    }
    turn(this.#part.turned, positions, triangles, around, normals);
    return { positions, normals, triangles, wires, part: this.#part };
  }

  /** Finds the corners that move with some vertices, and the part of the surface around them. */
  #parted(topology, moved) {
    const made = this.#made;
    made.around ??= this.#trianglesAround();
    const isTurned = turnedBy(topology, moved);
    const isMoved = new Uint8Array(isTurned.length);
    for (const v of moved) isMoved[v] = 1;
    const corners = [];
    const isTurnedCorner = new Uint8Array(made.vertices.length);
    made.vertices.forEach((v, corner) => {
      isTurnedCorner[corner] = isTurned[v];
      if (isMoved[v]) corners.push(corner);
    });
    this.#part = { moved, corners, ...parted(made, isTurnedCorner) };
  }

  /** For each corner the triangles of the faces whose normals it takes the mean of. */
  #trianglesAround() {
    const { joined } = this.#made;
    const first = new Uint32Array(this.#faces.length + 1);
    this.#faces.forEach((face, at) => { first[at + 1] = first[at] + 3 * (face.length - 2); });
    const starts = new Uint32Array(joined.starts.length);
    const list = [];
    for (let corner = 0; corner + 1 < starts.length; corner += 1) {
      for (let at = joined.starts[corner]; at < joined.starts[corner + 1]; at += 1) {
        for (let next = first[joined.list[at]]; next < first[joined.list[at] + 1]; next += 3) list.push(next);
      }
      starts[corner + 1] = list.length;
    }
    return { starts, list };
  }
}
