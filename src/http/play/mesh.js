// What the page knows of meshes: edges, loops, triangles, normals, and what a ray meets first.

import { cross, dot, scaled, sub } from "./space.js";

/** An edge as one number, whatever its direction. */
const name = (a, b, n) => (a < b ? a * n + b : b * n + a);

/** The edges of faces, each with its two vertices and the faces at it, by their names. */
export function edgesOf(faces, n) {
  const edges = new Map();
  faces.forEach((face, at) => {
    for (let i = 0; i < face.length; i += 1) {
      const [a, b] = [face[i], face[(i + 1) % face.length]];
      const key = name(a, b, n);
      const known = edges.get(key);
      if (known) known.faces.push(at);
      else edges.set(key, { ends: [a, b], faces: [at] });
    }
  });
  return edges;
}

/** The ends of all edges, one behind the other. */
export function wiresOf(faces, n) {
  const seen = new Set();
  const ends = [];
  for (const face of faces) {
    for (let i = 0; i < face.length; i += 1) {
      const [a, b] = [face[i], face[(i + 1) % face.length]];
      const key = name(a, b, n);
      if (seen.has(key)) continue;
      seen.add(key);
      ends.push(a, b);
    }
  }
  return new Uint32Array(ends);
}

/** Triangles of faces: fans from the first corner. */
export function trianglesOf(faces) {
  const count = faces.reduce((sum, face) => sum + face.length - 2, 0);
  const triangles = new Uint32Array(3 * count);
  let at = 0;
  for (const face of faces) {
    for (let i = 2; i < face.length; i += 1) {
      triangles[at] = face[0];
      triangles[at + 1] = face[i - 1];
      triangles[at + 2] = face[i];
      at += 3;
    }
  }
  return triangles;
}

/** Normals of vertices, weighted by the area of triangles, into `out`. */
export function normalsOf(flat, triangles, out) {
  out.fill(0);
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [3 * triangles[at], 3 * triangles[at + 1], 3 * triangles[at + 2]];
    const ux = flat[b] - flat[a], uy = flat[b + 1] - flat[a + 1], uz = flat[b + 2] - flat[a + 2];
    const vx = flat[c] - flat[a], vy = flat[c + 1] - flat[a + 1], vz = flat[c + 2] - flat[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    out[a] += x; out[a + 1] += y; out[a + 2] += z;
    out[b] += x; out[b + 1] += y; out[b + 2] += z;
    out[c] += x; out[c + 1] += y; out[c + 2] += z;
  }
  return out;
}

/**
 * The line of edges through one: straight on through vertices of valence 4, and along boundaries, until it closes or
 * comes to another vertex.
 */
export function lineThrough(faces, n, edge) {
  const edges = edgesOf(faces, n);
  const at = new Map();
  for (const one of edges.values()) for (const v of one.ends) (at.get(v) ?? at.set(v, []).get(v)).push(one);
  const start = edges.get(name(...edge, n));
  if (!start) return [];
  const line = [start];
  for (const first of start.ends) {
    let [here, along] = [first, start];
    for (;;) {
      const next = straight(at.get(here), along);
      if (!next || line.includes(next)) break;
      if (first === start.ends[0]) line.unshift(next);
      else line.push(next);
      here = next.ends[0] === here ? next.ends[1] : next.ends[0];
      along = next;
    }
  }
  return line.map(({ ends }) => ends);
}

function straight(around, edge) {
  if (edge.faces.length === 1) return around.find((one) => one !== edge && one.faces.length === 1);
  if (around.length !== 4) return undefined;
  return around.find((one) => one !== edge && !one.faces.some((face) => edge.faces.includes(face)));
}

/** Vertices whose valence is another than that of regular ones: 4, or 6 where all faces are triangles. */
export function extraordinary({ positions, faces }) {
  const triangles = faces.every((face) => face.length === 3);
  const [inside, rim] = triangles ? [6, 4] : [4, 3];
  const valence = new Array(positions.length).fill(0);
  const boundary = new Set();
  for (const { ends, faces: at } of edgesOf(faces, positions.length).values()) {
    for (const v of ends) valence[v] += 1;
    if (at.length === 1) ends.forEach((v) => boundary.add(v));
  }
  return valence.flatMap((n, v) => (n > 0 && (boundary.has(v) ? n > rim : n !== inside) ? [v] : []));
}

/** The face that a ray meets first, or -1. */
export function faceAt({ positions, faces }, { from, way }) {
  let best = { face: -1, far: Infinity };
  faces.forEach((face, at) => {
    for (let i = 2; i < face.length; i += 1) {
      const far = meets([face[0], face[i - 1], face[i]].map((v) => positions[v]), from, way);
      if (far < best.far) best = { face: at, far };
    }
  });
  return best.face;
}

/** How far along a ray a triangle is; infinitely far where it misses. */
function meets([a, b, c], from, way) {
  const [u, v] = [sub(b, a), sub(c, a)];
  const p = cross(way, v);
  const det = dot(u, p);
  if (Math.abs(det) < 1e-14) return Infinity;
  const t = sub(from, a);
  const x = dot(t, p) / det;
  const q = cross(t, u);
  const y = dot(way, q) / det;
  const far = dot(v, q) / det;
  return x < 0 || y < 0 || x + y > 1 || far <= 0 ? Infinity : far;
}

/** The middle of a face. */
export function middle({ positions, faces }, face) {
  const corners = faces[face].map((v) => positions[v]);
  const sum = corners.reduce((total, corner) => total.map((x, axis) => x + corner[axis]), [0, 0, 0]);
  return scaled(sum, 1 / corners.length);
}

/** The list of a mesh without an edge, or with it at its end; `of` takes the edge out of an entry. */
export function toggled(list, edge, entry, of = (one) => one) {
  const same = (one) => of(one).includes(edge[0]) && of(one).includes(edge[1]);
  const rest = (list ?? []).filter((one) => !same(one));
  return rest.length === (list ?? []).length ? [...rest, entry] : rest;
}

/** Puts a list of a mesh in place, or away where it is empty. */
export function setList(mesh, name, list) {
  if (list.length > 0) mesh[name] = list;
  else delete mesh[name];
}
