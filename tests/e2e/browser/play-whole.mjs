// The page as a whole: its size, fingers, frames, pictures of it.
import assert from "node:assert/strict";
import { join } from "node:path";
import { deflateSync } from "node:zlib";
import { Player } from "./player.mjs";

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

// Drags a point along a circle, a step a frame, and counts frames in which something new was drawn.
async function framesOf(player, [x, y]) {
  const { page } = player;
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 8, y, { steps: 3 });
  const target = await page.evaluateHandle(() => document.querySelector(".point.selected, .pane canvas"));
  const told = await page.evaluate(async ([target, x, y]) => {
    const stage = window.planish.stage();
    const [drawn, asked, start] = [stage.drawn, stage.requests, performance.now()];
    let frames = 0;
    const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));
    for (; frames < 60; frames += 1) {
      const angle = frames / 10;
      const place = { clientX: x + 40 * Math.cos(angle), clientY: y + 40 * Math.sin(angle) };
      target.dispatchEvent(new PointerEvent("pointermove", { ...place, pointerId: 1, bubbles: true, pointerType: "mouse" }));
      await frame();
    }
    const seconds = (performance.now() - start) / 1000;
    return { rate: (stage.drawn - drawn) / seconds, drawn: stage.drawn - drawn, requests: stage.requests - asked };
  }, [target, x, y]);
  await page.mouse.up();
  return told;
}

// A polygon of 200 points at level 6, and a mesh of 500 quads at level 3.
export async function checkFrames(given) {
  const around = Array.from({ length: 200 }, (_, i) => {
    const [angle, radius] = [i * Math.PI / 100, 3 + 0.4 * Math.cos(i * 0.9)];
    return [radius * Math.cos(angle), radius * Math.sin(angle)].map((value) => Math.round(value * 1000) / 1000);
  });
  const told = [];
  const open = (job) => Player.open(given, { hash: `#job=${deflateSync(JSON.stringify(job)).toString("base64url")}` });
  const curve = { input: { polygon: { points: around, closed: true } }, plan: { preset: "cubic-b-spline" }, levels: 6 };
  let player = await open(curve);
  await player.page.waitForTimeout(600);
  const ofCurve = await framesOf(player, await player.middle(".point", 10));
  assert(ofCurve.drawn > 10, `${ofCurve.drawn} frames`);
  told.push(`curve of 200 points ${ofCurve.rate.toFixed(0)} frames a second with ${ofCurve.requests} requests`);
  await player.settled();
  await player.agrees();
  await player.close();
  const n = 23;
  const positions = Array.from({ length: n * n }, (_, i) => {
    const [u, v] = [i % n - n / 2, Math.floor(i / n) - n / 2];
    return [u, Math.round(300 * Math.sin(u / 3) * Math.cos(v / 3)) / 100, v];
  });
  const faces = Array.from({ length: (n - 1) ** 2 }, (_, i) => {
    const at = Math.floor(i / (n - 1)) * n + i % (n - 1);
    return [at, at + n, at + n + 1, at + 1];
  });
  player = await open({ input: { mesh: { positions, faces } }, plan: { preset: "catmull-clark" }, levels: 3 });
  await player.page.waitForTimeout(1500);
  const vertex = 11 * n + 11;
  const [x, y] = await player.page.evaluate((v) => window.planish.stage().seen(v), vertex);
  const box = await player.page.locator("canvas").boundingBox();
  const ofSurface = await framesOf(player, [box.x + x, box.y + y]);
  assert(ofSurface.drawn > 5, `${ofSurface.drawn} frames`);
  told.push(`mesh of ${faces.length} quads ${ofSurface.rate.toFixed(0)} with ${ofSurface.requests}`);
  await player.settled();
  await player.agrees();
  await player.close();
  return told.join(", ");
}

// Pictures of the page, for people to look at.
export async function screenshots(given) {
  for (const [width, height] of [[1440, 900], [390, 844]]) {
    for (const colorScheme of ["light", "dark"]) {
      const player = await Player.open(given, { viewport: { width, height }, colorScheme, deviceScaleFactor: 1 });
      const { page } = player;
      const shot = (name) => page.screenshot({ path: join(given.folder, `${name}-${width}-${colorScheme}.png`) });
      await page.waitForTimeout(600);
      await shot("curves");
      await page.click("#mode-surfaces");
      await page.waitForTimeout(400);
      await player.settled();
      await page.waitForTimeout(900);
      await shot("surfaces");
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
