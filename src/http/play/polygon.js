// What happens to a control polygon: points put in, taken out and moved, with the tags that follow them.

/** Coordinates are kept to so many decimals of the view, which keeps jobs short. */
export function rounded(value, scale) {
  const decimals = Math.min(Math.max(Math.ceil(Math.log10(scale)) + 1, 0), 12);
  return Number(value.toFixed(decimals));
}

/** Puts a point at an index. */
export function insert(polygon, at, point) {
  const rest = polygon.points[0]?.slice(2).map(() => 0) ?? [];
  polygon.points.splice(at, 0, [...point, ...rest]);
  if (polygon.corners) polygon.corners = polygon.corners.map((corner) => (corner >= at ? corner + 1 : corner));
  if (polygon.tangents) polygon.tangents.splice(at, 0, chord(polygon, at));
  for (const [name, values] of Object.entries(polygon.parameters ?? {})) {
    polygon.parameters[name].splice(at, 0, values[Math.min(at, values.length - 1)]);
  }
}

/** Takes a point out. */
export function remove(polygon, at) {
  polygon.points.splice(at, 1);
  polygon.tangents?.splice(at, 1);
  for (const values of Object.values(polygon.parameters ?? {})) values.splice(at, 1);
  setCorners(polygon, (polygon.corners ?? []).filter((corner) => corner !== at)
    .map((corner) => (corner > at ? corner - 1 : corner)));
}

/** Makes a point a corner, or smooth again. */
export function toggleCorner(polygon, at) {
  const corners = new Set(polygon.corners ?? []);
  if (!corners.delete(at)) corners.add(at);
  setCorners(polygon, [...corners].sort((a, b) => a - b));
}

function setCorners(polygon, corners) {
  if (corners.length > 0) polygon.corners = corners;
  else delete polygon.corners;
}

/** The edge next to a place, by the distance from its segment. */
export function nearestEdge({ points, closed }, [x, y]) {
  const n = points.length - (closed ? 0 : 1);
  let best = { edge: 0, distance: Infinity };
  for (let i = 0; i < n; i += 1) {
    const [[ax, ay], [bx, by]] = [points[i], points[(i + 1) % points.length]];
    const [dx, dy] = [bx - ax, by - ay];
    const t = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
    const distance = Math.hypot(x - ax - t * dx, y - ay - t * dy);
    if (distance < best.distance) best = { edge: i, distance };
  }
  return best.edge;
}

function chord({ points, closed }, at) {
  const n = points.length;
  const before = points[closed ? (at + n - 1) % n : Math.max(at - 1, 0)];
  const after = points[closed ? (at + 1) % n : Math.min(at + 1, n - 1)];
  const [dx, dy] = [after[0] - before[0], after[1] - before[1]];
  const length = Math.hypot(dx, dy);
  return length > 0 ? [dx / length, dy / length] : [1, 0];
}

/** The tangents of a polygon; where it has none, those along the chords of the neighbours. */
export const tangentsOf = (polygon) => polygon.tangents ?? polygon.points.map((_, at) => chord(polygon, at));

/**
 * The curvature comb of a curve: at each point a tooth against its normal, as long as the curvature of the circle
 * through it and its neighbours; teeth of the highest fiftieth are cut to one length.
 */
export function comb(flat, width, closed) {
  const n = flat.length / width;
  const rows = [];
  for (let i = closed ? 0 : 1; i < (closed ? n : n - 1); i += 1) {
    const [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map((at) => [flat[at * width], flat[at * width + 1]]);
    const [ux, uy, vx, vy] = [b[0] - a[0], b[1] - a[1], c[0] - b[0], c[1] - b[1]];
    const [wx, wy] = [c[0] - a[0], c[1] - a[1]];
    const product = Math.hypot(ux, uy) * Math.hypot(vx, vy) * Math.hypot(wx, wy);
    const long = Math.hypot(wx, wy) || 1;
    const curvature = product > 0 ? 2 * (ux * vy - uy * vx) / product : 0;
    rows.push({ at: b, curvature, normal: [wy / long, -wx / long] });
  }
  const sizes = rows.map(({ curvature }) => Math.abs(curvature)).sort((a, b) => a - b);
  const most = sizes[Math.floor((sizes.length - 1) * 0.98)] || 1;
  const xs = rows.map(({ at }) => at[0]);
  const extent = Math.max(...xs) - Math.min(...xs) || 1;
  const [teeth, ends] = [[], []];
  for (const { at, curvature, normal } of rows) {
    const size = 0.16 * extent * Math.min(Math.max(curvature / most, -1.5), 1.5);
    const tip = [at[0] + normal[0] * size, at[1] + normal[1] * size];
    teeth.push(...at, ...tip);
    ends.push(...tip);
  }
  return { teeth, ends };
}
