// The element <planish-view> in a page of another origin.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { deflateSync } from "node:zlib";
import { MeshoptDecoder } from "meshoptimizer";
import { startService } from "./service.mjs";

const cube = {
  positions: [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
  faces: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
};

function link(origin, output, levels) {
  const job = { input: { mesh: cube }, plan: { preset: "catmull-clark" }, levels, outputs: [output] };
  return `${origin}/v1/render?job=${deflateSync(JSON.stringify(job)).toString("base64url")}`;
}

// What the page's own reader makes of streams has the bytes that the decoder of meshoptimizer makes of them.
async function checkStreams(origin) {
  const text = await (await fetch(`${origin}/play/meshopt.js`)).text();
  const { unpacked } = await import(`data:text/javascript,${encodeURIComponent(text)}`);
  await MeshoptDecoder.ready;
  let n = 0;
  for (let level = 0; level <= 6; level += 1) {
    const answer = await fetch(link(origin, { format: "glb", compression: "meshopt" }, level));
    const bytes = await answer.arrayBuffer();
    const length = new DataView(bytes).getUint32(12, true);
    const { bufferViews } = JSON.parse(new TextDecoder().decode(bytes.slice(20, 20 + length)));
    const buffer = bytes.slice(28 + length);
    for (const stream of bufferViews.map((view) => view.extensions?.EXT_meshopt_compression).filter(Boolean)) {
      const { count, byteStride, byteOffset = 0, byteLength, mode, filter } = stream;
      const wanted = new Uint8Array(count * byteStride);
      const source = new Uint8Array(buffer, byteOffset, byteLength);
      MeshoptDecoder.decodeGltfBuffer(wanted, count, byteStride, source, mode, filter);
      // the last byte of a direction says nothing
      const isSaid = (at) => filter === undefined || at % 4 !== 3;
      const found = new Uint8Array(unpacked(stream, buffer));
      assert.equal(found.length, wanted.length);
      assert.equal(wanted.findIndex((byte, at) => isSaid(at) && byte !== found[at]), -1, `${mode} at level ${level}`);
      n += 1;
    }
  }
  assert(n >= 18, `${n} streams`);
}

// A signed link of a glTF with levels of detail opens its buffers as well, in a page that has no key.
async function checkSigned({ browser, origin, binary }) {
  const data = mkdtempSync(join(tmpdir(), "planish-keys-"));
  const run = (args, input) => execFileSync(binary, args, { input, encoding: "utf8", stdio: ["pipe", "pipe", "ignore"] }).trim();
  const key = run(["key", "add", "--data-dir", data, "--tenant", "acme"]);
  const { service, origin: shut } = await startService(binary, "--data-dir", data);
  const page = await browser.newPage({ viewport: { width: 600, height: 500 } });
  const plain = (_, response) => response.writeHead(200, { "content-type": "text/html" }).end("<!doctype html>");
  const server = createServer(plain);
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    const output = { format: "gltf", lod: [1, 3] };
    const job = { input: { mesh: cube }, plan: { preset: "catmull-clark" }, levels: 3, outputs: [output] };
    const src = run(["sign", "--key", key, "--url", shut, "-"], JSON.stringify(job));
    assert.equal((await fetch(link(shut, output, 3))).status, 401, "without the signature nothing is opened");
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const told = await page.evaluate(async ([origin, src]) => {
      await import(`${origin}/play/planish-view.js`);
      const element = document.createElement("planish-view");
      const levels = [];
      element.addEventListener("level", ({ detail }) => levels.push(detail.triangles));
      const ended = new Promise((resolve) => {
        element.addEventListener("load", () => resolve(""));
        element.addEventListener("error", ({ message }) => resolve(message));
      });
      element.setAttribute("src", src);
      document.body.append(element);
      return [await ended, levels];
    }, [origin, src]);
    assert.deepEqual(told, ["", [48, 768]], "both levels of a signed link are shown");
  } finally {
    await page.close();
    server.close();
    service.kill("SIGTERM");
    rmSync(data, { recursive: true, force: true });
  }
}

export async function checkElement({ browser, origin, folder, binary }) {
  await checkStreams(origin);
  await checkSigned({ browser, origin, binary });
  const html = `<!doctype html><title>elsewhere</title><script type="module" src="${origin}/play/planish-view.js"></script>
    <planish-view src="${link(origin, { format: "gltf", lod: [1, 2, 4] }, 4)}" alt="A round cube"></planish-view>
    <planish-view id="glb" wireframe src="${link(origin, { format: "glb", compression: "quantize" }, 3)}"></planish-view>
    <planish-view id="packed" src="${link(origin, { format: "gltf", compression: "meshopt", lod: [1, 4] }, 4)}"></planish-view>
    <planish-view id="wrong" src="${origin}/v1/render?job=e30"></planish-view>`;
  const server = createServer((_, response) => response.writeHead(200, { "content-type": "text/html" }).end(html));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const page = await browser.newPage({ viewport: { width: 600, height: 1850 } });
  const wrong = [];
  page.on("pageerror", (error) => wrong.push(String(error)));
  await page.addInitScript(() => {
    window.levels = [];
    document.addEventListener("level", (event) => window.levels.push(event.detail), true);
    window.told = [];
    const note = ({ type, target }) => target.localName === "planish-view" && window.told.push([type, target.id]);
    // windows are told of no load but their own
    for (const type of ["load", "error"]) document.addEventListener(type, note, true);
  });
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => window.told.length === 4);
  const told = await page.evaluate(() => window.told);
  assert.deepEqual(told.map((one) => one.join(" ")).sort(), ["error wrong", "load ", "load glb", "load packed"]);
  const levels = await page.evaluate(() => window.levels.filter(({ of }) => of === 3));
  assert.deepEqual(levels.map(({ triangles }) => triangles), [48, 192, 3072], "the coarsest level first");
  const packed = await page.evaluate(() => window.levels.filter(({ of }) => of === 2));
  assert.deepEqual(packed.map(({ triangles }) => triangles), [48, 3072], "levels of streams");
  assert.match(await page.locator("#wrong p").textContent(), /cannot be shown/);
  // a picture of one colour would be an empty canvas
  const before = await page.locator("planish-view").first().screenshot();
  const box = await page.locator("planish-view").first().boundingBox();
  await page.mouse.move(box.x + 200, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 320, box.y + 190, { steps: 6 });
  await page.mouse.up();
  await page.waitForTimeout(200);
  const after = await page.locator("planish-view").first().screenshot();
  assert(before.length > 3000 && !before.equals(after), "a drag turns the model");
  await page.screenshot({ path: join(folder, "element.png") });
  assert.deepEqual(wrong, []);
  await page.close();
  server.close();
  return "element";
}
