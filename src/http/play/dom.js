// Elements of the page: how they are made, found and told apart from their faults.

const SVG = "http://www.w3.org/2000/svg";

/** The element of the page with this id. */
export const at = (id) => document.getElementById(id);

/** An element of HTML: attributes by name, listeners as functions named `on...`, children as nodes or texts. */
export function h(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

/** An element of SVG, given like one of HTML. */
export function s(tag, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children);
}

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element[name] = value;
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** Signs of tools, drawn on 16 by 16. */
const SIGNS = {
  closed: "M3 5 8 2l5 3v6l-5 3-5-3Z", corner: "M3 13V3h10", delete: "M4 4l8 8M12 4l-8 8",
  tangents: "M3 13 13 3M7 3h6v6", draw: "M3 13l1-4 7-7 3 3-7 7ZM9 4l3 3",
  fit: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4", move: "M8 1v14M1 8h14M8 1 6 3M8 1l2 2M8 15l-2-2M8 15l2-2",
  crease: "M2 11 8 5l6 6", latitude: "M2 8c3 3 9 3 12 0M2 5c3 3 9 3 12 0M2 11c3 3 9 3 12 0",
  longitude: "M8 2v12M8 2C3 5 3 11 8 14M8 2c5 3 5 9 0 12", open: "M2 13V3h4l2 2h6v8Z",
  hole: "M2 2h12v12H2ZM5.5 5.5h5v5h-5Z",
};

/** A tool: a button with a sign and a word, of which narrow windows show the sign. */
export function tool(id, sign, word, title, onclick) {
  const drawn = s("svg", { class: "sign", viewBox: "0 0 16 16", "aria-hidden": "true" }, s("path", { d: SIGNS[sign] }));
  const words = h("span", { class: "word" }, word);
  return h("button", { type: "button", id, title, onclick, "aria-label": word }, drawn, words);
}

/** Waits until calls have ceased for so many milliseconds, then makes the last one. */
export function settled(wait, run) {
  let timer = 0;
  return (...given) => {
    clearTimeout(timer);
    timer = setTimeout(() => run(...given), wait);
  };
}

/** Writes a text into an element where it is another: what stays as it is need not be drawn again. */
export function write(element, text) {
  if (element.textContent !== String(text)) element.textContent = text;
}

/** Tells those who listen to the page what happened. */
export function say(text) {
  at("said").textContent = text;
}

/** Shows what is wrong over the stage; nothing hides it. */
export function notice(text) {
  const shown = at("notice");
  write(shown, text ?? "");
  shown.hidden = !text;
}

/** Shows what the service warns of near the picture, until it is closed or there is something else to warn of. */
export function warn(texts) {
  const shown = at("warned");
  const now = texts.join("\n");
  if ((shown.dataset.texts ?? "") === now) return;
  shown.dataset.texts = now;
  shown.hidden = now === "";
  const close = h("button", { type: "button", class: "icon", "aria-label": "Close the warnings" }, "✕");
  close.onclick = () => { shown.hidden = true; };
  shown.replaceChildren(h("ul", {}, [...new Set(texts)].map((text) => h("li", {}, text))), close);
}

/** A number as people read it: at most so many digits, and no zeros behind the point. */
export function short(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits)));
}

/** A count with its thousands parted. */
export const count = (value) => value.toLocaleString("en");

/** What is marked as wrong: the fields, and what is written at them. */
const marks = { fields: [], texts: [] };

/** Marks the fields that pointers of a refusal name, and returns what belongs to no field of the page. */
export function markFaults(errors) {
  clearFaults();
  const fields = [...document.querySelectorAll("[data-pointer]")];
  const left = [];
  for (const { pointer = "", detail } of errors) {
    const fits = (field) => pointer === field.dataset.pointer || pointer.startsWith(`${field.dataset.pointer}/`);
    const found = fields.filter(fits).sort((a, b) => b.dataset.pointer.length - a.dataset.pointer.length)[0];
    if (!found || found.offsetParent === null) {
      left.push(detail);
      continue;
    }
    const told = found.closest("[data-faults]");
    found.setAttribute("aria-invalid", "true");
    marks.fields.push(found);
    if (!told) {
      left.push(detail);
      continue;
    }
    marks.texts.push(h("p", { class: "fault", role: "alert" }, detail));
    told.append(marks.texts.at(-1));
  }
  return left;
}

/** Takes all marks of faults off the fields. */
export function clearFaults() {
  for (const text of marks.texts.splice(0)) text.remove();
  for (const field of marks.fields.splice(0)) field.removeAttribute("aria-invalid");
}
