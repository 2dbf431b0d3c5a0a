// What the page begins with and offers to choose: jobs without outputs.

const round = (value) => Math.round(value * 100) / 100;

/** Points evenly around the origin, at radii that repeat. */
function around(n, ...radii) {
  return Array.from({ length: n }, (_, at) => {
    const [angle, radius] = [Math.PI / 2 + 2 * Math.PI * at / n, radii[at % radii.length]];
    return [round(radius * Math.cos(angle)), round(radius * Math.sin(angle))];
  });
}

const wave = Array.from({ length: 9 }, (_, at) => [at - 4, round(at % 2 ? 1.6 : -1.2)]);

/** Curves: title and document. */
const CURVES = {
  blob: {
    title: "Cubic B-spline", levels: 5, plan: { preset: "cubic-b-spline" },
    points: [[-3.6, -0.6], [-2.2, 2.2], [0.4, 1], [2.6, 2.5], [3.9, -0.4], [1.3, -2.3], [-1.2, -1.1]],
  },
  chaikin: { title: "Corner cutting", levels: 4, plan: { preset: "chaikin" }, points: around(10, 3.2, 1.5) },
  through: {
    title: "Through the points", levels: 6, plan: { preset: "four-point", parameters: { w: "1/16" } }, isOpen: true,
    points: wave,
  },
  circle: {
    title: "A circle, exactly", levels: 5, points: around(6, 3),
    plan: {
      word: "UCP",
      parameters: { alpha: "pi/3", kernel: "cos(alpha/2)", compensation: "1/cos(alpha/2)", delta: 1 },
    },
  },
  incenter: {
    title: "By tangents", levels: 5, plan: { preset: "incenter" }, isTurned: true,
    points: [[-3.5, -1.5], [-2, 1.6], [0.6, 2.2], [3, 0.9], [2.4, -1.8], [-0.6, -2.4]],
  },
  ternary: {
    title: "Three for one", levels: 4, plan: { preset: "ternary-c4", parameters: { eta: "1/243" } },
    points: around(12, 3.1, 1.1, 2.2),
  },
};

/** Surfaces: title, and the example job of the service that holds the mesh. */
const SURFACES = {
  animal: { title: "Animal", file: "animal.json", plan: { preset: "catmull-clark" }, levels: 3 },
  cube: { title: "Cube", file: "cube.json", plan: { preset: "catmull-clark" }, levels: 4 },
  crease: { title: "Cube with creases", file: "creases.json", plan: { preset: "catmull-clark" }, levels: 4 },
  junction: { title: "Pipes that meet", file: "junction.json", levels: 3 },
  vase: { title: "Vase", file: "vase.json", levels: 3 },
  nut: { title: "Nut with a thread hole", file: "nut.json", plan: { preset: "catmull-clark" }, levels: 3 },
  star: { title: "Triangles", file: "triangles.json", plan: { preset: "loop" }, levels: 3 },
  sheet: { title: "Open sheet", file: "sheet.json", plan: { preset: "catmull-clark" }, levels: 4 },
};

/** Names and titles of the examples of a mode. */
export const examplesOf = (mode) => Object.entries(mode === "curves" ? CURVES : SURFACES)
  .map(([name, { title }]) => ({ name, title }));

/** The document of an example: input, plan, levels. */
export async function example(mode, name) {
  if (mode === "curves") {
    const { points, plan, levels, isOpen } = CURVES[name];
    const polygon = { points, closed: !isOpen };
    return structuredClone({ input: { polygon }, plan, levels, other: null });
  }
  const { file, plan, levels } = SURFACES[name];
  const job = await (await fetch(`/play/${file}`)).json();
  return { input: job.input, plan: structuredClone(plan ?? job.plan), levels, other: null };
}
