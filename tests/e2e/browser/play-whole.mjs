// The page as a whole: its size, fingers, frames, pictures of it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { deflateSync } from "node:zlib";
import { Player } from "./player.mjs";
import { launch } from "./service.mjs";

// Compressed bytes that are sent before the first curve stands.
export async function checkFirstPicture({ browser, origin }) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  const page = await context.newPage();
  const client = await context.newCDPSession(page);
  await client.send("Network.enable");
  let sent = 0;
  client.on("Network.loadingFinished", ({ encodedDataLength }) => { sent += encodedDataLength; });
  await page.goto(`${origin}/play`);
  await page.waitForFunction(() => document.querySelector(".curve path")?.getAttribute("d"));
  assert(sent > 5000 && sent < 100_000, `${sent} bytes before the first picture`);
  await context.close();
  return `first picture after ${sent} bytes`;
}

// Fingers tap, drag and pinch.
export async function checkTouch(given) {
  const player = await Player.open(given, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const { page } = player;
  const n = (await player.job()).input.polygon.points.length;
  const box = await page.locator("#stage").boundingBox();
  await page.touchscreen.tap(box.x + box.width * 0.8, box.y + box.height * 0.15);
  assert.equal((await player.job()).input.polygon.points.length, n + 1, "a tap adds a point");
  const client = await page.context().newCDPSession(page);
  const touch = (type, ...places) => client.send("Input.dispatchTouchEvent", {
    type, touchPoints: places.map(([x, y], id) => ({ x, y, id })),
  });
  const before = await player.job();
  const [x, y] = await player.middle(".point", 1);
  await touch("touchStart", [x, y]);
  for (let step = 1; step <= 5; step += 1) await touch("touchMove", [x + 6 * step, y - 6 * step]);
  await touch("touchEnd");
  assert.notDeepEqual(await player.job(), before, "a finger drags a point");
  await player.settled();
  await player.agrees();
  const [cx, cy] = [box.x + box.width / 2, box.y + box.height / 2];
  const wide = async () => {
    const [[ax], [bx]] = [await player.middle(".point", 0), await player.middle(".point", 3)];
    return Math.abs(bx - ax);
  };
  const last = await wide();
  await touch("touchStart", [cx - 10, cy + 10], [cx + 10, cy - 10]);
  for (let step = 1; step <= 5; step += 1) {
    await touch("touchMove", [cx - 10 - 4 * step, cy + 10 + 4 * step], [cx + 10 + 4 * step, cy - 10 - 4 * step]);
  }
  await touch("touchEnd");
  await page.waitForTimeout(100);
  assert(await wide() > last * 1.3, "two fingers zoom");
  await player.close();
  return "fingers";
}

// A polygon of 200 points at level 6, and a mesh of 484 quads at level 3, without and with tags.
const many = (() => {
  const points = Array.from({ length: 200 }, (_, i) => {
    const [angle, radius] = [i * Math.PI / 100, 3 + 0.4 * Math.cos(i * 0.9)];
    return [radius * Math.cos(angle), radius * Math.sin(angle)].map((value) => Math.round(value * 1000) / 1000);
  });
  const n = 23;
  const positions = Array.from({ length: n * n }, (_, i) => {
    const [u, v] = [i % n - n / 2, Math.floor(i / n) - n / 2];
    return [u, Math.round(300 * Math.sin(u / 3) * Math.cos(v / 3)) / 100, v];
  });
  const faces = Array.from({ length: (n - 1) ** 2 }, (_, i) => {
    const at = Math.floor(i / (n - 1)) * n + i % (n - 1);
    return [at, at + n, at + n + 1, at + 1];
  });
  return {
    curve: { input: { polygon: { points, closed: true } }, plan: { preset: "cubic-b-spline" }, levels: 6 },
    surface: { input: { mesh: { positions, faces } }, plan: { preset: "catmull-clark" }, levels: 3 },
    // lines of creases of several sharpnesses along and across, the corners of the sheet and some within
    tagged: {
      input: {
        mesh: {
          positions, faces,
          creases: Array.from({ length: n - 1 }, (_, i) => [
            { edge: [11 * n + i, 11 * n + i + 1], sharpness: 10 }, { edge: [i * n + 7, (i + 1) * n + 7], sharpness: 2.5 },
          ]).flat(),
          corners: [0, n - 1, n * (n - 1), n * n - 1, 5 * n + 15].map((vertex) => ({ vertex, sharpness: 10 })),
        },
      },
      plan: { preset: "catmull-clark" }, levels: 3,
    },
    vertex: 11 * n + 11,
  };
})();

// Opens the page with a job, by whose stencils it moves from then on.
async function opened(given, job, { show = "polygon.surface.net", ...options } = {}) {
  const coded = deflateSync(JSON.stringify(job)).toString("base64url");
  const player = await Player.open(given, { hash: `#job=${coded}&show=${show}`, ...options });
  const stencils = () => player.asked.find((request) => /stencils-bin/.test(request.postData() ?? ""));
  while (!stencils()) await player.page.waitForTimeout(50);
  await (await stencils().response())?.finished();
  await player.page.waitForTimeout(600);
  await player.settled();
  return player;
}

async function vertexOn(page, vertex) {
  const [x, y] = await page.evaluate((v) => window.planish.stage().seen(v), vertex);
  const box = await page.locator("canvas").boundingBox();
  return [box.x + x, box.y + y];
}

// Takes a point and drags it along a circle, a step a frame. Tells how many frames a second had something new, and the
// milliseconds that the page's thread was busy for each: the first depends on what else the machine does.
async function framesOf(player, [x, y]) {
  const { page } = player;
  const client = await player.context.newCDPSession(page);
  await client.send("Performance.enable", { timeDomain: "threadTicks" });
  const busy = async () => {
    const { metrics } = await client.send("Performance.getMetrics");
    return metrics.find(({ name }) => name === "TaskDuration").value;
  };
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 8, y, { steps: 3 });
  const target = await page.evaluateHandle(() => document.querySelector(".point.selected, .pane canvas"));
  const circle = (frames) => page.evaluate(async ([target, x, y, frames]) => {
    const stage = window.planish.stage();
    const [drawn, asked, start] = [stage.drawn, stage.requests, performance.now()];
    for (let at = 0; at < frames; at += 1) {
      const place = { clientX: x + 40 * Math.cos(at / 10), clientY: y + 40 * Math.sin(at / 10) };
      const event = { ...place, pointerId: 1, bubbles: true, pointerType: "mouse" };
      target.dispatchEvent(new PointerEvent("pointermove", event));
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    const seconds = (performance.now() - start) / 1000;
    return { rate: (stage.drawn - drawn) / seconds, drawn: stage.drawn - drawn, requests: stage.requests - asked };
  }, [target, x, y, frames]);
  // the first frames are slower: what stays is drawn, and functions are compiled
  await circle(20);
  const before = await busy();
  const told = await circle(120);
  told.busy = (await busy() - before) * 1000 / told.drawn;
  return told;
}

// Drags are drawn frame by frame without requests; how quickly is printed, and not asserted.
export async function checkFrames(given) {
  // Chromium without a graphics processor, as it is: the page is put together by its own painter, and WebGL emulated
  const browser = await launch("--disable-gpu-compositing");
  const told = [];
  try {
    for (const kind of ["curve", "surface", "tagged"]) {
      const player = await opened({ ...given, browser }, many[kind]);
      const { page } = player;
      const from = kind === "curve" ? await player.middle(".point", 10) : await vertexOn(page, many.vertex);
      const { drawn, requests, rate, busy } = await framesOf(player, from);
      assert.equal(drawn, 120, "each step is drawn");
      assert.equal(requests, 0, "and asks for nothing");
      await page.mouse.up();
      await player.settled();
      await player.agrees();
      await player.close();
      told.push(`${kind} ${rate.toFixed(0)} frames a second, ${busy.toFixed(1)} ms of the page's thread each`);
    }
  } finally {
    await browser.close();
  }
  return told.join(", ");
}

// While a vertex is dragged that part is drawn which moves: the picture is the one that is drawn as a whole at rest,
// and stays as it is when the hand lets go, with edges that look hard, too.
export async function checkParts(given) {
  for (const [show, kind] of [
    ["surface.net", "surface"], ["surface.net.wireframe.extraordinary", "surface"],
    ["net.isolines.surface.flat", "surface"], ["surface.net", "tagged"],
  ]) {
    // as many pixels while something moves as at rest
    const options = { deviceScaleFactor: 2, viewport: { width: 900, height: 700 } };
    const player = await opened(given, many[kind], { show, ...options });
    const { page } = player;
    const [x, y] = await vertexOn(page, many.vertex);
    const before = await page.evaluate(() => document.querySelector(".pane canvas").toDataURL());
    await page.mouse.move(x, y);
    await page.mouse.down();
    const [moved, rested] = await page.evaluate(async ([x, y]) => {
      const canvas = document.querySelector(".pane canvas");
      for (let at = 1; at <= 8; at += 1) {
        const place = { clientX: x + 6 * at, clientY: y - 9 * at };
        const event = { ...place, pointerId: 1, bubbles: true, pointerType: "mouse" };
        canvas.dispatchEvent(new PointerEvent("pointermove", event));
        const { drawn } = window.planish.stage();
        while (window.planish.stage().drawn === drawn) await new Promise((resolve) => requestAnimationFrame(resolve));
      }
      const moved = canvas.toDataURL();
      await new Promise((resolve) => setTimeout(resolve, 1500));
      return [moved, canvas.toDataURL()];
    }, [x, y]);
    assert.notEqual(moved, before, `${kind}, ${show}: a drag is seen`);
    assert(moved === rested, `${kind}, ${show}: the picture in parts is another than the whole`);
    await page.mouse.up();
    await player.settled();
    await page.waitForTimeout(1500);
    const released = await page.evaluate(() => document.querySelector(".pane canvas").toDataURL());
    assert(released === rested, `${kind}, ${show}: the picture changes when the hand lets go`);
    await player.close();
  }
  return "surfaces in parts";
}

// Shows faults at fields of two schemes, which have a line of their own and leave the fields as wide as they were.
async function faulty(player) {
  const { page } = player;
  player.expected.push(/status of 422/);
  await page.click("#compare");
  await page.selectOption("[data-scheme=other-scheme] select >> nth=0", "word");
  await page.waitForSelector("input#other-scheme");
  const { width } = await page.locator("#other-scheme").boundingBox();
  await page.fill("#other-scheme", "UXX");
  await page.waitForSelector("[data-scheme=other-scheme] .fault");
  const box = await page.locator("#other-scheme").boundingBox();
  assert(Math.abs(box.width - width) < 2, `the field is ${box.width} wide beside its fault, and was ${width}`);
  const fault = await page.locator("[data-scheme=other-scheme] .fault").first().boundingBox();
  assert(fault.y >= box.y + box.height - 1 && fault.width > width, "a fault stands below its field");
  await page.locator("[data-scheme=other-scheme] .fault").first().scrollIntoViewIfNeeded();
  await page.waitForTimeout(150);
}

// Pictures of the page, for people to look at; with faults, too, and in all of them none of accessibility.
export async function screenshots(given) {
  for (const [width, height] of [[1440, 900], [390, 844]]) {
    for (const colorScheme of ["light", "dark"]) {
      const player = await Player.open(given, { viewport: { width, height }, colorScheme, deviceScaleFactor: 1 });
      const { page } = player;
      const shot = (name) => page.screenshot({ path: join(given.folder, `${name}-${width}-${colorScheme}.png`) });
      await page.waitForTimeout(600);
      await shot("curves");
      await player.accessible(`curves at ${width}, ${colorScheme},`);
      await faulty(player);
      await shot("fault");
      await player.accessible(`a fault at ${width}, ${colorScheme},`);
      await page.click("#mode-surfaces");
      await page.waitForTimeout(400);
      await player.settled();
      await page.waitForTimeout(900);
      assert.equal(await player.notice(), "", "faults of curves stay with these");
      await shot("surfaces");
      await player.accessible(`surfaces at ${width}, ${colorScheme},`);
      await page.click("#take-open");
      await page.waitForTimeout(600);
      await shot("take");
      await page.keyboard.press("Escape");
      await page.click("#help-open");
      await page.waitForTimeout(200);
      await shot("help");
      await player.context.close();
    }
  }
  return "";
}
