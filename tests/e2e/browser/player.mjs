// A page /play with what tests ask of it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const axe = () => readFileSync(process.env.AXE ?? createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

// A page that notes what goes wrong in it, and what it asks for.
export class Player {
  static async open({ browser, origin }, { hash = "", ...options } = {}) {
    const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
    const page = await context.newPage();
    const player = new Player();
    Object.assign(player, { context, page, origin, wrong: [], asked: [], expected: [] });
    page.on("pageerror", (error) => player.wrong.push(String(error.stack ?? error)));
    page.on("console", (message) => {
      if (!["error", "warning"].includes(message.type())) return;
      const text = `${message.text()} ${message.location().url}`;
      // browsers write into the console that an answer was a refusal, which some tests are about
      if (player.expected.some((known) => known.test(text))) return;
      // what drivers say of reading pixels for screenshots
      if (/GPU stall|GL Driver Message/.test(text)) return;
      player.wrong.push(text);
    });
    page.on("request", (request) => player.asked.push(request));
    await page.goto(`${origin}/play${hash}`);
    await player.settled();
    return player;
  }

  // Waits until a shape is shown that is the one of the job that is shown.
  async settled() {
    await this.page.waitForFunction(() => window.planish?.shown());
    await this.page.evaluate(async () => {
      // a change of the panel asks for shapes a moment later
      for (let calm = 0; calm < 3; calm += 1) {
        await new Promise((resolve) => setTimeout(resolve, 50));
        if (window.planish.busy()) calm = -1;
      }
    });
    await this.page.waitForFunction(() => window.planish.shown());
  }

  async close() {
    assert.deepEqual(this.wrong, [], "nothing goes wrong in the page");
    const elsewhere = this.asked.map((request) => request.url()).filter((url) => !url.startsWith(this.origin)
      && !url.startsWith("blob:") && !url.startsWith("data:"));
    assert.deepEqual(elsewhere, [], "nothing is asked elsewhere");
    await this.context.close();
  }

  job() {
    return this.page.evaluate(() => window.planish.job());
  }

  // The points that are shown, one behind the other.
  shown() {
    return this.page.evaluate(() => [...window.planish.shown().flat]);
  }

  // What is shown has the same bits as the answer of the service for the job that is shown.
  async agrees(options = {}) {
    const [job, shown] = await this.page.evaluate(async () => {
      while (window.planish.busy()) await new Promise((resolve) => setTimeout(resolve, 20));
      return [window.planish.job(), [...window.planish.shown().flat]];
    });
    const body = JSON.stringify({ ...job, outputs: [{ format: "json", ...options }] });
    const headers = { "content-type": "application/json" };
    const answer = await fetch(`${this.origin}/v1/render`, { method: "POST", headers, body });
    assert.equal(answer.status, 200, await answer.clone().text());
    const { points, positions } = await answer.json();
    const answered = (points ?? positions).flat();
    assert.equal(shown.length, answered.length);
    const at = shown.findIndex((value, i) => !Object.is(value, answered[i]));
    assert.equal(at, -1, `number ${at}: ${shown[at]}, answered ${answered[at]}`);
  }

  notice() {
    return this.page.evaluate(() => {
      const shown = document.getElementById("notice");
      return shown.hidden ? "" : shown.textContent;
    });
  }

  async drag(from, to, steps = 8) {
    await this.page.mouse.move(...from);
    await this.page.mouse.down();
    await this.page.mouse.move(...to, { steps });
    await this.page.mouse.up();
  }

  // The middle of an element.
  async middle(selector, at = 0) {
    const box = await this.page.locator(selector).nth(at).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  }

  // No serious fault of accessibility.
  async accessible(what) {
    await this.page.evaluate(axe());
    const faults = await this.page.evaluate(async () => {
      const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
      return violations.filter(({ impact }) => ["serious", "critical"].includes(impact))
        .map(({ id, nodes }) => `${id}: ${nodes.map(({ html, any }) => `${html} ${any[0]?.message ?? ""}`).join(" | ")}`);
    });
    assert.deepEqual(faults, [], `${what} is accessible`);
  }
}
