// Compares what stencils.js makes of stencils with the json answers of the same jobs, bit by bit.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { launch, startService } from "./browser/service.mjs";
import { Net, parse } from "./stencils.js";

const [binary, folder, page] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));

/** The answer to a job with one output; null where it is refused, with the reason in `refused`. */
const refused = new Map();
async function ask(origin, name, job, output) {
  const body = JSON.stringify({ ...job, outputs: [output] });
  const answer = await fetch(`${origin}/v1/render`, {
    method: "POST", headers: { "content-type": "application/json", prefer: "wait=60" }, body,
  });
  if (answer.status === 200) return answer.arrayBuffer();
  assert.equal(answer.status, 422, `${name}: ${await answer.clone().text()}`);
  const { detail, errors } = await answer.json();
  refused.set(`${name} ${JSON.stringify(output)}`, errors?.[0]?.detail ?? detail);
  return null;
}

const json = (bytes) => JSON.parse(new TextDecoder().decode(bytes));

/** The lists of points of an input, as far as the request has them as such. */
function lists({ mesh, polygon, polygons }) {
  return mesh ? [mesh.positions] : (polygons ?? [polygon]).map((curve) => curve?.points ?? []);
}

/** The points of an input as a request has them, and how many numbers each has. */
function given(input) {
  const points = lists(input).flat();
  return { points: Float64Array.from(points.flat()), width: points[0]?.length ?? 3 };
}

/** All numbers of a json answer. */
function expected({ positions, points, polygons, normals = [] }) {
  return { points: (positions ?? points ?? polygons.flatMap((curve) => curve.points)).flat(), normals: normals.flat() };
}

function same(name, found, wanted) {
  assert.equal(found.length, wanted.length, `${name}: their number`);
  const at = wanted.findIndex((x, i) => !Object.is(x, found[i]));
  assert(at < 0, `${name}: number ${at} is ${found[at]} instead of ${wanted[at]}`);
}

/** One of so many vertices may have tangents without a product, as at the pole of the vase. */
const FEW = 10;

/** Compares one job with these options; whether it is served. */
async function compare(origin, name, job, options) {
  const bytes = await ask(origin, name, job, { ...options, format: "stencils-bin" });
  if (bytes === null) return false;
  const stencils = parse(bytes);
  let { points, width } = given(job.input);
  if (points.length !== stencils.columns * width) {
    // vertices were welded or split: as they are numbered by the service
    const control = json(await ask(origin, name, { ...job, levels: 0 }, { format: "json" }));
    points = Float64Array.from(expected(control).points);
  }
  const net = new Net(stencils, points, width);
  const check = (answer) => {
    const wanted = expected(json(answer));
    same(name, stencils.rational ? stencils.project(net.positions, width) : net.positions, wanted.points);
    if (!stencils.hasNormals) return;
    // where tangents have no product the service weighs faces by their areas
    const normals = net.normals();
    const none = wanted.normals.map((_, i) => normals.subarray(i - (i % 3), i - (i % 3) + 3).every((x) => x === 0));
    assert(FEW * none.filter(Boolean).length <= none.length, `${name}: few vertices have no normal`);
    same(`${name}, normals`, normals, wanted.normals.map((x, i) => (none[i] ? 0 : x)));
  };
  check(await ask(origin, name, job, { ...options, format: "json" }));
  same(`${name}, text`, parse(new TextDecoder().decode(await ask(origin, name, job, { ...options, format: "stencils" })))
    .apply(points, width), net.positions);
  await drag({ origin, name, job, options, net, points, width, check });
  return true;
}

/** Moves two points and compares again, where the request has the points and the level does not depend on them. */
async function drag({ origin, name, job, options, net, points, width, check }) {
  const { stencils } = net;
  if (typeof job.levels !== "number" || given(job.input).points.length !== points.length) return;
  const moved = structuredClone(job.input);
  const all = lists(moved).flat();
  const before = net.positions.slice();
  const changed = new Set();
  for (const at of [0, Math.floor(stencils.columns / 2)]) {
    // points of polygons are lists in lists, so that this changes the request
    for (let c = 0; c < width - (stencils.rational ? 1 : 0); c += 1) all[at][c] += 0.0625 + 0.03 * c;
    net.move(at, all[at]).forEach((v) => changed.add(v));
  }
  for (let v = 0; v < stencils.vertices; v += 1) {
    const stays = [...Array(width).keys()].every((c) => Object.is(before[v * width + c], net.positions[v * width + c]));
    assert(stays || changed.has(v), `${name}: point ${v} moved, which was not told`);
  }
  const answer = await ask(origin, name, { ...job, input: moved }, { ...options, format: "json" });
  if (answer !== null) check(answer);
}

/** A flat row of weights over the input gives the same points up to rounding. */
function flat(stencils, points, width) {
  const { starts, indices, weights } = stencils.flat();
  const steps = stencils.apply(points, width);
  for (let v = 0; v < stencils.vertices; v += 1) {
    for (let c = 0; c < width; c += 1) {
      let sum = 0;
      for (let at = starts[v]; at < starts[v + 1]; at += 1) sum += weights[at] * points[indices[at] * width + c];
      assert(Math.abs(sum - steps[v * width + c]) < 1e-12, `point ${v} is ${sum} instead of ${steps[v * width + c]}`);
    }
  }
}

function torus(n, m) {
  const ring = (count, i) => (2 * Math.PI * i) / count;
  const cells = Array.from({ length: n * m }, (_, k) => [Math.floor(k / m), k % m]);
  const positions = cells.map(([i, j]) => {
    const r = 3 + Math.cos(ring(m, j));
    return [r * Math.cos(ring(n, i)), r * Math.sin(ring(n, i)), Math.sin(ring(m, j))];
  });
  const at = (i, j) => (i % n) * m + (j % m);
  return { positions, faces: cells.map(([i, j]) => [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]) };
}

const median = (times) => times.sort((a, b) => a - b)[Math.floor(times.length / 2)].toFixed(2);

/** Prints how long drags take: nothing is asserted, as machines differ. */
async function time(origin) {
  const circle = Array.from({ length: 200 }, (_, i) => [Math.cos(i / 31.83), Math.sin(i / 31.83)]);
  const jobs = {
    "500 quads at level 3": { input: { mesh: torus(25, 20) }, plan: { preset: "catmull-clark" }, levels: 3 },
    "200 points at level 6": {
      input: { polygon: { points: circle, closed: true } }, plan: { preset: "cubic-b-spline" }, levels: 6,
    },
  };
  for (const [name, job] of Object.entries(jobs)) {
    const bytes = await ask(origin, name, job, { format: "stencils-bin" });
    const begin = performance.now();
    const stencils = parse(bytes);
    const { points, width } = given(job.input);
    const net = new Net(stencils, points, width);
    const first = net.move(1, points.slice(width, 2 * width));
    const ready = (performance.now() - begin).toFixed(1);
    const of = (what) => median(Array.from({ length: 100 }, (_, i) => {
      const start = performance.now();
      what(i);
      return performance.now() - start;
    }));
    const drags = of((i) => net.move(1, [1 + i / 100, 0.5, 0.25].slice(0, width)));
    const whole = of(() => net.set(points));
    flat(stencils, points, width);
    console.log(`${name}: ${(bytes.byteLength / 1e6).toFixed(2)} MB, ready after ${ready} ms, ` +
      `a drag of ${first.length} of ${stencils.vertices} points ${drags} ms, all points ${whole} ms`);
  }
}

/** The same bits in a page of another origin. */
async function inPage(origin, jobs) {
  const server = createServer((request, response) => {
    const isModule = request.url === "/stencils.js";
    response.writeHead(200, { "content-type": isModule ? "text/javascript" : "text/html" });
    response.end(isModule ? readFileSync(join(here, "stencils.js")) : "<!doctype html><title>stencils</title>");
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const browser = await launch();
  try {
    const page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const numbers = await page.evaluate(async ({ origin, jobs }) => {
      const { Net, parse } = await import("/stencils.js");
      const ask = async (job, format) => {
        const body = JSON.stringify({ ...job, outputs: [{ format, positions: "limit", normals: "limit" }] });
        const headers = { "content-type": "application/json" };
        return (await fetch(`${origin}/v1/render`, { method: "POST", headers, body })).arrayBuffer();
      };
      let numbers = 0;
      for (const job of jobs) {
        const net = new Net(parse(await ask(job, "stencils-bin")), job.input.mesh.positions.flat());
        const point = job.input.mesh.positions[0].map((x) => x + 0.3);
        net.move(0, point);
        job.input.mesh.positions[0] = point;
        const { positions, normals } = JSON.parse(new TextDecoder().decode(await ask(job, "json")));
        const [found, wanted] = [[...net.positions, ...net.normals()], [...positions, ...normals].flat()];
        if (!wanted.every((x, i) => Object.is(x, found[i]))) throw new Error("other bits in the page");
        numbers += wanted.length;
      }
      return numbers;
    }, { origin, jobs });
    console.log(`in Chromium: ${numbers} numbers with the same bits`);
  } finally {
    await browser.close();
    server.close();
  }
}

/** The program of the documentation runs as it stands there. */
async function documented(origin) {
  const [, program] = readFileSync(page, "utf8").match(/```js\n(.*?)```/s);
  const file = join(here, "stencils-documented.mjs");
  writeFileSync(file, program);
  const { stdout } = await promisify(execFile)(process.execPath, [file, origin]);
  assert.match(stdout, /vertices moved, the same bits: true/);
}

const { service, origin } = await startService(binary);
try {
  let [served, limits, normals] = [0, 0, 0];
  for (const file of readdirSync(folder).filter((name) => name.endsWith(".json")).sort()) {
    if (/-(step|certificate)\.json$/.test(file)) continue; // solids have no levels
    const { outputs, distance_to: _, ...job } = JSON.parse(readFileSync(join(folder, file)));
    const name = basename(file, ".json");
    const frame = job.input.mesh?.frames ? { frame: 0 } : {};
    served += await compare(origin, name, job, frame);
    const limit = { ...frame, positions: "limit" };
    if (await ask(origin, name, job, { ...limit, format: "json" })) limits += await compare(origin, name, job, limit);
    if (job.input.mesh) normals += await compare(origin, name, job, { ...limit, normals: "limit" });
  }
  for (const [what, why] of refused) console.log(`refused: ${what}: ${why}`);
  assert(served > 100 && limits > 50 && normals > 20, `${served}, ${limits}, ${normals} are served`);
  console.log(`${served} examples, ${limits} with limit points, ${normals} with normals: the same bits`);
  await documented(origin);
  await time(origin);
  const mesh = torus(6, 5);
  mesh.creases = [{ edge: [0, 5], sharpness: 10 }, { edge: [5, 10], sharpness: 2.5 }];
  await inPage(origin, ["catmull-clark", "kobbelt"].map((preset) => ({
    input: { mesh: preset === "kobbelt" ? torus(5, 4) : mesh }, plan: { preset }, levels: 2,
  })));
} finally {
  service.kill();
}
