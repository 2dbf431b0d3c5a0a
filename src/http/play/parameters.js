// Controls for the parameters of schemes, made from what the catalogue says of them.

import { h, short } from "./dom.js";

/** The value of a constant such as "1/243", "pi/6" or 0.25; NaN for everything else. */
export function constant(text) {
  const tokens = String(text).toLowerCase().match(/\d+\.?\d*(?:e[-+]?\d+)?|\.\d+|pi|[-+*/()]|\S/g) ?? [];
  let place = 0;
  const atom = () => {
    const token = tokens[place++];
    if (token === "-") return -atom();
    if (token === "pi") return Math.PI;
    if (token === "(") {
      const inner = sum();
      return tokens[place++] === ")" ? inner : NaN;
    }
    return /^[\d.]/.test(token ?? "") ? Number(token) : NaN;
  };
  const product = () => {
    let value = atom();
    while (tokens[place] === "*" || tokens[place] === "/") {
      value = tokens[place++] === "*" ? value * atom() : value / atom();
    }
    return value;
  };
  const sum = () => {
    let value = product();
    while (tokens[place] === "+" || tokens[place] === "-") value += tokens[place++] === "+" ? product() : -product();
    return value;
  };
  const value = sum();
  return place === tokens.length ? value : NaN;
}

/** What a text field says: a number where it is one, a list where there are commas, else an expression. */
export function read(text, kind) {
  const trimmed = text.trim();
  if (kind === "numbers" || (kind === "expressions" && trimmed.includes(","))) {
    return trimmed.split(",").map((part) => read(part, ""));
  }
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(trimmed) ? Number(trimmed) : trimmed;
}

const written = (value) => (Array.isArray(value) ? value.join(", ") : String(value ?? ""));

/** Values of a parameter that the claims of a preset name. */
function claimed(name, { claims = [] }) {
  const inRange = new RegExp(`\\b${name}\\b`);
  const found = [];
  for (const claim of claims) {
    for (const values of claim.at ?? []) if (name in values) found.push(constant(values[name]));
    for (const part of (claim.range ?? "").split(",").filter((text) => inRange.test(text))) {
      found.push(...part.split(/<=|>=|<|>|=/).map((side) => constant(side)));
    }
  }
  return found.filter(Number.isFinite);
}

/** Where a slider goes from and to: the declared bounds where they are near, else around what is claimed or usual. */
export function span(parameter, scheme, value) {
  const { min, max, name, unit, kind } = parameter;
  if (kind === "integer") return { from: min, to: Math.min(max, min + 24), step: 1 };
  if (unit === "radians") return { from: 0, to: 3.14, step: 0.01 };
  let bounds = [min, max];
  if (!Number.isFinite(min) || !Number.isFinite(max) || max - min > 100) {
    const known = [...claimed(name, scheme), constant(parameter.default)].filter(Number.isFinite);
    const [low, high] = [Math.min(0, ...known), Math.max(...known, 0)];
    const room = (high - low || 1) * 0.25;
    bounds = [low - room, high + room];
    if (kind.startsWith("expression")) bounds = [Math.min(low, -0.5), Math.max(high + room, 1.5)];
  }
  if (Number.isFinite(value)) bounds = [Math.min(bounds[0], value), Math.max(bounds[1], value)];
  const step = 10 ** Math.floor(Math.log10((bounds[1] - bounds[0]) / 150));
  const even = (bound, round) => Number((round(bound / step) * step).toPrecision(12));
  return { from: even(bounds[0], Math.floor), to: even(bounds[1], Math.ceil), step };
}

/** What a required parameter is at first: what the first claim is tried at, else the middle of its slider. */
export function initial(parameter, scheme) {
  const tried = scheme.claims?.flatMap((claim) => claim.at ?? []).find((values) => parameter.name in values);
  if (tried) return read(tried[parameter.name], parameter.kind);
  if (parameter.kind === "numbers") return ["1/2", 1, "1/2"];
  if (parameter.kind === "integer") return Math.min(Math.max(-1, parameter.min), parameter.max);
  return parameter.unit === "radians" ? 0.5 : 0;
}

/**
 * A control of a parameter: name, slider where it has a range, a field that takes expressions, and its doc. Calls
 * `set(value, live)`, with `undefined` for the default.
 */
export function control(parameter, scheme, value, pointer, set) {
  const { name, kind, doc, unit, expects } = parameter;
  const id = `parameter${pointer.replaceAll("/", "-")}`;
  const usual = parameter.default;
  const told = h("span", { class: "name" }, h("label", { for: id }, name), unit ? h("small", {}, ` ${unit}`) : "");
  const about = h("p", { class: "doc" }, doc);
  const fields = { id, "data-pointer": pointer, autocomplete: "off", spellcheck: "false", title: `Expects ${expects}` };
  if (kind === "choice") {
    const select = h("select", { ...fields, onchange: () => set(select.value) },
      ...parameter.choices.map((choice) => (
        h("option", { value: choice, selected: choice === (value ?? usual) }, choice))));
    return h("div", { class: "parameter", "data-faults": true }, told, select, about);
  }
  if (kind === "flag") {
    const box = h("input", { ...fields, type: "checkbox", onchange: () => set(box.checked) });
    box.checked = value ?? usual ?? false;
    return h("div", { class: "parameter", "data-faults": true }, told, box, about);
  }
  const field = h("input", { ...fields, type: "text", inputmode: "text", placeholder: written(usual) });
  field.value = written(value);
  const isLong = kind === "numbers";
  field.oninput = () => set(field.value.trim() === "" ? undefined : read(field.value, kind), true);
  field.onchange = () => set(field.value.trim() === "" ? undefined : read(field.value, kind));
  const now = constant(Array.isArray(value) ? NaN : value ?? usual);
  if (isLong) return h("div", { class: "parameter long", "data-faults": true }, told, field, about);
  const { from, to, step } = span(parameter, scheme, now);
  const slider = h("input", { type: "range", min: from, max: to, step, "aria-label": `${name}, slider` });
  slider.value = Number.isFinite(now) ? now : (from + to) / 2;
  const slid = (live) => () => {
    field.value = short(Number(slider.value), 6);
    set(Number(slider.value), live);
  };
  slider.oninput = slid(true);
  slider.onchange = slid(false);
  field.addEventListener("input", () => {
    const typed = constant(field.value);
    if (Number.isFinite(typed)) slider.value = typed;
  });
  return h("div", { class: "parameter", "data-faults": true }, told, field, slider, about);
}
