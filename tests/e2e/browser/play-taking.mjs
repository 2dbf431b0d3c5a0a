// What people take with them from the page: files, lines, addresses; and the page without its service.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { Player } from "./player.mjs";

const value = (page, id) => page.locator(`#${id}`).inputValue();

// Each download has the bytes that the service answers for the job that the drawer shows for its format.
export async function checkDownloads(player, formats) {
  const { page } = player;
  for (const format of formats) {
    await page.selectOption("#take-format", format);
    await page.waitForFunction((name) => document.querySelector("#take-job").value.includes(`"${name}"`), format);
    const job = await value(page, "take-job");
    const [download] = await Promise.all([page.waitForEvent("download"), page.click(`[data-format=${format}]`)]);
    const bytes = readFileSync(await download.path());
    const headers = { "content-type": "application/json" };
    const answer = await fetch(`${player.origin}/v1/render`, { method: "POST", headers, body: job });
    assert.equal(answer.status, 200, `${format}: ${await answer.clone().text()}`);
    const answered = Buffer.from(await answer.arrayBuffer());
    assert(bytes.equals(answered), `${format}: ${bytes.length} bytes, answered ${answered.length}`);
    assert.match(download.suggestedFilename(), /^planish\.[a-z]+$/);
  }
}

async function checkLines(player, folder) {
  const { page } = player;
  await page.selectOption("#take-format", "svg");
  await page.waitForFunction(() => document.querySelector("#take-curl").value.includes("planish.svg"));
  const line = await value(page, "take-curl");
  execFileSync("sh", ["-c", `${line} -sS`], { cwd: folder });
  const link = await fetch(await value(page, "take-link"));
  assert.equal(link.headers.get("content-type"), "image/svg+xml");
  assert.equal(await link.text(), readFileSync(join(folder, "planish.svg"), "utf8"), "curl and the address agree");
  for (const name of ["the permalink", "the job", "the curl line", "the address"]) {
    await page.click(`[aria-label="Copy ${name}"]`);
  }
}

// A page that is opened by the permalink shows the same, and says the same of itself.
async function checkPermalink(given, player) {
  const { page } = player;
  const address = new URL(await value(page, "take-permalink"));
  const [job, shown] = [await player.job(), await player.shown()];
  const other = await Player.open(given, { hash: address.hash });
  assert.deepEqual(await other.job(), job);
  assert.deepEqual(await other.shown(), shown);
  assert.equal(await other.page.isChecked("#show-comb"), await page.isChecked("#show-comb"));
  assert.equal(await other.page.locator("#other-scheme").count(), await page.locator("#other-scheme").count());
  await other.page.click("#take-open");
  await other.page.waitForFunction(() => document.querySelector("#take-permalink")?.value);
  assert.equal(await value(other.page, "take-permalink"), address.href);
  await other.close();
}

// Without its service the page goes on, says so, and catches up.
async function checkOffline(player) {
  const { page } = player;
  player.expected.push(/ERR_INTERNET_DISCONNECTED/);
  await player.context.setOffline(true);
  await page.selectOption("#scheme", "chaikin");
  await page.waitForFunction(() => /cannot be reached/.test(document.querySelector("#notice").textContent));
  await page.click("#help-open");
  await page.click("#help [aria-label=Close]");
  const n = (await player.job()).input.polygon.points.length;
  await page.mouse.click(720, 200);
  const from = await player.middle(".point", 0);
  await player.drag(from, [from[0] + 40, from[1] - 30]);
  assert.equal((await player.job()).input.polygon.points.length, n + 1, "points are added and moved without a service");
  await player.context.setOffline(false);
  await page.waitForFunction(() => document.querySelector("#notice").hidden);
  await player.settled();
  await player.agrees();
}

// Below the stage the job, the line of curl, the address and the permalink are always in view, and copied by a press.
async function checkGiven(player, folder) {
  const { page } = player;
  const copied = async (name) => {
    const button = page.locator(`#given-${name}`);
    const { x, y, width, height } = await button.boundingBox();
    const { width: wide, height: high } = page.viewportSize();
    assert(x >= 0 && y >= 0 && x + width <= wide && y + height <= high, `${name} is in view`);
    await page.evaluate(() => navigator.clipboard.writeText("nothing"));
    await button.click();
    await page.waitForFunction(async () => await navigator.clipboard.readText() !== "nothing");
    return page.evaluate(() => navigator.clipboard.readText());
  };
  await page.selectOption("#scheme", "four-point");
  await player.settled();
  await page.waitForFunction(() => document.querySelector("#given-text code").textContent.includes("four-point"));
  const job = JSON.parse(await copied("text"));
  const { outputs, ...shown } = job;
  assert.deepEqual(shown, await player.job(), "the job that is copied is the one that is shown");
  assert.equal(outputs[0].format, "svg");
  execFileSync("sh", ["-c", `${await copied("curl")} -sS`], { cwd: folder });
  const answer = await fetch(await copied("link"));
  assert.equal(await answer.text(), readFileSync(join(folder, "planish.svg"), "utf8"), "curl and the address agree");
  assert.equal(await copied("permalink"), page.url());
}

export async function checkTaking(given) {
  const permissions = ["clipboard-read", "clipboard-write"];
  const player = await Player.open(given, { acceptDownloads: true, permissions });
  const { page } = player;
  await checkGiven(player, given.folder);
  await page.click("#show-comb");
  await page.click("#compare");
  await page.waitForSelector("#other-scheme");
  await page.click("#take-open");
  await page.waitForFunction(() => document.querySelector("#take-link")?.value);
  const formats = await page.locator("[data-format]").evaluateAll((all) => all.map((one) => one.dataset.format));
  for (const format of ["svg", "png", "obj", "ply", "glb", "json"]) assert(formats.includes(format), format);
  await checkDownloads(player, formats);
  await checkLines(player, given.folder);
  await player.accessible("the drawer");
  await checkPermalink(given, player);
  await page.click("#take [aria-label=Close]");
  await page.click("#help-open");
  await player.accessible("the help");
  await page.click("#help [aria-label=Close]");
  await checkOffline(player);
  await player.close();
  return `${formats.length} downloads, addresses and an hour without service`;
}
