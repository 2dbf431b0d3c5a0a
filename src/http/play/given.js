// The line below the stage: the job, the line of curl, the address and the permalink, always in view.

import { at, h, say } from "./dom.js";
import { copy, lines } from "./lines.js";
import { state } from "./state.js";

/** What stands in the line, by the name that `lines` gives it. */
const GIVEN = { text: "JSON job", curl: "curl", link: "Link", permalink: "Permalink" };

/** How much of a text is shown at most: what fits on wide screens. */
const SHOWN = 200;

let now = {};

function button([name, title]) {
  const text = h("code", { "aria-hidden": "true" });
  const press = async () => {
    await copy(now[name]);
    say(`${title}: copied`);
    text.textContent = "Copied";
    setTimeout(() => { text.textContent = (now[name] || now.tooLong).slice(0, SHOWN); }, 1200);
  };
  return h("button", { type: "button", id: `given-${name}`, onclick: press },
    h("b", {}, title), text);
}

/** Shows what the page shows now: curves as a picture, surfaces as a model. */
export async function give() {
  if (!at("given-text")) at("given").replaceChildren(...Object.entries(GIVEN).map(button));
  const format = state.mode === "curves" ? "svg" : "glb";
  now = await lines(format, format);
  for (const name of Object.keys(GIVEN)) {
    const [place, text] = [at(`given-${name}`), now[name]];
    place.querySelector("code").textContent = (text || now.tooLong).slice(0, SHOWN);
    place.title = text ? "Copy" : now.tooLong;
    place.disabled = !text;
  }
}
