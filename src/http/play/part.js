// The part of a surface that follows one point of its control mesh, apart from the rest, which stays.

/** The triangles at each vertex: those of vertex `v` are `list[starts[v]]` up to `list[starts[v + 1]]`. */
export function trianglesAt(triangles, n) {
  const starts = new Uint32Array(n + 1);
  for (const v of triangles) starts[v + 1] += 1;
  for (let v = 0; v < n; v += 1) starts[v + 1] += starts[v];
  const next = starts.slice();
  const list = new Uint32Array(triangles.length);
  for (let at = 0; at < triangles.length; at += 1) list[next[triangles[at]]++] = at - at % 3;
  return { starts, list };
}

/**
 * The part whose points or normals change with the vertices `moved`: `turned`, the vertices whose normals do;
 * `vertices`, those of all its triangles, and its `triangles` and `wires` (ends of edges) over these; `rest` has the
 * other triangles and wires, over all vertices.
 */
export function partOf({ triangles, wires, around }, moved) {
  return parted({ triangles, wires }, turnedBy({ triangles, around }, moved));
}

/** For each vertex whether its normal changes with the vertices `moved`. */
function turnedBy({ triangles, around }, moved) {
  const isTurned = new Uint8Array(around.starts.length - 1);
  for (const v of moved) {
    isTurned[v] = 1;
    for (let at = around.starts[v]; at < around.starts[v + 1]; at += 1) {
      for (let i = 0; i < 3; i += 1) isTurned[triangles[around.list[at] + i]] = 1;
    }
  }
  return isTurned;
}

/** The part of these triangles and wires at vertices whose normals change. */
export function parted({ triangles, wires }, isTurned) {
  const places = new Int32Array(isTurned.length).fill(-1);
  const vertices = [];
  const place = (v) => {
    if (places[v] < 0) places[v] = vertices.push(v) - 1;
    return places[v];
  };
  const split = (indices, corners) => {
    const [part, rest] = [[], []];
    for (let at = 0; at < indices.length; at += corners) {
      const own = indices.subarray(at, at + corners);
      if (own.some((v) => isTurned[v])) part.push(...own.map(place));
      else rest.push(...own);
    }
    return [Uint32Array.from(part), Uint32Array.from(rest)];
  };
  const [ofTriangles, otherTriangles] = split(triangles, 3);
  const [ofWires, otherWires] = split(wires, 2);
  const turned = vertices.filter((v) => isTurned[v]);
  return {
    turned, vertices, triangles: ofTriangles, wires: ofWires, rest: { triangles: otherTriangles, wires: otherWires },
  };
}

/** Normals of some vertices, weighted by the area of triangles, into `out`, with the bits of those of all vertices. */
export function turn(turned, flat, triangles, { starts, list }, out) {
  for (const v of turned) {
    let [x, y, z] = [0, 0, 0];
    for (let at = starts[v]; at < starts[v + 1]; at += 1) {
      const first = list[at];
      const [a, b, c] = [3 * triangles[first], 3 * triangles[first + 1], 3 * triangles[first + 2]];
      const ux = flat[b] - flat[a], uy = flat[b + 1] - flat[a + 1], uz = flat[b + 2] - flat[a + 2];
      const vx = flat[c] - flat[a], vy = flat[c + 1] - flat[a + 1], vz = flat[c + 2] - flat[a + 2];
      // as they are added where all are made: to numbers of four bytes
      x = Math.fround(x + (uy * vz - uz * vy));
      y = Math.fround(y + (uz * vx - ux * vz));
      z = Math.fround(z + (ux * vy - uy * vx));
    }
    out[3 * v] = x;
    out[3 * v + 1] = y;
    out[3 * v + 2] = z;
  }
}
