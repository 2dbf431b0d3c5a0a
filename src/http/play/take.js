// The drawer “Download and share”: the job, the ways to ask for it again, and downloads.

import { at, h, say } from "./dom.js";
import { copy as copied, lines, output, readable } from "./lines.js";
import { catalogue, key, render, setKey } from "./service.js";
import { changed, current, job, state } from "./state.js";

/** Formats in the order in which they are offered; those that the service does not list are left out. */
const KINDS = {
  "Pictures": ["png", "svg", "pdf"], "Models for other programs": ["glb", "obj", "stl", "ply", "step"],
  "Numbers": ["json"],
};
const OFFERED = Object.values(KINDS).flat();

/** The file of a result, by its format. */
async function download(format, { extension }) {
  const answer = await render(job(), output(format));
  const link = h("a", { href: URL.createObjectURL(await answer.blob()), download: `planish.${extension}` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  say(`planish.${extension} was downloaded`);
}

function text(id, title, rows) {
  const area = h("textarea", { id, rows, readonly: true, spellcheck: "false", "aria-label": title });
  const copy = h("button", { type: "button", "aria-label": `Copy ${title}` }, "Copy");
  copy.onclick = async () => {
    await copied(area.value);
    copy.textContent = "Copied";
    copy.setAttribute("aria-label", `Copied ${title}`);
    setTimeout(() => {
      copy.textContent = "Copy";
      copy.setAttribute("aria-label", `Copy ${title}`);
    }, 1500);
  };
  return h("div", { class: "text" }, area, copy);
}

async function fill() {
  const format = at("take-format").value;
  const { extension } = (await catalogue("formats")).find(({ name }) => name === format);
  const { whole, curl, link, tooLong, permalink } = await lines(format, extension);
  at("take-job").value = readable(whole);
  at("take-curl").value = curl;
  at("take-link").value = link || tooLong;
  at("take-open-link").hidden = !link;
  if (link) at("take-open-link").href = link;
  at("take-permalink").value = permalink;
}

/** Opens the drawer with what is shown now. */
export async function openTake(failed) {
  const drawer = at("take");
  const kind = state.mode === "curves" ? "polygons" : "meshes";
  let formats = [];
  try {
    formats = (await catalogue("formats")).filter(({ name, holds }) => OFFERED.includes(name) && holds.includes(kind));
  } catch (fault) {
    failed(fault);
    return;
  }
  formats.sort((a, b) => OFFERED.indexOf(a.name) - OFFERED.indexOf(b.name));
  const wrong = h("p", { class: "fault", role: "alert" });
  const buttons = formats.map((format) => h("button", {
    type: "button", "data-format": format.name, title: format.doc,
    onclick: async () => {
      wrong.textContent = "";
      await download(format.name, format).catch((fault) => { wrong.textContent = fault.message; });
    },
  }, format.name.toUpperCase(), h("small", {}, `.${format.extension}`)));
  const choice = h("select", { id: "take-format", onchange: fill }, formats.map(({ name }) => (
    h("option", { value: name }, name))));
  const keyField = h("input", { id: "take-key", type: "password", autocomplete: "off", class: "wide" });
  keyField.value = key();
  keyField.onchange = () => {
    setKey(keyField.value);
    changed("all");
  };
  drawer.replaceChildren(h("div", {},
    h("div", { class: "head" }, h("h2", { id: "take-title" }, "Download and share"),
      h("button", { type: "button", class: "icon", "aria-label": "Close", onclick: () => drawer.close() }, "✕")),
    ...Object.entries(KINDS).flatMap(([kind, names]) => [h("h3", {}, kind), h("div", { class: "downloads" },
      ...buttons.filter(({ dataset }) => names.includes(dataset.format)))]), wrong,
    h("h3", {}, "A link to this page"),
    h("p", { class: "doc" }, "Opens it as it is now: the link holds all of it, and the service keeps nothing."),
    text("take-permalink", "the permalink", 2),
    h("h3", {}, h("label", { for: "take-format" }, "Ask the service for it, as "), choice),
    h("p", { class: "doc" }, "The job: the same job has the same bytes, here and on the command line."),
    text("take-job", "the job", 12),
    h("h3", {}, "As a line of curl"), text("take-curl", "the curl line", 4),
    h("h3", {}, "As an address, for pages and viewers"), text("take-link", "the address", 3),
    h("p", { class: "doc" }, h("a", { id: "take-open-link", target: "_blank", rel: "noopener" }, "Open it")),
    h("details", { class: "doc" }, h("summary", {}, "A key, where the service asks for one"),
      h("label", { for: "take-key" }, "Key, kept until this tab is closed"), keyField),
  ));
  drawer.showModal();
  await fill();
  if (current().input.polygon?.points.length < 2) wrong.textContent = "Put two points at least.";
}
