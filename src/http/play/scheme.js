// The part of the panel that chooses a scheme: a preset or a word, with controls for its parameters.

import { h } from "./dom.js";
import { control, initial } from "./parameters.js";
import { catalogue } from "./service.js";

const BOUNDARIES = ["edge-and-corner", "edge-only", "none"];
const ENDS = ["clamped", "natural"];

/** The presets that refine polygons or meshes. */
export async function presetsFor(mode) {
  const wanted = mode === "curves" ? "polygons" : "meshes";
  return (await catalogue("presets")).filter(({ refines }) => refines.includes(wanted));
}

/** A plan of a preset with the parameters that it has to have. */
export function planOf(preset) {
  const required = preset.parameters.filter((parameter) => parameter.required);
  if (required.length === 0) return { preset: preset.name };
  const values = required.map((parameter) => [parameter.name, initial(parameter, preset)]);
  return { preset: preset.name, parameters: Object.fromEntries(values) };
}

/** A preset as a scheme of the panel, or the operators of a word as one. */
async function schemeOf(plan, presets) {
  if (plan.word === undefined) return presets.find(({ name }) => name === plan.preset);
  const letters = new Set(plan.word.replaceAll(/[^A-Z]/g, ""));
  const used = (await catalogue("operators")).filter(({ letter }) => letters.has(letter));
  const parameters = new Map(used.flatMap((operator) => operator.parameters.map((one) => [one.name, one])));
  return { name: plan.word, parameters: [...parameters.values()], claims: [], doc: wordDoc(used) };
}

const wordDoc = (used) => `The operators of the word, applied once a level from left to right: ${
  used.map(({ letter, name }) => `${letter} ${name}`).join(", ")}.`;

/**
 * Controls for a plan of a document, in a section of their own. Calls `set(plan, live)`; `pointer` is where errors
 * name the plan, `open` whether the polygon is open.
 */
export async function schemeControls({ title, mode, plan, pointer, isOpen, set }) {
  const presets = await presetsFor(mode);
  const scheme = await schemeOf(plan, presets);
  const isWord = plan.word !== undefined;
  const change = (next, live = false) => set(next, live);
  const id = pointer === "/plan" ? "scheme" : "other-scheme";
  const kind = h("select", { "aria-label": "Preset or word" }, ["preset", "word"].map((name) => (
    h("option", { value: name, selected: (name === "word") === isWord }, name === "word" ? "Word" : "Preset"))));
  kind.onchange = () => change(kind.value === "word" ? { word: wordFor(mode) } : planOf(presets[0]));
  const choice = isWord ? wordField(id, plan, pointer, change) : presetField(id, presets, plan, pointer, change);
  const controls = (scheme?.parameters ?? []).map((parameter) => control(
    parameter, scheme, plan.parameters?.[parameter.name], `${pointer}/parameters/${parameter.name}`,
    (value, live) => change(withParameter(plan, parameter.name, value), live),
  ));
  const [visible, further] = sorted(controls, scheme, plan);
  return h(
    "section", { "data-scheme": id }, h("h2", {}, title), h("div", { class: "row", "data-faults": true }, kind, choice),
    scheme ? h("details", { class: "doc" }, h("summary", {}, firstSentence(scheme.doc)), h("p", {}, scheme.doc),
      scheme.source ? h("p", {}, scheme.source) : null) : null,
    ...visible, ends(mode, plan, pointer, isOpen, change),
    further.length > 0 ? h("details", { class: "doc" }, h("summary", {}, "Further parameters"), ...further) : null,
  );
}

function firstSentence(doc) {
  const end = doc.search(/[.;:] /);
  return end > 0 ? `${doc.slice(0, end)}.` : doc;
}

/** Controls that are shown at once, and those of long lists of optional parameters that nobody has set. */
function sorted(controls, scheme, plan) {
  const parameters = scheme?.parameters ?? [];
  if (parameters.length <= 5) return [controls, []];
  const isFurther = (at) => {
    const { name, required } = parameters[at];
    return !required && !(name in (plan.parameters ?? {})) && /_|latitude|perturbation|split|mu/.test(name);
  };
  return [controls.filter((_, at) => !isFurther(at)), controls.filter((_, at) => isFurther(at))];
}

const wordFor = (mode) => (mode === "curves" ? "UCP" : "UC");

function withParameter(plan, name, value) {
  const parameters = { ...plan.parameters };
  if (value === undefined) delete parameters[name];
  else parameters[name] = value;
  // the same object, so that the controls that stand keep speaking of the plan that is shown
  if (Object.keys(parameters).length > 0) plan.parameters = parameters;
  else delete plan.parameters;
  return plan;
}

function presetField(id, presets, plan, pointer, change) {
  const select = h("select", { id, "aria-label": "Scheme", "data-pointer": `${pointer}/preset` },
    presets.map(({ name }) => h("option", { value: name, selected: name === plan.preset }, name)));
  select.onchange = () => change(planOf(presets.find(({ name }) => name === select.value)));
  return select;
}

function wordField(id, plan, pointer, change) {
  const field = h("input", {
    id, type: "text", value: plan.word, "aria-label": "Word", autocomplete: "off", spellcheck: "false", size: 8,
    "data-pointer": `${pointer}/word`,
  });
  field.oninput = () => {
    plan.word = field.value.trim();
    change(plan, true);
  };
  field.onchange = () => change({ ...plan, word: field.value.trim() });
  return field;
}

function ends(mode, plan, pointer, isOpen, change) {
  const [name, values, label] = mode === "curves" ? ["ends", ENDS, "Ends"] : ["boundary", BOUNDARIES, "Boundary"];
  if (mode === "curves" && !isOpen) return null;
  const id = `${name}${pointer === "/plan" ? "" : "-other"}`;
  const select = h("select", { id, "data-pointer": `${pointer}/${name}` }, values.map((value) => (
    h("option", { value, selected: value === (plan[name] ?? values[0]) }, value))));
  select.onchange = () => {
    if (select.value === values[0]) delete plan[name];
    else plan[name] = select.value;
    change(plan);
  };
  return h("div", { class: "parameter", "data-faults": true }, h("label", { class: "name", for: id }, label), select);
}
