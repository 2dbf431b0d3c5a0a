// Long paths in pieces, of which those alone are drawn anew whose points moved.

import { s } from "./dom.js";

/** Points closer than SHORT pixels are drawn as one, those closer than LONG where the path turns by less than
    MOST_TURN (the sine of the angle). Half of each draws twice the points, which nobody sees; twice of LONG and
    MOST_TURN makes corners that are seen. */
const SHORT = 0.4;
const LONG = 3;
const MOST_TURN = 0.1;

/**
 * The path through points `from` up to `to`, and back to the first one where it is closed. A point is left out where
 * it is near the last one and hardly turns: of a circle of 20 pixels the path is off by less than a twentieth of one.
 */
export function pathOf({ flat, width }, { x, y, scale }, from, to, closing = "") {
  const parts = [];
  let [lastX, lastY, wayX, wayY] = [NaN, NaN, 0, 0];
  for (let i = from; i <= to; i += 1) {
    const px = x + flat[i * width] * scale;
    const py = y - flat[i * width + 1] * scale;
    const [dx, dy] = [px - lastX, py - lastY];
    const long = Math.sqrt(dx * dx + dy * dy);
    const turns = Math.abs(wayX * dy - wayY * dx) > MOST_TURN * long || wayX * dx + wayY * dy < 0;
    if (i > from && i < to && (long < SHORT || (long < LONG && !turns))) continue;
    if (long > 0) [wayX, wayY] = [dx / long, dy / long];
    [lastX, lastY] = [px, py];
    parts.push(`${px.toFixed(1)} ${py.toFixed(1)}`);
  }
  return parts.length === 0 ? "" : `M${parts.join("L")}${closing}`;
}

/** A path in a group of SVG, in pieces of so many points. */
export class Pieces {
  #size;
  #group;
  #flat = new Float64Array(0);
  #seen = "";

  constructor(group, size) {
    this.#group = group;
    this.#size = size;
  }

  /** Draws a path as it is seen: the origin of the plane is at the pixel `x`, `y`, a unit is `scale` pixels. */
  draw({ flat, width, closed }, seen) {
    const n = flat.length / width;
    const count = Math.max(Math.ceil((n - 1) / this.#size), 1);
    const as = `${seen.x} ${seen.y} ${seen.scale} ${width} ${closed}`;
    const isOther = as !== this.#seen || flat.length !== this.#flat.length;
    const group = this.#group;
    while (group.childElementCount > count) group.lastChild.remove();
    while (group.childElementCount < count) group.append(s("path"));
    for (let at = 0; at < count; at += 1) {
      const [from, to] = [at * this.#size, Math.min((at + 1) * this.#size, n - 1)];
      const isLast = at === count - 1;
      if (!isOther && !this.#moved(flat, from * width, (to + 1) * width)
        && !(isLast && closed && this.#moved(flat, 0, width))) continue;
      // one piece is closed with a join, the last of several goes back to the first point
      const back = () => (count === 1 ? "Z" : pathOf({ flat, width }, seen, 0, 0).replace("M", "L"));
      const closing = isLast && closed ? back() : "";
      group.children[at].setAttribute("d", pathOf({ flat, width }, seen, from, to, closing));
    }
    if (isOther) this.#flat = Float64Array.from(flat);
    else this.#flat.set(flat);
    this.#seen = as;
  }

  #moved(flat, from, to) {
    for (let i = from; i < to; i += 1) if (flat[i] !== this.#flat[i]) return true;
    return false;
  }
}
