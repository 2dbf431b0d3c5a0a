// What can be said of the scheme, beside the picture and live: mask, smoothness, matrices of the step.

import { h, settled, short } from "./dom.js";
import { analysed } from "./service.js";

/** How long a plan stays as it is before it is analysed. Half of it asks twice as often while a slider moves; twice of
    it is felt as waiting. */
const CALM_MS = 160;

/** The section of the panel, and the function that has it follow a plan. */
export function analysisSection() {
  const body = h("div", { id: "analysis" });
  const badge = h("span", { class: "badge", id: "verdict" }, "…");
  const section = h("section", {}, h("h2", {}, "What can be said", badge), body);
  let opened = false;
  let asked = "";
  const follow = settled(CALM_MS, async (question) => {
    const now = JSON.stringify(question);
    if (now === asked) return;
    asked = now;
    try {
      const answer = await analysed(question);
      if (now !== asked) return;
      badge.className = "badge good";
      badge.textContent = verdict(answer);
      const details = answer.kind === "curve" ? ofCurve(answer) : ofSurface(answer);
      body.replaceChildren(...details);
      const matrices = body.querySelector("details");
      if (matrices) {
        matrices.open = opened;
        matrices.ontoggle = () => { opened = matrices.open; };
      }
    } catch (fault) {
      if (now !== asked) return;
      asked = "";
      badge.className = "badge";
      badge.textContent = "not analysed";
      body.replaceChildren(h("p", { class: "doc" }, fault.message));
    }
  });
  return { section, follow };
}

/** How smooth limits are, in a few words. */
function verdict(answer) {
  const about = answer.kind === "curve" ? answer.smoothness ?? answer.conclusion : answer.regular.smoothness;
  const { proved_c: proved, disproved_c: disproved } = about ?? {};
  if (proved === undefined) return "see below";
  if (proved < 0) return disproved === 0 ? "does not converge" : "not proved to converge";
  const exactly = disproved === proved + 1 ? "exactly " : "";
  return `${exactly}C${superscript(proved)}`;
}

const superscript = (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit] ?? String(digit);

function fact(name, value) {
  return value === undefined || value === null || value === "" ? [] : [h("dt", {}, name), h("dd", {}, value)];
}

const facts = (...pairs) => h("dl", { class: "facts" }, ...pairs.flat());

const interval = ([low, high]) => (short(high - low) === "0" ? short(low) : `${short(low)} to ${short(high)}`);

function maskList({ first, values, exact }) {
  const entries = exact ?? values.map((value) => short(value));
  return h("ol", { class: "mask", "aria-label": "Mask" }, entries.map((entry, at) => (
    h("li", { class: first + at === 0 ? "zero" : "", title: `entry ${first + at}` }, entry))));
}

function ofCurve(answer) {
  const level = answer.levels?.[0];
  const about = answer.static_limit ?? answer;
  const mask = answer.mask ?? level?.mask;
  const { smoothness } = about;
  return [
    mask ? h("h3", {}, level ? "Mask of the first level" : "Mask") : null, mask ? maskList(mask) : null,
    facts(
      fact("Limits are", answer.conclusion ? proof(answer.conclusion) : smoothness ? proof(smoothness) : ""),
      fact("Hölder exponent", smoothness?.holder ? interval(smoothness.holder) : ""),
      fact("Support", about.support ? `${about.support.map((end) => short(end)).join(" to ")}` : ""),
      fact("Makes polynomials", about.generation_degree >= 0 ? `up to degree ${about.generation_degree}` : ""),
      fact("Reproduces", about.reproduction_degree >= 0 ? `up to degree ${about.reproduction_degree}` : ""),
      fact("Eigenvalues", about.local_eigenvalues?.slice(0, 5).map((value) => short(value)).join(", ")),
      fact("By", answer.conclusion?.theorem),
    ),
    about.limit_mask ? h("h3", {}, "Weights of a limit point") : null,
    about.limit_mask ? maskList(about.limit_mask) : null,
    answer.matrices ? matrices(answer.matrices) : null,
  ].filter(Boolean);
}

function proof({ proved_c: proved, disproved_c: disproved }) {
  const yes = proved < 0 ? "not proved to exist" : `C${superscript(proved)}, proved`;
  return disproved === null || disproved === undefined ? yes : `${yes}; not C${superscript(disproved)}`;
}

function matrices({ points, steps, product }) {
  const named = [...steps.map(({ operator, name, matrix }) => ({ title: `${operator}: ${name}`, matrix })),
    { title: "One step: their product", matrix: product }];
  return h("details", { class: "doc", id: "matrices" }, h("summary", {}, `Matrices of one step on ${points} points`),
    ...named.filter(({ matrix }) => matrix).flatMap(({ title, matrix }) => [h("h3", {}, title), table(title, matrix)]));
}

function table(title, { rows, exact }) {
  const body = rows.map((row, i) => h("tr", {}, row.map((value, j) => (
    h("td", { class: value === 0 ? "none" : "" }, value === 0 ? "·" : exact?.[i]?.[j] ?? short(value))))));
  return h("div", { class: "matrix-box", tabindex: "0", role: "region", "aria-label": title },
    h("table", { class: "matrix" }, h("tbody", {}, body)));
}

function ofSurface({ regular, valences = [], assumptions = [] }) {
  const rows = valences.map(({ valence, c1, subdominant_ratio: ratio, limit_mask: mask, eigenvalues }) => h("tr", {},
    h("td", {}, valence), h("td", {}, c1), h("td", {}, short(eigenvalues?.[1]?.value ?? NaN)),
    h("td", {}, short(ratio)),
    h("td", {}, mask?.center === undefined ? "" : short(mask.center))));
  const names = ["valence", "C¹", "eigenvalue", "ratio", "centre"];
  return [
    facts(
      fact("Regular parts", proof(regular.smoothness)), fact("by", regular.smoothness.by),
      fact("Support", regular.support?.map((side) => side.join(" to ")).join(" by ")),
      fact("Reproduces", `up to degree ${regular.reproduction_degree}`),
    ),
    rows.length > 0 ? h("h3", {}, "Extraordinary vertices") : null,
    rows.length > 0 ? h("div", { class: "matrix-box", tabindex: "0", role: "region", "aria-label": "Valences" },
      h("table", { class: "matrix", id: "valences" },
        h("thead", {}, h("tr", {}, names.map((name) => h("th", {}, name)))), h("tbody", {}, rows))) : null,
    ...assumptions.slice(0, 2).map((text) => h("p", { class: "doc" }, text)),
  ].filter(Boolean);
}
