// What the page shows: one document for curves and one for surfaces, with undo, and the address that holds them.

/** Everything that can be undone. A document is a job without outputs; `other` is a second plan beside it. */
export const state = {
  mode: "curves",
  curves: { input: { polygon: { points: [], closed: true } }, plan: {}, levels: 4, other: null },
  surfaces: { input: { mesh: { positions: [], faces: [] } }, plan: {}, levels: 3, other: null },
  show: {
    polygon: true, samples: false, levels: false, comb: false, limits: false, side: false, limit: false,
    surface: true, wireframe: false, net: true, isolines: false, extraordinary: false, flat: false,
  },
};

/** Where the page looks in each mode, as numbers, null while it is fitted; the shading of the picture, null while it is
    closed. The address holds them, and they are no steps of undo. */
export const view = { curves: null, surfaces: null, shading: null };

/** Numbers of a view in each mode. */
const VIEWS = { curves: 3, surfaces: 6 };

const LONGEST_HISTORY = 200;
const past = [];
let future = [];
let committed = "";
const listeners = new Set();

/** The document that is shown. */
export const current = () => state[state.mode];

/** Calls a function after every change, with what changed: "points", "plan", "levels", "show", "mode",
    "view" or "all". */
export function listen(listener) {
  listeners.add(listener);
}

/** Tells of a change; one that is `live` (a drag under way) is no step of undo yet. */
export function changed(what, live = false) {
  if (!live) commit();
  for (const listener of listeners) listener(what, live);
}

function frozen() {
  return JSON.stringify(state);
}

function commit() {
  const now = frozen();
  if (now === committed) return;
  if (committed) past.push(committed);
  if (past.length > LONGEST_HISTORY) past.shift();
  future = [];
  committed = now;
}

/** Whether there is something to undo or redo. */
export const history = () => ({ undo: past.length > 0, redo: future.length > 0 });

/** Goes a step back. */
export function undo() {
  move(past, future);
}

/** Goes a step forward again. */
export function redo() {
  move(future, past);
}

function move(from, to) {
  if (from.length === 0) return;
  to.push(committed);
  committed = from.pop();
  Object.assign(state, JSON.parse(committed));
  for (const listener of listeners) listener("all", false);
}

/** The job of the document that is shown: what the service is sent, but for its outputs. */
export function job() {
  const { input, plan, levels } = current();
  return { input, plan, levels };
}

/** Bytes as base64url without padding. */
function base64url(bytes) {
  let text = "";
  for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

function unbase64url(text) {
  const plain = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
  return Uint8Array.from(plain, (letter) => letter.charCodeAt(0));
}

async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

/** JSON as the parameter `job` of `GET /v1/render` has it: zlib, then base64url. */
export async function packed(value) {
  return base64url(await through(new TextEncoder().encode(JSON.stringify(value)), new CompressionStream("deflate")));
}

async function unpacked(text) {
  const bytes = await through(unbase64url(text), new DecompressionStream("deflate"));
  return JSON.parse(new TextDecoder().decode(bytes));
}

/** The fragment that restores what is shown: the job, what is shown of it, and the plan beside it. */
export async function fragment() {
  const parts = [`job=${await packed(job())}`];
  const shown = Object.entries(state.show).filter(([, on]) => on);
  parts.push(`show=${shown.map(([name]) => name).join(".")}`);
  if (view[state.mode]) parts.push(`view=${view[state.mode].join(",")}`);
  if (state.mode === "surfaces" && view.shading) parts.push(`shading=${view.shading}`);
  if (current().other) parts.push(`with=${await packed(current().other)}`);
  return `#${parts.join("&")}`;
}

/** Restores what a fragment holds; false where it holds no job. */
export async function restore(text) {
  const parts = new URLSearchParams(text.replace(/^#/, ""));
  if (!parts.has("job")) return false;
  const { input, plan, levels } = await unpacked(parts.get("job"));
  const other = parts.has("with") ? await unpacked(parts.get("with")) : null;
  const mode = input?.polygon ? "curves" : "surfaces";
  if (!Array.isArray(input?.polygon?.points) && !Array.isArray(input?.mesh?.positions)) return false;
  state.mode = mode;
  state[mode] = { input, plan: plan ?? {}, levels: levels ?? 0, other };
  const looks = parts.get("view")?.split(",").map(Number) ?? [];
  const isView = looks.length === VIEWS[mode] && looks.every(Number.isFinite) && looks[2] !== 0;
  view[mode] = isView ? looks : null;
  view.shading = parts.get("shading");
  const shown = parts.get("show")?.split(".");
  if (shown) for (const name of Object.keys(state.show)) state.show[name] = shown.includes(name);
  return true;
}
