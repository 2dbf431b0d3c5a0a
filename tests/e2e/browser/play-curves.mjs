// Curves: every control of the page, and the shape that follows.
import assert from "node:assert/strict";
import { Player } from "./player.mjs";

const points = async (player) => (await player.job()).input.polygon.points;

async function checkPoints(player) {
  const { page } = player;
  const before = await player.shown();
  await player.agrees();
  const from = await player.middle(".point", 2);
  await player.drag(from, [from[0] - 60, from[1] + 90]);
  await player.settled();
  assert.notDeepEqual(await player.shown(), before, "a drag changes the curve");
  await player.agrees();
  const n = (await points(player)).length;
  const edge = await page.locator(".edge").nth(0).evaluate((line) => {
    const box = line.ownerSVGElement.getBoundingClientRect();
    const middle = (a, b) => (Number(line.getAttribute(a)) + Number(line.getAttribute(b))) / 2;
    return [box.left + middle("x1", "x2"), box.top + middle("y1", "y2")];
  });
  await player.drag(edge, [edge[0] - 50, edge[1] - 50]);
  assert.equal((await points(player)).length, n + 1, "an edge gives a point");
  await page.mouse.click(700, 250);
  assert.equal((await points(player)).length, n + 2, "a tap adds a point");
  await page.click("#tool-delete");
  assert.equal((await points(player)).length, n + 1, "the chosen point is deleted");
  await player.settled();
  await player.agrees();
}

async function checkKeys(player) {
  const { page } = player;
  await page.locator(".point").nth(1).focus();
  const [x, y] = (await points(player))[1];
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowUp");
  const [nx, ny] = (await points(player))[1];
  assert(nx > x && ny > y, "arrows move the point that has the focus");
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.dataset.point), "2", "tab goes from point to point");
  const n = (await points(player)).length;
  await page.keyboard.press("i");
  assert.equal((await points(player)).length, n + 1, "I inserts");
  await page.keyboard.press("c");
  assert.equal((await player.job()).input.polygon.corners.length, 1, "C makes a corner");
  await page.keyboard.press("Delete");
  assert.equal((await points(player)).length, n, "Delete deletes");
  assert.equal((await player.job()).input.polygon.corners, undefined, "and its tag goes with it");
  await page.keyboard.press("Control+z");
  assert.equal((await points(player)).length, n + 1, "undo brings it back");
  await page.keyboard.press("Control+Shift+z");
  assert.equal((await points(player)).length, n, "redo takes it again");
  await page.click("#undo");
  await page.click("#redo");
  await page.keyboard.press("]");
  await page.keyboard.press("[");
  await page.keyboard.press("f");
  await page.locator(".point").nth(0).focus();
  await page.click("#tool-corner", { force: true }).catch(() => {});
}

async function checkLevels(player) {
  const { page } = player;
  const level = async () => (await player.job()).levels;
  const before = await level();
  await page.click("#level-down");
  assert.equal(await level(), before - 1);
  await page.click("#level-up");
  await page.locator("#level").fill("2");
  assert.equal(await level(), 2);
  await page.fill("#tolerance", "0.001");
  await page.locator("#tolerance").blur();
  assert.deepEqual(await level(), { tolerance: 0.001 });
  await player.settled();
  await player.agrees();
  await page.fill("#tolerance", "");
  await page.locator("#tolerance").blur();
  await page.locator("#level").fill("3");
  await page.click("#play");
  await page.waitForFunction(() => window.planish.job().levels === 3, null, { timeout: 20_000 });
}

async function checkShow(player) {
  const { page } = player;
  const count = (selector) => page.locator(selector).count();
  for (const [name, selector] of [
    ["levels", ".curve.level"], ["limits", ".dots.limits"], ["comb", ".comb"], ["samples", ".dots.samples"],
  ]) {
    assert.equal(await count(selector), 0, name);
    await page.click(`#show-${name}`);
    await page.locator(selector).first().waitFor({ state: "attached" });
    await page.click(`#show-${name}`);
    await page.waitForFunction((s) => !document.querySelector(s), selector);
  }
  await page.click("#show-polygon");
  await page.waitForFunction(() => !document.querySelector(".polygon"));
  await page.click("#show-polygon");
  await page.click("#compare");
  await page.selectOption("#other-scheme", "four-point");
  await page.locator(".curve.other").first().waitFor({ state: "attached" });
  await page.click("#show-side");
  await page.waitForFunction(() => document.querySelectorAll(".pane:not([hidden])").length === 2);
  await page.click("#show-side");
  await page.click("#compare");
  await page.waitForFunction(() => !document.querySelector(".pane:not([hidden]) .curve.other"));
}

// Every preset that refines polygons gives a curve as it stands, and its sliders keep to it.
async function checkSchemes(player) {
  const { page } = player;
  const names = await page.locator("#scheme option").allTextContents();
  assert(names.length > 15, `${names.length} presets`);
  // schemes that make eight points of one would make a million at the usual level
  await page.locator("#level").fill("2");
  for (const name of names) {
    await page.selectOption("#scheme", name);
    await page.waitForFunction((name) => document.querySelector("#scheme")?.value === name, name);
    await player.settled();
    assert.equal(await player.notice(), "", `${name} works as it stands`);
    const sliders = page.locator("[data-scheme=scheme] input[type=range]:visible");
    for (let at = 0; at < await sliders.count(); at += 1) {
      const slider = sliders.nth(at);
      const [low, high] = [Number(await slider.getAttribute("min")), Number(await slider.getAttribute("max"))];
      const step = Number(await slider.getAttribute("step"));
      await slider.fill(String(low + Math.round((high - low) * 0.45 / step) * step));
    }
    await player.settled();
    if ((await player.notice()) === "") await player.agrees();
  }
}

async function checkWords(player) {
  const { page } = player;
  await page.selectOption("[data-scheme=scheme] select >> nth=0", "word");
  await page.fill("input#scheme", "UCP");
  await page.locator("#scheme").blur();
  await page.fill("#parameter-plan-parameters-alpha", "pi/3");
  await page.fill("#parameter-plan-parameters-kernel", "cos(alpha/2)");
  await page.locator("#parameter-plan-parameters-kernel").blur();
  await player.settled();
  const { plan } = await player.job();
  assert.deepEqual([plan.word, plan.parameters.alpha, plan.parameters.kernel], ["UCP", "pi/3", "cos(alpha/2)"]);
  await player.agrees();
}

async function checkExamples(player) {
  const { page } = player;
  for (const value of await page.locator("#examples option").evaluateAll((all) => all.map((one) => one.value))) {
    if (value === "") continue;
    await page.selectOption("#examples", value);
    await player.settled();
    assert.equal(await player.notice(), "");
    await player.agrees();
  }
  await page.selectOption("#examples", "incenter");
  await page.locator("#tool-tangents").waitFor();
  await page.click("#tool-tangents");
  const before = await player.shown();
  const from = await player.middle(".tangent-tip", 1);
  await player.drag(from, [from[0] + 50, from[1] + 60]);
  await player.settled();
  assert.notDeepEqual(await player.shown(), before, "tangents turn");
  await player.agrees();
  await page.click("#tool-tangents");
  await page.selectOption("#examples", "through");
  await page.selectOption("#scheme", "cubic-b-spline");
  await page.waitForFunction(() => document.querySelector("#scheme").value === "cubic-b-spline");
  await page.waitForSelector("#ends");
  await page.selectOption("#ends", "natural");
  await player.settled();
  await player.agrees();
  await page.click("#tool-closed");
  await page.waitForFunction(() => !document.querySelector("#ends"));
  await page.click("#tool-clear");
  for (const [x, y] of [[400, 300], [700, 250], [800, 600], [450, 650]]) await page.mouse.click(x, y);
  assert.equal((await points(player)).length, 4, "drawn by taps");
  await player.settled();
  await player.agrees();
  await page.click("#tool-fit");
}

async function checkAnalysis(player) {
  const { page } = player;
  await page.selectOption("#examples", "through");
  await page.waitForFunction(() => /C¹/.test(document.querySelector("#verdict").textContent));
  assert.equal(await page.locator(".mask").first().locator("li").count(), 7);
  await page.click("#matrices summary");
  assert.equal(await page.locator(".matrix").count(), 4, "splitting, averaging, push-back and their product");
  await page.fill("#parameter-plan-parameters-w", "1/2");
  await page.waitForFunction(() => !/C¹/.test(document.querySelector("#verdict").textContent));
}

// Where the points of the first pane are on it.
const seen = (player) => player.page.locator(".pane:not([hidden]) .point").evaluateAll((all) => all.map((point) => (
  point.getAttribute("transform").match(/[-\d.]+/g).map(Number))));

// The permalink keeps where the page looks, and so do pictures: points stand in them where they stand on the page.
async function checkView(player, given) {
  const { page } = player;
  await page.selectOption("#examples", "through");
  await player.settled();
  const whole = await seen(player);
  await page.mouse.move(700, 420);
  await page.mouse.wheel(0, -500);
  const box = await page.locator(".pane svg").first().boundingBox();
  await player.drag([box.x + 60, box.y + box.height - 60], [box.x + 110, box.y + box.height - 140]);
  await page.waitForFunction(() => /view=/.test(location.hash));
  await page.waitForTimeout(400);
  const moved = await seen(player);
  assert(moved.some(([x, y], at) => Math.hypot(x - whole[at][0], y - whole[at][1]) > 50), "the view has moved");
  const other = await Player.open(given, { hash: new URL(page.url()).hash });
  for (const [at, [x, y]] of (await seen(other)).entries()) {
    const [wasX, wasY] = moved[at];
    assert(Math.hypot(x - wasX, y - wasY) < 0.1, `point ${at} is at ${x} ${y}, and was at ${wasX} ${wasY}`);
  }
  await other.page.waitForTimeout(600);
  assert.equal(other.page.url(), page.url(), "the address stays as it is");
  await other.close();
  await page.click("#take-open");
  await page.selectOption("#take-format", "svg");
  await page.waitForFunction(() => document.querySelector("#take-job").value.includes('"svg"'));
  const job = await page.locator("#take-job").inputValue();
  await page.click("#take [aria-label=Close]");
  const headers = { "content-type": "application/json" };
  const answer = await fetch(`${player.origin}/v1/render`, { method: "POST", headers, body: job });
  const svg = await answer.text();
  const factor = Number(svg.match(/ width="(\d+)"/)[1]) / box.width;
  const drawn = [...svg.matchAll(/<circle cx="([-\d.]+)" cy="([-\d.]+)"/g)].map(([, x, y]) => [Number(x), Number(y)]);
  assert.equal(drawn.length, moved.length, "each point is drawn");
  for (const [at, [x, y]] of drawn.entries()) {
    const [px, py] = moved[at].map((place) => place * factor);
    assert(Math.hypot(x - px, y - py) < 2, `point ${at} is drawn at ${x} ${y} in place of ${px} ${py}`);
  }
  await page.click("#tool-fit");
  await page.waitForFunction(() => !/view=/.test(location.hash));
}

// What a field says that the service refuses is told at the field, and goes with its cause.
async function checkFaults(player) {
  const { page } = player;
  player.expected.push(/status of 422/);
  await page.selectOption("#examples", "through");
  const field = page.locator("#parameter-plan-parameters-w");
  await field.fill("1/0");
  await page.waitForFunction(() => document.querySelector("#parameter-plan-parameters-w[aria-invalid=true]"));
  const told = await page.locator("[data-scheme=scheme] .fault").textContent();
  assert.match(told, /1\/0|zero|finite/);
  await field.fill("1/16");
  await page.waitForFunction(() => !document.querySelector("#panel .fault"));
  // a second scheme that is refused has no curve
  await page.click("#compare");
  await page.locator(".curve.other").first().waitFor({ state: "attached" });
  await page.selectOption("[data-scheme=other-scheme] select >> nth=0", "word");
  await page.fill("input#other-scheme", "UXX");
  await page.waitForSelector("[data-scheme=other-scheme] .fault");
  await page.waitForFunction(() => !document.querySelector(".pane:not([hidden]) .curve.other"));
  await page.click("#compare");
}

export async function checkCurves(given) {
  const player = await Player.open(given);
  // schemes whose rules are no weights have no stencils and no analysis
  player.expected.push(/422.*\/v1\/(analyses|render)/);
  for (const check of [checkPoints, checkKeys, checkLevels, checkShow, checkWords, checkExamples, checkAnalysis,
    checkView, checkFaults, checkSchemes]) await check(player, given);
  await player.page.selectOption("#examples", "blob");
  await player.settled();
  await player.accessible("the page of curves");
  await player.close();
  return "curves, keys, levels and schemes";
}
