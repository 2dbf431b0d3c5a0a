// Surfaces: every tool of the page, and the shape that follows.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { checkDownloads } from "./play-taking.mjs";
import { Player } from "./player.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const mesh = async (player) => (await player.job()).input.mesh;

// Where a vertex is on the screen.
async function seen(player, vertex) {
  const [x, y] = await player.page.evaluate((v) => window.planish.stage().seen(v), vertex);
  const box = await player.page.locator("canvas").boundingBox();
  return [box.x + x, box.y + y];
}

// The vertex that is next to the eye, which nothing hides.
async function nearest(player) {
  const { positions } = await mesh(player);
  return player.page.evaluate((n) => {
    const depths = Array.from({ length: n }, (_, v) => window.planish.stage().seen(v)[2]);
    return depths.indexOf(Math.min(...depths));
  }, positions.length);
}

// The middle of an edge at a vertex on the screen, with its ends.
async function edgeAt(player, vertex) {
  const { faces } = await mesh(player);
  const face = faces.find((one) => one.includes(vertex));
  const other = face[(face.indexOf(vertex) + 1) % face.length];
  const [a, b] = [await seen(player, vertex), await seen(player, other)];
  return [a[0] + 0.4 * (b[0] - a[0]), a[1] + 0.4 * (b[1] - a[1])];
}

async function checkVertices(player) {
  const { page } = player;
  await page.selectOption("#examples", "cube");
  await player.settled();
  await player.agrees();
  const before = await player.shown();
  const vertex = await nearest(player);
  const from = await seen(player, vertex);
  await player.drag(from, [from[0] + 70, from[1] - 40]);
  await player.settled();
  assert.notDeepEqual(await player.shown(), before, "a drag changes the surface");
  await player.agrees();
  const [x] = (await mesh(player)).positions[vertex];
  await page.focus("canvas");
  await page.keyboard.press("Escape");
  for (let times = 0; times <= vertex; times += 1) await page.keyboard.press("n");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowUp");
  assert.notEqual((await mesh(player)).positions[vertex][0], x, "arrows move the chosen vertex");
  await page.keyboard.press("Escape");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("+");
  await page.keyboard.press("-");
  await page.mouse.move(700, 300);
  await page.mouse.wheel(0, -120);
  await player.drag([300, 700], [380, 640]);
  await page.click("#tool-fit");
  await player.settled();
  await player.agrees();
}

async function checkTags(player) {
  const { page } = player;
  await page.selectOption("#examples", "cube");
  await player.settled();
  const vertex = await nearest(player);
  await page.click("#tool-crease");
  await page.locator("#sharpness").fill("2.5");
  await page.mouse.click(...await edgeAt(player, vertex));
  assert.equal((await mesh(player)).creases?.at(-1).sharpness, 2.5, "a crease with its sharpness");
  await player.settled();
  await player.agrees();
  await page.mouse.click(...await edgeAt(player, vertex));
  assert.equal((await mesh(player)).creases, undefined, "and smooth again");
  await page.click("#tool-corner");
  const n = (await mesh(player)).corners?.length ?? 0;
  await page.mouse.click(...await seen(player, vertex));
  assert.notEqual((await mesh(player)).corners?.length ?? 0, n, "a corner is put or taken");
  await page.click("#tool-hole");
  const face = (await mesh(player)).faces.find((one) => one.includes(vertex));
  const corners = await Promise.all(face.map((v) => seen(player, v)));
  await page.mouse.click(...[0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis] / 4, 0)));
  assert.equal((await mesh(player)).holes?.length, 1, "a hole");
  await player.settled();
  await player.agrees();
  await page.selectOption("#examples", "vase");
  await player.settled();
  const { latitude, longitude } = await mesh(player);
  for (const [tool, tagged] of [["latitude", latitude], ["longitude", longitude]]) {
    const [a, b] = await player.page.evaluate((edges) => {
      const depth = (edge) => edge.reduce((sum, v) => sum + window.planish.stage().seen(v)[2], 0);
      return edges.reduce((best, edge) => (depth(edge) < depth(best) ? edge : best));
    }, tagged);
    const [from, to] = [await seen(player, a), await seen(player, b)];
    await page.click(`#tool-${tool}`);
    const tap = () => page.mouse.click((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
    await tap();
    const fewer = (await mesh(player))[tool]?.length ?? 0;
    assert(fewer < tagged.length - 1, `${tool}: the whole line is taken, ${fewer} of ${tagged.length} are left`);
    await tap();
    assert.equal((await mesh(player))[tool].length, tagged.length, `${tool}: and put back`);
    await player.settled();
    await player.agrees();
  }
  await page.click("#tool-move");
}

async function checkShow(player) {
  const { page } = player;
  await page.selectOption("#examples", "star");
  await player.settled();
  for (const name of ["surface", "wireframe", "net", "isolines", "extraordinary", "flat"]) {
    await page.click(`#show-${name}`);
    await player.settled();
    await page.click(`#show-${name}`);
  }
  await page.click("#show-limit");
  await player.settled();
  await player.agrees({ positions: "limit" });
  await page.click("#show-limit");
  await page.fill("#tolerance", "0.01");
  await page.locator("#tolerance").blur();
  await player.settled();
  await player.agrees();
  await page.fill("#tolerance", "");
  await page.locator("#tolerance").blur();
  await page.locator("#level").fill("2");
  await player.settled();
  await page.waitForFunction(() => /at most/.test(document.querySelector("#numbers").textContent));
  assert.match(await page.locator("#numbers").textContent(), /Volume\d/);
  await page.waitForFunction(() => /C²/.test(document.querySelector("#verdict").textContent));
  assert(await page.locator("#valences tbody tr").count() > 0, "the valences of this mesh");
}

async function checkPictures(player) {
  const { page } = player;
  await page.click("#pictures summary");
  const loaded = (last) => page.waitForFunction((last) => {
    const picture = document.querySelector("#picture");
    return !picture.hidden && picture.complete && picture.naturalWidth === 640 && picture.src !== last;
  }, last);
  await loaded("");
  for (const name of await page.locator("#shading option").allTextContents()) {
    const last = await page.locator("#picture").getAttribute("src");
    if (await page.locator("#shading").inputValue() === name) continue;
    await page.selectOption("#shading", name);
    await loaded(last);
  }
}

async function checkSchemes(player) {
  const { page } = player;
  player.expected.push(/status of 422/);
  await page.selectOption("#examples", "star");
  await player.settled();
  for (const name of await page.locator("#scheme option").allTextContents()) {
    await page.selectOption("#scheme", name);
    await page.waitForFunction((name) => document.querySelector("#scheme")?.value === name, name);
    await player.settled();
    assert.equal(await player.notice(), "", `${name} works on triangles`);
    await player.agrees();
  }
  await page.selectOption("#scheme", "push-back");
  await page.waitForSelector("#parameter-plan-parameters-delta");
  for (const delta of ["0", "0.5", "1", "(valence-4)/valence"]) {
    await page.fill("#parameter-plan-parameters-delta", delta);
    await player.settled();
    await player.agrees();
  }
  await page.selectOption("#boundary", "edge-only");
  await page.selectOption("[data-scheme=scheme] select >> nth=0", "word");
  await player.settled();
  await player.agrees();
}

// A cube as other programs write it: each side has four vertices of its own.
function partedCube() {
  const corner = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]];
  const sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
  const places = Float32Array.from(sides.flat().flatMap((v) => corner[v]));
  const order = Uint16Array.from(sides.flatMap((_, at) => [0, 1, 2, 0, 2, 3].map((v) => 4 * at + v)));
  const buffer = Buffer.concat([Buffer.from(places.buffer), Buffer.from(order.buffer)]);
  const n = places.byteLength;
  const document = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }], buffers: [{ byteLength: buffer.length }],
    bufferViews: [{ buffer: 0, byteLength: n }, { buffer: 0, byteOffset: n, byteLength: order.byteLength }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 24, type: "VEC3", min: [-1, -1, -1], max: [1, 1, 1] },
      { bufferView: 1, componentType: 5123, count: 36, type: "SCALAR" },
    ],
  };
  let text = JSON.stringify(document);
  text = text.padEnd(Math.ceil(text.length / 4) * 4);
  const words = (...given) => Buffer.from(Uint32Array.from(given).buffer);
  return Buffer.concat([
    words(0x46546c67, 2, 28 + text.length + buffer.length, text.length, 0x4e4f534a), Buffer.from(text),
    words(buffer.length, 0x004e4942), buffer,
  ]);
}

const tagged = `${[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1]].map((row) => `v ${row.join(" ")}`)
  .join("\n")}\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng left\nusemtl red\nf 1/1 2/2 3/3 4/4\ng right\nusemtl blue\n`
  + "f 1/1 5/3 6/4 2/2\nt crease 2/1/0 0 1 2.5\nt corner 1/1/0 3 2.0\n";

// Drops a file onto the stage.
async function drop(player, name, content) {
  await player.page.evaluate(([name, bytes]) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([Uint8Array.from(bytes)], name));
    document.querySelector("#stage").dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true }));
  }, [name, [...Buffer.from(content)]]);
}

async function checkFiles(player) {
  const { page } = player;
  player.expected.push(/status of 422/);
  const file = ["api/examples/meshes/nut.obj", "../../../api/examples/meshes/nut.obj"]
    .map((path, at) => join(at ? here : process.cwd(), path)).find(existsSync);
  await page.setInputFiles("#file", file);
  await page.waitForFunction(() => window.planish.job().input.mesh.positions.length === 48);
  await player.settled();
  await player.agrees();
  const ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    + "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    + "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
  await page.evaluate((text) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([text], "four.ply"));
    const stage = document.querySelector("#stage");
    stage.dispatchEvent(new DragEvent("dragover", { dataTransfer: dropped, bubbles: true, cancelable: true }));
    stage.dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true, cancelable: true }));
  }, ply);
  await page.waitForFunction(() => window.planish.job().input.mesh.positions.length === 4);
  await player.settled();
  await player.agrees();
  await drop(player, "cube.glb", partedCube());
  await page.waitForFunction(() => window.planish.job().input.mesh.positions.length === 8);
  await page.waitForFunction(() => /welding merged 16/.test(document.querySelector("#warned").textContent));
  await player.settled();
  await player.agrees();
  await page.click("#warned button");
  assert(await page.locator("#warned").isHidden(), "warnings are closed");
  // the scheme stays when a file is dropped, and this one knows sharpness
  await page.selectOption("#examples", "sheet");
  await player.settled();
  await drop(player, "tagged.obj", tagged);
  await page.waitForFunction(() => window.planish.job().input.mesh.positions.length === 6);
  const { creases, corners, uvs, groups, materials } = await mesh(player);
  assert.deepEqual(creases, [{ edge: [0, 1], sharpness: 2.5 }]);
  assert.deepEqual(corners, [{ vertex: 3, sharpness: 2 }]);
  assert.deepEqual([uvs.values.length, groups.length, materials.length], [6, 2, 2], "what the file carries is kept");
  await player.settled();
  await player.agrees();
  // a face that the file hides stays a face, and can be shown again
  await drop(player, "hole.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\n"
    + "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nt hole 1/0/0 1\n");
  await page.waitForFunction(() => window.planish.job().input.mesh.positions.length === 8);
  const holed = await mesh(player);
  assert.deepEqual([holed.faces.length, holed.holes], [3, [1]], "holes are kept");
  await player.settled();
  await player.agrees();
  await page.evaluate(() => {
    const dropped = new DataTransfer();
    dropped.items.add(new File(["nothing that is a mesh"], "notes.obj"));
    document.querySelector("#stage").dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true }));
  });
  await page.waitForFunction(() => !document.querySelector("#notice").hidden);
}

// A file is dropped, one of its edges made sharp, and the result taken along in every format, STEP for CAD included.
async function checkTaking(player) {
  const { page } = player;
  // the scheme stays when a file is dropped, and CAD takes limits of Catmull-Clark
  await page.selectOption("#examples", "sheet");
  await player.settled();
  const cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    + "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  await page.evaluate((text) => {
    const dropped = new DataTransfer();
    dropped.items.add(new File([text], "cube.obj"));
    document.querySelector("#stage").dispatchEvent(new DragEvent("drop", { dataTransfer: dropped, bubbles: true }));
  }, cube);
  await page.waitForFunction(() => window.planish.job().input.mesh.faces.length === 6);
  await page.waitForFunction(() => document.querySelector("#notice").hidden);
  await player.settled();
  const vertex = await nearest(player);
  const from = await seen(player, vertex);
  await player.drag(from, [from[0] + 40, from[1] - 20]);
  await page.click("#tool-crease");
  await page.locator("#sharpness").fill("10");
  await page.mouse.click(...await edgeAt(player, vertex));
  assert.equal((await mesh(player)).creases.length, 1);
  await page.click("#tool-move");
  await player.settled();
  await page.click("#take-open");
  await page.waitForFunction(() => document.querySelector("#take-link")?.value);
  const formats = await page.locator("[data-format]").evaluateAll((all) => all.map((one) => one.dataset.format));
  for (const format of ["png", "svg", "glb", "obj", "stl", "ply", "step"]) assert(formats.includes(format), format);
  await checkDownloads(player, formats);
  assert.equal(await page.locator("#take .fault").textContent(), "");
  await page.click("#take [aria-label=Close]");
  // the limit surface, from another place, with edges: in each state each format answers
  await page.click("#show-limit");
  await page.click("#show-wireframe");
  await page.mouse.move(700, 300);
  await page.mouse.wheel(0, -240);
  await player.drag([300, 640], [380, 600]);
  await player.settled();
  await page.click("#take-open");
  await page.waitForFunction(() => document.querySelector("#take-link")?.value);
  await checkDownloads(player, formats);
  for (const format of ["svg", "pdf", "png"]) {
    await page.selectOption("#take-format", format);
    await page.waitForFunction((name) => document.querySelector("#take-job").value.includes(`"${name}"`), format);
    const { camera } = JSON.parse(await page.locator("#take-job").inputValue()).outputs[0];
    assert(camera.zoom > 1.1 && camera.azimuth_deg !== 35, `${format} looks from where the page looks`);
  }
  await page.click("#take [aria-label=Close]");
  const hidden = ["limit", "wireframe", "surface", "net"];
  for (const name of hidden) await page.click(`#show-${name}`);
  await page.click("#take-open");
  await page.waitForFunction(() => document.querySelector("#take-link")?.value);
  await checkDownloads(player, ["png", "svg", "pdf"].filter((format) => formats.includes(format)));
  await page.click("#take [aria-label=Close]");
  for (const name of hidden.slice(2)) await page.click(`#show-${name}`);
}

// The permalink keeps where the page looks and how its picture is shaded.
async function checkView(player, given) {
  const { page } = player;
  await page.evaluate(() => { document.querySelector("#pictures").open = true; });
  await page.selectOption("#shading", "isophotes");
  await page.waitForFunction(() => /view=.*shading=isophotes/.test(location.hash));
  const other = await Player.open(given, { hash: new URL(page.url()).hash });
  const [[x, y], [ox, oy]] = [await seen(player, 0), await seen(other, 0)];
  assert(Math.hypot(x - ox, y - oy) < 0.1, `a vertex is seen where it was: ${x} ${y}, and ${ox} ${oy}`);
  assert.equal(await other.page.locator("#shading").inputValue(), "isophotes");
  await other.page.waitForTimeout(600);
  assert.equal(other.page.url(), page.url(), "and the address stays as it is");
  await other.close();
}

async function checkExamples(player) {
  const { page } = player;
  for (const value of await page.locator("#examples option").evaluateAll((all) => all.map((one) => one.value))) {
    if (value === "") continue;
    await page.selectOption("#examples", value);
    await player.settled();
    assert.equal(await player.notice(), "", value);
    await player.agrees();
  }
}

export async function checkSurfaces(given) {
  const player = await Player.open(given, { acceptDownloads: true });
  await player.page.click("#mode-surfaces");
  await player.page.waitForSelector("#tool-crease");
  await player.settled();
  await player.accessible("the page of surfaces");
  for (const check of [checkVertices, checkTags, checkShow, checkPictures, checkExamples, checkSchemes, checkFiles,
    checkTaking, checkView]) await check(player, given);
  await player.page.click("#mode-curves");
  await player.page.waitForSelector(".curve");
  await player.close();
  return "surfaces, tags, pictures and files";
}
