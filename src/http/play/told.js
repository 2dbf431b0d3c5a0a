// What the service tells of a surface beside its shape: numbers, and its pictures.

import { count, h, settled, short } from "./dom.js";
import { analysed, render } from "./service.js";
import { changed, job, state, view } from "./state.js";

/** The tools of surfaces: their names, what their buttons say, and what they are for. */
export const TOOLS = [
  ["move", "Move", "Move vertices"], ["crease", "Crease", "Tap edges to make them sharp, or smooth again"],
  ["corner", "Corner", "Tap vertices to make them corners"],
  ["latitude", "Latitude", "Tap an edge: its line becomes a ring around a tube, which comes to a circle"],
  ["longitude", "Longitude", "Tap an edge: its line runs along the tube"],
  ["hole", "Hole", "Tap faces to leave them out"],
];
/** What can be dropped. */
export const FILES = "OBJ, PLY, STL, OFF, glTF, GLB or JSON; or drop it here";
/** What to do with each tool. */
export const HINTS = {
  move: "Drag an orange point: the surface follows. Drag beside it to turn it.",
  crease: "Tap an edge to make it sharp.",
  corner: "Tap a vertex to make it a corner.", latitude: "Tap an edge of a ring around the tube.",
  longitude: "Tap an edge along the tube.", hole: "Tap a face to leave it out.",
};

/** How long a surface stays as it is before its numbers and pictures are asked for. Half of it asks for more that
    nobody reads; twice of it is felt as waiting. */
const CALM_MS = 350;
/** Most vertices of a control mesh whose distance from the limit is asked for, which takes a moment for large ones. */
const MOST_VERTICES = 3000;

const SHADINGS = ["smooth", "zebra", "reflection-lines", "isophotes", "gaussian-curvature", "mean-curvature",
  "distance", "hidden-line", "matcap", "normals"];

const fact = (name, value) => (value === null || value === undefined ? [] : [h("dt", {}, name), h("dd", {}, value)]);

/** Counts, area, volume and the bound of the distance from the limit. */
export function numbersSection() {
  const list = h("dl", { class: "facts", id: "numbers" });
  const section = h("section", {}, h("h2", {}, "Numbers"), list);
  let asked = 0;
  const follow = settled(CALM_MS, async (now) => {
    asked += 1;
    const mine = asked;
    const positions = state.show.limit ? { positions: "limit" } : {};
    const answer = await render(now, { format: "stats", ...positions }).catch(() => null);
    if (!answer || mine !== asked) return;
    const told = await answer.json();
    const level = Number(answer.headers.get("planish-level") ?? now.levels);
    const write = (bound) => list.replaceChildren(...numbers(told, level, state.show.limit ? null : bound));
    write(answer.headers.get("planish-bound"));
    if (answer.headers.has("planish-bound") || now.input.mesh.positions.length > MOST_VERTICES) return;
    const about = await analysed({ plan: now.plan, input: now.input, valences: [4] }).catch(() => null);
    const bound = about?.input?.bounds?.find((one) => one.level === level)?.bound;
    if (mine === asked && bound !== undefined) write(bound);
  });
  return { section, follow };
}

function numbers(told, level, bound) {
  const { min, max } = told.bounding_box;
  return [
    ...fact("Level", String(level)), ...fact("Vertices", count(told.vertices)), ...fact("Edges", count(told.edges)),
    ...fact("Faces", count(told.faces)), ...fact("Area", short(told.area, 6)),
    ...fact("Volume", told.volume === null ? "not closed" : short(told.volume, 6)),
    ...fact("Size", max.map((high, axis) => short(high - min[axis])).join(" × ")),
    ...fact("Euler characteristic", String(told.euler_characteristic)),
    ...fact("Boundary loops", told.boundary_loops ? count(told.boundary_loops) : null),
    ...fact("Off the limit", bound ? `at most ${short(Number(bound), 3)}` : null),
  ];
}

/** A picture of the service, from where the viewer looks. */
export function pictureSection(camera) {
  const alt = "The service's picture of the surface";
  const picture = h("img", { class: "preview", id: "picture", alt, hidden: true });
  const choice = h("select", { id: "shading", "aria-label": "Shading of the picture" },
    SHADINGS.map((name) => h("option", { value: name, selected: name === "zebra" }, name)));
  const fault = h("p", { class: "fault", hidden: true });
  const details = h("details", { id: "pictures" }, h("summary", {}, "Zebra, curvature and more"),
    h("div", { class: "row" }, choice), picture, fault);
  const section = h("section", {}, h("h2", {}, "The service's picture"), details);
  const tell = () => {
    view.shading = details.open ? choice.value : null;
    changed("view", true);
    follow();
  };
  const follow = settled(CALM_MS, async () => {
    if (!details.open || state.mode !== "surfaces") return;
    const positions = state.show.limit ? { positions: "limit" } : {};
    const size = { width: 640, height: 480, quality: "draft", camera: camera(), ...positions };
    try {
      const answer = await render(job(), { format: "png", shading: choice.value, ...size });
      const last = picture.src;
      picture.src = URL.createObjectURL(await answer.blob());
      picture.hidden = false;
      fault.hidden = true;
      if (last) URL.revokeObjectURL(last);
    } catch (refusal) {
      fault.textContent = refusal.message;
      fault.hidden = false;
    }
  });
  choice.onchange = tell;
  details.ontoggle = tell;
  const restore = () => {
    if (!SHADINGS.includes(view.shading)) view.shading = null;
    details.open = view.shading !== null;
    if (view.shading) choice.value = view.shading;
  };
  return { section, follow, restore };
}
