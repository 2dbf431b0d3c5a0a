// What the page asks of the service, and how often.

/** A refusal: what is wrong, and the places in the job that it names. */
export class Fault extends Error {
  constructor(detail, errors = [], status = 0) {
    super(detail);
    this.errors = errors;
    this.status = status;
  }
}

const KEY = "planish-key";

/** The key that requests show, where the service has keys; it is forgotten with the tab. */
export const key = () => sessionStorage.getItem(KEY) ?? "";
export const setKey = (text) => sessionStorage.setItem(KEY, text.trim());

/** Asks the service; answers other than success are thrown as faults. */
export async function ask(path, { body, ...options } = {}) {
  const headers = { ...options.headers };
  if (key()) headers.authorization = `Bearer ${key()}`;
  if (body !== undefined && !options.method) options.method = "POST";
  let answer;
  try {
    answer = await fetch(path, { ...options, body, headers });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Fault("The service cannot be reached. What you change is kept here, and follows when it is back.");
  }
  if (answer.ok && answer.status !== 202) return answer;
  const problem = await answer.json().catch(() => ({}));
  if (answer.status === 202) throw new Fault("This takes longer than half a minute; ask for fewer levels.");
  const asksForKey = "This service has keys: type yours under “Download and share”.";
  if (answer.status === 401) throw new Fault(asksForKey, [], 401);
  throw new Fault(problem.detail ?? `The service answers ${answer.status}.`, problem.errors ?? [], answer.status);
}

const json = (value) => ({ body: JSON.stringify(value), headers: { "content-type": "application/json" } });

/** The bytes of a job with this output. */
export const render = (job, output) => ask("/v1/render", json({ ...job, outputs: [output] }));

/** A job as the service answers it in JSON, with the level and the bound that the headers tell. */
export async function refined(job, options = {}) {
  const answer = await render(job, { format: "json", ...options });
  const level = answer.headers.get("planish-level");
  const bound = answer.headers.get("planish-bound");
  const told = { level: level && Number(level), bound: bound && Number(bound) };
  return { ...(await answer.json()), ...told, timing: answer.headers.get("server-timing") };
}

/** What can be said of a scheme. */
export const analysed = async (question) => (await ask("/v1/analyses", json(question))).json();

/** What a file is read with: any plan has the service weld what it would weld before it refines; holes stay faces. */
const READ = "format=json&output.cage=true&levels=0&preset=catmull-clark";

/** The input of a job in a file that the browser has, by the service's readers, and what they warn of. */
export async function meshOf(file) {
  const name = file.name.toLowerCase();
  const reader = (await catalogue("readers")).find(({ extension }) => name.endsWith(`.${extension}`));
  const headers = { "content-type": reader?.media_type ?? "application/octet-stream" };
  if (reader?.name === "json") {
    const told = JSON.parse(await file.text());
    return { input: told.input?.mesh ? told.input : { mesh: told.mesh ?? told }, warnings: [] };
  }
  const answer = await ask(`/v1/render?${READ}`, { body: file, headers });
  const { warnings = [], ...mesh } = await answer.json();
  return { input: { mesh }, warnings };
}

const asked = new Map();

/** A list of the catalogue: presets, operators, formats or readers; asked for once. */
export function catalogue(list) {
  if (!asked.has(list)) {
    const found = ask(`/v1/${list}`).then((answer) => answer.json());
    asked.set(list, found);
    found.catch(() => asked.delete(list));
  }
  return asked.get(list);
}

/** Does one thing at a time: while it is at work, of all that is asked for the latest alone is done next. */
export class Latest {
  #run;
  #failed;
  #next = null;
  #busy = false;

  constructor(run, failed) {
    this.#run = run;
    this.#failed = failed;
  }

  get busy() {
    return this.#busy;
  }

  async ask(...given) {
    this.#next = given;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#next) {
      const now = this.#next;
      this.#next = null;
      try {
        await this.#run(...now);
      } catch (error) {
        this.#failed(error);
      }
    }
    this.#busy = false;
  }
}
