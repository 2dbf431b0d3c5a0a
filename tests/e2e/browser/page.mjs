// Starts the service and a page on another port, which is another origin, and checks what the page sees.
import assert from "node:assert/strict";
import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { deflateSync } from "node:zlib";
import { launch, startService } from "./service.mjs";

const [binary, screenshots] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const three = join(here, "../node_modules/three");
const types = { ".html": "text/html", ".js": "text/javascript" };

const cube = {
  mesh: {
    positions: [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    faces: [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
    materials: [{ name: "orange", faces: [0, 1, 2, 3, 4, 5], color: [0.9, 0.4, 0.1, 1] }],
  },
};
const plan = { preset: "catmull-clark" };
const model = (options) => ({ input: cube, plan, levels: 4, outputs: [{ format: "glb", ...options }] });
const picture = {
  input: cube, plan, levels: 3, outputs: [{ format: "png", width: 320, height: 240, background: "#204060" }],
};

function base64url(job) {
  return deflateSync(JSON.stringify(job), { level: 9 }).toString("base64url");
}

// Serves the page and three.js.
async function servePage() {
  const server = createServer((request, response) => {
    const path = normalize(new URL(request.url, "http://localhost").pathname);
    const file = path.startsWith("/three/") ? join(three, path.slice(7)) : join(here, path);
    if (path.includes("..") || !existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
    createReadStream(file).pipe(response);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return server;
}

// Opens the page, and records what really came over the wire for each of its requests.
async function openPage(browser, address) {
  const page = await browser.newPage({ viewport: { width: 400, height: 300 } });
  page.on("pageerror", (error) => console.error(`in the page: ${error}`));
  const wire = [];
  const client = await page.context().newCDPSession(page);
  await client.send("Network.enable");
  const urls = new Map();
  client.on("Network.requestWillBeSent", ({ requestId, request }) => urls.set(requestId, request.url));
  client.on("Network.responseReceivedExtraInfo", ({ requestId, statusCode, headers }) => {
    const small = Object.entries(headers).map(([name, value]) => [name.toLowerCase(), value]);
    // what is told of a request and what of its answer come in any order
    const entry = { get url() { return urls.get(requestId); } };
    wire.push(Object.assign(entry, { status: statusCode, headers: Object.fromEntries(small) }));
  });
  await page.goto(address);
  await page.waitForFunction(() => window.ready);
  return { page, wire };
}

// What came over the wire for an address, once so many answers are known: a page may have them before we do.
async function came(wire, url, n) {
  const found = () => wire.filter((entry) => entry.url === url);
  for (const last = Date.now() + 10_000; found().length < n && Date.now() < last; ) {
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  return found();
}

function isOrange(mean) {
  const [red, green, blue] = mean;
  assert(red > 120 && red > 1.4 * green && green > blue, `orange, not ${mean.map(Math.round)}`);
}

// What GLTFLoader loads by an address looks as it should, and comes compressed.
async function checkModels({ page, wire }, origin) {
  const sizes = [];
  for (const [name, options] of [["plain", {}], ["meshopt", { compression: "meshopt" }]]) {
    const url = `${origin}/v1/render?job=${base64url(model(options))}`;
    const shown = await page.evaluate((url) => window.showModel(url), url);
    await page.screenshot({ path: join(screenshots, `model-${name}.png`) });
    assert(shown.share > 0.1 && shown.share < 0.7, `${name}: ${shown.share} of the pixels`);
    isOrange(shown.mean);
    const [answer] = await came(wire, url, 1);
    const coding = answer.headers["content-encoding"] ?? "as it is";
    sizes.push(`${name} ${answer.headers["content-length"]} bytes (${coding})`);
    if (name === "plain") assert.match(answer.headers["content-encoding"] ?? "", /^(zstd|br|gzip)$/);
  }
  return sizes.join(", ");
}

// A document of several levels shows the coarsest before the others are loaded.
async function checkLevels({ page, wire }, origin) {
  const outputs = [{ format: "gltf", compression: "meshopt", lod: [1, 3, 5] }];
  const link = `${origin}/v1/render?job=${base64url({ input: cube, plan, levels: 5, outputs })}`;
  // buffers stand beside the document where its Content-Location is
  const { headers } = await page.evaluate((url) => window.ask(url), link);
  const url = origin + headers["content-location"];
  const start = wire.length;
  const bytes = () => {
    const answers = wire.slice(start).filter((entry) => entry.status === 200);
    return answers.reduce((sum, entry) => sum + Number(entry.headers["content-length"]), 0);
  };
  const first = await page.evaluate((url) => window.showModel(url), url);
  const before = bytes();
  await page.screenshot({ path: join(screenshots, "model-level-1.png") });
  const last = await page.evaluate(() => window.refine());
  await page.screenshot({ path: join(screenshots, "model-level-5.png") });
  for (const { share, mean } of [first, last]) {
    assert(share > 0.1 && share < 0.7, `${share} of the pixels`);
    isOrange(mean);
  }
  assert(first.vertices < 100 && last.vertices > 6000, `${first.vertices}, then ${last.vertices} vertices`);
  assert(before < bytes() / 3, `${before} of ${bytes()} bytes before the first picture`);
  return `first picture after ${before} of ${bytes()} bytes`;
}

// What <img> shows has the colours of the job, and may be read by the page.
async function checkPictures({ page }, origin) {
  for (const [name, path] of [
    ["link", `/v1/render?job=${base64url(picture)}`],
    ["kroki", `/kroki/png/${base64url({ ...picture, outputs: undefined })}`],
  ]) {
    const background = name === "link" ? [0x20, 0x40, 0x60] : [255, 255, 255];
    const shown = await page.evaluate(([url, back]) => window.showPicture(url, back), [origin + path, background]);
    await page.screenshot({ path: join(screenshots, `picture-${name}.png`) });
    assert(shown.share > 0.1 && shown.share < 0.9, `${name}: ${shown.share} of the pixels`);
    if (name === "link") assert.deepEqual([shown.width, shown.height], [320, 240]);
  }
}

// The browser asks again with the ETag that it has, and is told that nothing changed.
async function checkCache({ page, wire }, origin) {
  const url = `${origin}/v1/render?job=${base64url({ ...model({}), levels: 3 })}`;
  const ask = (cache) => page.evaluate(([url, cache]) => window.ask(url, { cache }), [url, cache]);
  const [first, kept, again] = [await ask("default"), await ask("default"), await ask("no-cache")];
  const sent = (await came(wire, url, 2)).map((entry) => entry.status);
  assert.deepEqual(sent, [200, 304], "once from the service, once from the cache, once asked again");
  for (const answer of [first, kept, again]) {
    assert.equal(answer.status, 200);
    assert.equal(answer.bytes, first.bytes);
    assert.match(answer.headers.etag, /^"[0-9a-f]{64}-(zst|br|gz)"$/);
    assert.match(answer.headers["content-location"], /^\/v1\/artifacts\//);
    assert(answer.headers["server-timing"] && answer.headers["cache-status"], "headers that a page may read");
  }
}

// Pages post jobs and files, where they may.
async function checkPosts({ page }, origin, foreign) {
  const job = { method: "POST", body: JSON.stringify(model({})), headers: { "content-type": "application/json" } };
  const posted = await page.evaluate(([url, job]) => window.ask(url, job), [`${origin}/v1/render`, job]);
  assert.equal(posted.status, 200);
  const file = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const query = `${origin}/v1/render?preset=loop&levels=3&format=glb`;
  for (const type of ["model/obj", ""]) {
    const made = await page.evaluate(([url, file, type]) => window.post(url, file, type), [query, file, type]);
    assert.equal(made.status, 200, `a file of type "${type}"`);
    assert.equal(made.headers["content-type"], "model/gltf-binary");
  }
  const told = await foreign.page.evaluate((url) => window.ask(url).catch((error) => String(error)), query);
  assert.match(String(told), /TypeError/, "a page from elsewhere may read nothing");
}

const started = Date.now();
const pages = await servePage();
const { service, origin } = await startService(binary);
const browser = await launch("--host-resolver-rules=MAP elsewhere.test 127.0.0.1");
try {
  const { port } = pages.address();
  const page = await openPage(browser, `http://localhost:${port}/index.html`);
  const foreign = await openPage(browser, `http://elsewhere.test:${port}/index.html`);
  const sizes = await checkModels(page, origin);
  const levels = await checkLevels(page, origin);
  await checkPictures(page, origin);
  await checkCache(page, origin);
  await checkPosts(page, origin, foreign);
  const seconds = (Date.now() - started) / 1000;
  console.log(`page: models ${sizes}; ${levels}; pictures, cache and posts as they should be, in ${seconds} s`);
} finally {
  await browser.close();
  service.kill("SIGTERM");
  pages.close();
}
