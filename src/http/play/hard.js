// A surface with hard edges: whole, and while a point moves that part alone which follows it.

import { trianglesOf, wiresOf } from "./mesh.js";
import { parted } from "./part.js";

/** How far the cosine between two faces has to be below that of the angle, as in pictures of the service. */
const SLACK = 1e-6;

export class Hard {
  #least;
  #faces = null;
  #made = null;
  #part = null;

  /**
   * Of surfaces whose edges of more than `degrees` look hard: the corners of faces are vertices of their own, each with
   * the sum of the normals of those faces around its vertex that are no further turned from its own.
   */
  constructor(degrees) {
    this.#least = Math.cos(degrees * Math.PI / 180) - SLACK;
  }

  /** The surface of these positions as viewers take it. */
  whole(flat, faces) {
    if (this.#faces !== faces) {
      this.#faces = faces;
      this.#made = cornersOf(faces, flat.length / 3);
    }
    this.#part = null;
    const { first, vertices, normals } = this.#made;
    for (let face = 0; face + 1 < first.length; face += 1) this.#turnFace(face, flat);
    for (let corner = 0; corner < vertices.length; corner += 1) this.#place(corner, flat);
    for (let corner = 0; corner < vertices.length; corner += 1) this.#turn(corner, normals);
    return this.#shown();
  }

  /**
   * The same surface where the vertices `moved` have moved, and no others: it looks as the whole one would. Null where
   * the surface was not made before.
   */
  moved(flat, faces, moved) {
    if (this.#faces !== faces) return null;
    if (this.#part?.moved !== moved) this.#parted(moved);
    const { normals } = this.#made;
    for (const face of this.#part.faces) this.#turnFace(face, flat);
    for (const corner of this.#part.corners) this.#place(corner, flat);
    for (const corner of this.#part.turned) this.#turn(corner, normals);
    return { ...this.#shown(), part: this.#part };
  }

  #shown() {
    const { positions, normals, triangles, wires } = this.#made;
    return { positions, normals, triangles, wires };
  }

  /** Finds the faces and the corners that follow some vertices, and the part of the surface around them. */
  #parted(moved) {
    const { first, vertices, around, faceOf } = this.#made;
    const isMoved = new Uint8Array(around.starts.length - 1);
    for (const v of moved) isMoved[v] = 1;
    const isTurned = new Uint8Array(first.length - 1);
    for (const v of moved) {
      for (let at = around.starts[v]; at < around.starts[v + 1]; at += 1) isTurned[faceOf[around.list[at]]] = 1;
    }
    const isNear = new Uint8Array(isMoved.length);
    const faces = [];
    isTurned.forEach((is, face) => {
      if (!is) return;
      faces.push(face);
      for (let corner = first[face]; corner < first[face + 1]; corner += 1) isNear[vertices[corner]] = 1;
    });
    const corners = [];
    const isTurnedCorner = new Uint8Array(vertices.length);
    vertices.forEach((v, corner) => {
      isTurnedCorner[corner] = isNear[v];
      if (isMoved[v]) corners.push(corner);
    });
    this.#part = { moved, faces, corners, ...parted(this.#made, isTurnedCorner) };
  }

  #place(corner, flat) {
    const { positions, vertices } = this.#made;
    for (let axis = 0; axis < 3; axis += 1) positions[3 * corner + axis] = flat[3 * vertices[corner] + axis];
  }

  /** The area vector of a face, the sum of those of its triangles, and its length. */
  #turnFace(face, flat) {
    const { first, vertices, own, sizes } = this.#made;
    const a = 3 * vertices[first[face]];
    let [x, y, z] = [0, 0, 0];
    for (let corner = first[face] + 2; corner < first[face + 1]; corner += 1) {
      const [b, c] = [3 * vertices[corner - 1], 3 * vertices[corner]];
      const ux = flat[b] - flat[a], uy = flat[b + 1] - flat[a + 1], uz = flat[b + 2] - flat[a + 2];
      const vx = flat[c] - flat[a], vy = flat[c + 1] - flat[a + 1], vz = flat[c + 2] - flat[a + 2];
      x += uy * vz - uz * vy;
      y += uz * vx - ux * vz;
      z += ux * vy - uy * vx;
    }
    own[3 * face] = x;
    own[3 * face + 1] = y;
    own[3 * face + 2] = z;
    sizes[face] = Math.sqrt(x * x + y * y + z * z);
  }

  /** The normal of a corner. */
  #turn(corner, out) {
    const { vertices, faceOf, around, own, sizes } = this.#made;
    const [v, face] = [vertices[corner], faceOf[corner]];
    const nx = own[3 * face], ny = own[3 * face + 1], nz = own[3 * face + 2];
    const least = this.#least * (sizes[face] || 1);
    let [x, y, z] = [0, 0, 0];
    for (let at = around.starts[v]; at < around.starts[v + 1]; at += 1) {
      const other = faceOf[around.list[at]];
      const ox = own[3 * other], oy = own[3 * other + 1], oz = own[3 * other + 2];
      if (other !== face && nx * ox + ny * oy + nz * oz < least * sizes[other]) continue;
      x += ox;
      y += oy;
      z += oz;
    }
    out[3 * corner] = x;
    out[3 * corner + 1] = y;
    out[3 * corner + 2] = z;
  }
}

/**
 * Faces by their corners: those of face `f` are `first[f]` up to `first[f + 1]`; `vertices` and `faceOf` name the
 * vertex and the face of each, and the corners at vertex `v` are `around.list[around.starts[v]]` up to the next's.
 */
function cornersOf(faces, n) {
  const first = new Uint32Array(faces.length + 1);
  faces.forEach((face, at) => { first[at + 1] = first[at] + face.length; });
  const count = first[faces.length];
  const [vertices, faceOf] = [new Uint32Array(count), new Uint32Array(count)];
  const starts = new Uint32Array(n + 1);
  const split = faces.map((face, at) => face.map((v, i) => {
    vertices[first[at] + i] = v;
    faceOf[first[at] + i] = at;
    starts[v + 1] += 1;
    return first[at] + i;
  }));
  for (let v = 0; v < n; v += 1) starts[v + 1] += starts[v];
  const next = starts.slice();
  const list = new Uint32Array(count);
  vertices.forEach((v, corner) => { list[next[v]++] = corner; });
  return {
    first, vertices, faceOf, around: { starts, list }, triangles: trianglesOf(split), wires: wiresOf(split, count),
    own: new Float64Array(3 * faces.length), sizes: new Float64Array(faces.length),
    positions: new Float32Array(3 * count), normals: new Float32Array(3 * count),
  };
}
