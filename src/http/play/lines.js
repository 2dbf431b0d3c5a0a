// What a job is outside the page: text, a line of curl, an address; and an address of the page as it is.

import { h } from "./dom.js";
import { key } from "./service.js";
import { fragment, job, packed, state } from "./state.js";

/** Most bytes of an address that the service takes. */
const LONGEST_ADDRESS = 8192;

/** Formats whose surface is the limit, whatever the level is. */
const EXACT = ["step"];

/** The longer side of pictures, pixels, and the share of their shorter side that the service leaves free around. */
const LONGEST = 1200;
const MARGIN = 0.06;

/** The size and the camera of a picture of the part of the plane that a pane shows. */
function seen({ x, y, scale, size }) {
  const factor = LONGEST / Math.max(...size);
  const [width, height] = size.map((side) => Math.round(side * factor));
  const free = 2 * MARGIN * Math.min(width, height);
  const [right, up] = [width, height].map((side) => (side - free) / (2 * scale * factor));
  const corner = (way) => [...[x + way * right, y + way * up].map((value) => Number(value.toPrecision(6))), 0];
  return { width, height, camera: { box: { min: corner(-1), max: corner(1) } } };
}

/** The output of a format, as the picture on the page has it. */
export function output(format) {
  const { show, mode } = state;
  const limit = mode === "surfaces" && show.limit && !EXACT.includes(format) ? { positions: "limit" } : {};
  if (!["svg", "png", "pdf"].includes(format)) return { format, ...limit };
  const size = { format, width: LONGEST, height: 0.75 * LONGEST };
  if (mode === "curves") {
    const shown = ["curve", ...(show.polygon ? ["control", "points"] : []), ...(show.samples ? ["vertices"] : []),
      ...(show.comb ? ["comb"] : [])];
    const region = output.region?.();
    return { ...size, ...(region ? seen(region) : {}), show: shown };
  }
  const camera = output.camera?.();
  if (format !== "png") {
    const lines = show.wireframe ? { show: ["silhouettes", "boundary", "creases", "isolines", "wireframe"] } : {};
    return { ...size, ...limit, ...lines, camera };
  }
  const names = { surface: "surface", wireframe: "wireframe", isolines: "isolines", extraordinary: "extraordinary" };
  const shown = Object.keys(names).filter((name) => show[name]);
  const all = [...shown, ...(show.net ? ["control"] : [])];
  // a picture of nothing is refused
  return { ...size, ...limit, show: all.length > 0 ? all : ["surface"], camera };
}

/** Rows of positions in one line each, so that a job can be read. */
export function readable(value) {
  return JSON.stringify(value, null, 2).replaceAll(/\[\s+(-?[\d.e+-]+(?:,\s+-?[\d.e+-]+)*)\s+\]/g, (row) => (
    row.replaceAll(/\s+/g, " ").replace("[ ", "[").replace(" ]", "]")));
}

const quoted = (given) => `'${given.replaceAll("'", "'\\''")}'`;

/** The job with an output of a format, the line of curl, the address or why there is none, and the permalink. */
export async function lines(format, extension) {
  const whole = { ...job(), outputs: [output(format)] };
  const shown = key() ? " -H 'Authorization: Bearer KEY'" : "";
  const text = JSON.stringify(whole);
  const curl = `curl --fail-with-body -o planish.${extension}${shown} -H 'Content-Type: application/json' `
    + `-d ${quoted(text)} ${location.origin}/v1/render`;
  const link = `${location.origin}/v1/render?job=${await packed(whole)}`;
  const tooLong = link.length <= LONGEST_ADDRESS ? "" : `This job is too long for an address: ${link.length} of `
    + `${LONGEST_ADDRESS} bytes. Send it with the line of curl; the answer's Content-Location is an address.`;
  const permalink = location.origin + location.pathname + await fragment();
  return { whole, text, curl, link: tooLong ? "" : link, tooLong, permalink };
}

/** Copies a text; where a page may not, as without https, by selecting it. */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = h("textarea", { class: "unseen", "aria-hidden": "true" });
    area.value = text;
    // what lies outside an open dialog cannot be selected
    (document.querySelector("dialog[open]") ?? document.body).append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
