// The page: puts its parts together and has them follow what is changed.

import { analysisSection } from "./analysis.js";
import { Curves } from "./curves.js";
import { at, clearFaults, h, markFaults, notice, say, settled, write } from "./dom.js";
import { example, examplesOf } from "./examples.js";
import { planOf, presetsFor, schemeControls } from "./scheme.js";
import { changed, current, fragment, history, job, listen, redo, restore, state, undo } from "./state.js";

/** How long the page stays as it is before its address follows. Half of it writes more addresses than browsers allow
    in some seconds; twice of it loses more when the page is left. */
const ADDRESS_MS = 250;
const LEVEL_SHOWN_MS = 650;
/** When the parts of the page that nobody has opened yet are loaded, so that they are there without a network. Half of
    it loads them beside the first shapes; twice of it leaves those who go offline without them for longer. */
const REST_LOADED_MS = 1200;

const stages = { curves: new Curves(failed), surfaces: null };
let stage = null;
let analysis = analysisSection();
let panelOf = 0;
let panelMode = null;
let steps = 0;
let pending = 0;
let lastFault = null;

/** Shows what is wrong: at the field that the fault names, or over the stage. */
function failed(fault) {
  lastFault = fault;
  if (!fault) {
    clearFaults();
    notice("");
    return;
  }
  const left = markFaults(fault.errors ?? []);
  notice(fault.errors?.length > 0 ? left.join(" ") : fault.message);
}

async function open(mode) {
  state.mode = mode;
  stage?.close();
  failed(null);
  for (const name of ["curves", "surfaces"]) at(`mode-${name}`).setAttribute("aria-pressed", String(name === mode));
  const choice = at("examples");
  choice.replaceChildren(h("option", { value: "" }, "Choose …"),
    ...examplesOf(mode).map(({ name, title }) => h("option", { value: name }, title)));
  if (mode === "surfaces" && !stages.surfaces) {
    const { Surfaces } = await import("./surfaces.js");
    stages.surfaces = new Surfaces(failed);
  }
  stage = stages[mode];
  stage.open();
}

/** Counts what is under way, for those who wait until the page is at rest. */
async function under(work) {
  pending += 1;
  try {
    return await work;
  } finally {
    pending -= 1;
  }
}

async function load(mode, name) {
  state[mode] = await example(mode, name);
  await open(mode);
  at("examples").value = name;
  changed("all");
  stage.fit();
  say(`Example ${examplesOf(mode).find((one) => one.name === name).title}`);
}

/** Makes the panel anew: what it holds depends on the scheme and on the mode. */
async function panel() {
  panelOf += 1;
  const now = panelOf;
  const mode = state.mode;
  const doc = current();
  const isOpen = mode === "curves" && !doc.input.polygon.closed;
  const replan = (name) => (plan, live) => {
    const isSame = doc[name] === plan;
    doc[name] = plan;
    changed(isSame ? "values" : "plan", live);
  };
  let sections;
  try {
    const scheme = { title: "Scheme", mode, plan: doc.plan, pointer: "/plan", isOpen, set: replan("plan") };
    const other = { title: "Beside it", mode, plan: doc.other, pointer: "/other", isOpen, set: replan("other") };
    sections = await Promise.all([scheme, ...(doc.other ? [other] : [])].map(schemeControls));
    const presets = await presetsFor(mode);
    const one = presets.find(({ name }) => name === doc.plan.preset);
    if (mode === "curves") stages.curves.takesTangents = /tangents of the input/.test(one?.doc ?? "");
  } catch (fault) {
    failed(fault);
    return;
  }
  // a newer panel is on its way
  if (now !== panelOf) return;
  const kept = document.activeElement?.id;
  // the panel of the other mode begins at its top
  const top = panelMode === mode ? at("panel").scrollTop : 0;
  panelMode = mode;
  at("panel").replaceChildren(...sections, shown(), ...(stage.sections?.() ?? []), analysis.section);
  at("panel").scrollTop = top;
  // fields that were wrong are others now
  if (lastFault?.errors?.length > 0) failed(lastFault);
  if (kept && document.activeElement === document.body) at(kept)?.focus();
  stage.refreshTools();
}

function check(name, label, title) {
  const box = h("input", { type: "checkbox", id: `show-${name}` });
  box.checked = state.show[name];
  box.onchange = () => {
    state.show[name] = box.checked;
    changed("show");
  };
  return h("label", { title }, box, label);
}

function shown() {
  const checks = state.mode === "curves" ? [
    check("polygon", "Control polygon"), check("samples", "Points of the level"),
    check("levels", "All levels", "Every level up to this one, thin"),
    check("limits", "Limit points", "Where the points of this level come to in the limit"),
    check("comb", "Curvature comb"), current().other ? check("side", "Side by side") : null,
  ] : stage.checks(check);
  const words = current().other ? "Remove the second scheme" : "Compare with a second scheme";
  const compare = h("button", { type: "button", id: "compare" }, words);
  compare.onclick = async () => {
    const [first, second] = await presetsFor(state.mode);
    current().other = current().other ? null : planOf(first.name === current().plan.preset ? second : first);
    changed("plan");
  };
  return h("section", {}, h("h2", {}, "Show"), h("div", { class: "checks" }, ...checks.filter(Boolean)),
    state.mode === "curves" ? h("p", {}, compare) : null, tolerance());
}

function tolerance() {
  const { levels } = current();
  const field = h("input", {
    type: "text", id: "tolerance", size: 8, placeholder: "0.01", inputmode: "decimal",
    "data-pointer": "/levels/tolerance",
  });
  field.value = levels?.tolerance ?? "";
  field.onchange = () => {
    const value = Number(field.value);
    current().levels = field.value.trim() === "" ? 4 : { tolerance: Number.isFinite(value) ? value : field.value };
    changed("levels");
  };
  return h("div", { class: "parameter", "data-faults": true },
    h("label", { class: "name", for: "tolerance" }, "Within a tolerance of the limit"), field,
    h("p", { class: "doc" }, "In place of a level: the first one that is provably so close."));
}

function showLevel() {
  const { levels } = current();
  const isNumber = typeof levels === "number";
  const most = stage.mostLevels?.() ?? 8;
  if (Number(at("level").max) !== most) at("level").max = most;
  if (isNumber && Number(at("level").value) !== levels) at("level").value = levels;
  write(at("level-shown"), isNumber ? levels : "≤");
}

function setLevel(level, live = false) {
  const most = Number(at("level").max);
  current().levels = Math.min(Math.max(level, 0), most);
  changed("levels", live);
}

/** Shows all levels one after the other. */
function play() {
  const { levels } = current();
  const last = typeof levels === "number" && levels > 0 ? levels : 5;
  steps += 1;
  const now = steps;
  const next = (level) => {
    if (now !== steps) return;
    setLevel(level, level < last);
    say(`Level ${level}`);
    if (level < last) setTimeout(() => next(level + 1), LEVEL_SHOWN_MS);
  };
  next(0);
}

const writeAddress = settled(ADDRESS_MS, async () => {
  window.history.replaceState(null, "", await fragment());
  await (await import("./given.js")).give();
});

function follow(what, live) {
  if (what === "view") {
    writeAddress();
    return;
  }
  if (what !== "show" && what !== "points") analysis.follow(stage.question());
  if (what === "all" && stage !== stages[state.mode]) open(state.mode);
  if (["all", "plan", "mode"].includes(what) || (["show", "levels"].includes(what) && !live)) under(panel());
  if (what === "points" && !live) {
    stage.refreshTools();
    if (Boolean(at("ends")) === Boolean(current().input.polygon?.closed)) under(panel());
  }
  showLevel();
  stage.update(what, live);
  const { undo: canUndo, redo: canRedo } = history();
  at("undo").disabled = !canUndo;
  at("redo").disabled = !canRedo;
  if (!live) writeAddress();
}

function keys(event) {
  const typing = event.target.closest?.("input:not([type=checkbox]):not([type=range]), select, textarea, dialog");
  if (typing) return;
  const command = event.ctrlKey || event.metaKey;
  if (command && event.key.toLowerCase() === "z") (event.shiftKey ? redo : undo)();
  else if (command) return;
  else if (event.key === "?") openHelp();
  else if (event.key === "[" || event.key === "]") setLevel(Number(at("level").value) + (event.key === "]" ? 1 : -1));
  else if (event.key === "l") play();
  else if (!stage.key(event)) return;
  event.preventDefault();
}

const openHelp = async () => (await import("./help.js")).openHelp();

function wire() {
  at("mode-curves").onclick = () => open("curves").then(() => changed("all"));
  at("mode-surfaces").onclick = () => {
    const isNew = state.surfaces.input.mesh?.positions.length === 0;
    const again = () => open("surfaces").then(() => changed("all"));
    under(isNew ? load("surfaces", examplesOf("surfaces")[0].name) : again()).catch(failed);
  };
  at("examples").onchange = () => at("examples").value
    && under(load(state.mode, at("examples").value)).catch(failed);
  at("undo").onclick = undo;
  at("redo").onclick = redo;
  at("help-open").onclick = openHelp;
  at("take-open").onclick = async () => (await import("./take.js")).openTake(failed);
  at("play").onclick = play;
  at("level").oninput = () => setLevel(Number(at("level").value), true);
  at("level").onchange = () => setLevel(Number(at("level").value));
  at("level-down").onclick = () => setLevel(Number(at("level").value) - 1);
  at("level-up").onclick = () => setLevel(Number(at("level").value) + 1);
  window.addEventListener("keydown", keys);
  window.addEventListener("resize", () => stage.draw());
  window.addEventListener("online", () => stage.update("all"));
  window.addEventListener("hashchange", async () => {
    if (location.hash === await fragment() || !await restore(location.hash)) return;
    await open(state.mode);
    changed("all");
    stage.look();
  });
}

async function begin() {
  wire();
  listen(follow);
  const restored = location.hash.length > 1 && await restore(location.hash).catch(() => false);
  if (restored) {
    await open(state.mode);
    changed("all");
    stage.look();
  } else await load("curves", examplesOf("curves")[0].name);
  setTimeout(() => Promise.all([import("./help.js"), import("./take.js"), import("./surfaces.js")]).catch(() => {}),
    REST_LOADED_MS);
  // for the console: the job that is shown, and its shape as the page has it
  const busy = () => pending > 0 || stage.busy;
  window.planish = { job, shown: () => stage.shown(), stage: () => stage, busy };
}

begin().catch(failed);
