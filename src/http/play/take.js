// The drawer “Download and share”: the job, the ways to ask for it again, and downloads.

import { at, h, say } from "./dom.js";
import { catalogue, key, render, setKey } from "./service.js";
import { changed, current, fragment, job, packed, state } from "./state.js";

/** Formats in the order in which they are offered; those that the service does not list are left out. */
const KINDS = {
  "Pictures": ["png", "svg", "pdf"], "Models for other programs": ["glb", "obj", "stl", "ply", "step"],
  "Numbers": ["json"],
};
const OFFERED = Object.values(KINDS).flat();

/** Most bytes of an address that the service takes. */
const LONGEST_ADDRESS = 8192;

/** The output of a format, as the picture on the page has it. */
export function output(format) {
  const { show, mode } = state;
  if (!["svg", "png", "pdf"].includes(format)) return { format, ...(show.limit ? { positions: "limit" } : {}) };
  const size = { format, width: 1200, height: 900 };
  if (mode === "curves") {
    const shown = ["curve", ...(show.polygon ? ["control", "points"] : []), ...(show.samples ? ["vertices"] : []),
      ...(show.comb ? ["comb"] : [])];
    return { ...size, show: shown };
  }
  const limit = show.limit ? { positions: "limit" } : {};
  if (format !== "png") return { ...size, ...limit };
  const names = { surface: "surface", wireframe: "wireframe", isolines: "isolines", extraordinary: "extraordinary" };
  const shown = Object.keys(names).filter((name) => show[name]);
  return { ...size, ...limit, show: [...shown, ...(show.net ? ["control"] : [])], camera: output.camera?.() };
}

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
    await navigator.clipboard.writeText(area.value).catch(() => {
      area.select();
      document.execCommand("copy");
    });
    copy.textContent = "Copied";
    copy.setAttribute("aria-label", `Copied ${title}`);
    setTimeout(() => {
      copy.textContent = "Copy";
      copy.setAttribute("aria-label", `Copy ${title}`);
    }, 1500);
  };
  return h("div", { class: "text" }, area, copy);
}

/** Rows of positions in one line each, so that a job can be read. */
function readable(value) {
  return JSON.stringify(value, null, 2).replaceAll(/\[\s+(-?[\d.e+-]+(?:,\s+-?[\d.e+-]+)*)\s+\]/g, (row) => (
    row.replaceAll(/\s+/g, " ").replace("[ ", "[").replace(" ]", "]")));
}

const quoted = (given) => `'${given.replaceAll("'", "'\\''")}'`;

async function fill() {
  const format = at("take-format").value;
  const whole = { ...job(), outputs: [output(format)] };
  at("take-job").value = readable(whole);
  const { extension } = (await catalogue("formats")).find(({ name }) => name === format);
  const shown = key() ? " -H 'Authorization: Bearer KEY'" : "";
  at("take-curl").value = `curl --fail-with-body -o planish.${extension}${shown} -H 'Content-Type: application/json' `
    + `-d ${quoted(JSON.stringify(whole))} ${location.origin}/v1/render`;
  const link = `${location.origin}/v1/render?job=${await packed(whole)}`;
  const fits = link.length <= LONGEST_ADDRESS;
  const tooLong = `This job is too long for an address: ${link.length} of ${LONGEST_ADDRESS} bytes. Send it with the `
    + "line above; the answer's Content-Location is an address.";
  at("take-link").value = fits ? link : tooLong;
  at("take-open-link").hidden = !fits;
  if (fits) at("take-open-link").href = link;
  at("take-permalink").value = location.origin + location.pathname + await fragment();
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
