// Renders every example job with the client that openapi-typescript and openapi-fetch make of the OpenAPI document.
import { readFile } from "node:fs/promises";
import createClient from "openapi-fetch";
import { jobs } from "./jobs.js";
import type { components, paths } from "./schema.js";

type Job = components["schemas"]["JobRequest"];

const input: Job["input"] = { polygon: { points: [[0, 0], [1, 0], [1, 1]], closed: true } };

// What the types are to refuse; that they take every example shows when jobs.ts is compiled.
export const refused: Job[] = [
  // @ts-expect-error: a preset that does not exist
  { input, plan: { preset: "chakin" }, levels: 1 },
  // @ts-expect-error: a parameter of another preset
  { input, plan: { preset: "four-point", parameters: { degree: 3 } }, levels: 1 },
  // @ts-expect-error: a parameter of another type
  { input, plan: { preset: "b-spline", parameters: { degree: true } }, levels: 1 },
  // @ts-expect-error: an option of another format
  { input, outputs: [{ format: "obj", width: 100 }] },
  // @ts-expect-error: a choice that an option does not have
  { input, outputs: [{ format: "png", shading: "matte" }] },
  // @ts-expect-error: levels that are no number
  { input, levels: "two" },
];

const first: Record<string, (bytes: Uint8Array) => boolean> = {
  "image/png": (bytes) => bytes[0] === 0x89 && text(bytes.slice(1, 4)) === "PNG",
  "model/gltf-binary": (bytes) => text(bytes.slice(0, 4)) === "glTF",
  "model/ply": (bytes) => text(bytes.slice(0, 4)) === "ply\n",
  "image/svg+xml": (bytes) => text(bytes.slice(0, 5)).startsWith("<"),
  "application/json": (bytes) => typeof JSON.parse(text(bytes)) === "object",
  "model/gltf+json": (bytes) => JSON.parse(text(bytes)).asset.version === "2.0",
};

function text(bytes: Uint8Array): string {
  return new TextDecoder().decode(bytes);
}

function check(holds: boolean, what: string): void {
  if (!holds) {
    throw new Error(what);
  }
}

const client = createClient<paths>({ baseUrl: process.argv[2] ?? "" });
let rendered = 0;
for (const [name, whole] of Object.entries(jobs)) {
  for (const output of whole.outputs ?? []) {
    const body: Job = { ...whole, outputs: [output] };
    const { data, error, response } = await client.POST("/v1/render", { body, parseAs: "arrayBuffer" });
    check(data !== undefined, `${name}: ${error?.detail ?? response.status}`);
    const bytes = new Uint8Array(data as ArrayBuffer);
    const mediaType = response.headers.get("content-type") ?? "";
    check(bytes.length > 0 && (first[mediaType]?.(bytes) ?? true), `${name}: the bytes are no ${mediaType}`);
    const file = (response.headers.get("content-location") ?? "").replace("/v1/artifacts/", "");
    const kept = await client.GET("/v1/artifacts/{file}", { params: { path: { file } }, parseAs: "arrayBuffer" });
    check(Buffer.from(kept.data as ArrayBuffer).equals(Buffer.from(bytes)), `${name}: the artifact has other bytes`);
    const estimate = await client.POST("/v1/estimate", { body });
    // a compressed variant has a tag of its own behind the key
    const tag = response.headers.get("etag") ?? "";
    check(tag.startsWith(`"${estimate.data?.outputs[0]?.key}`), `${name}: the estimate has another key`);
    rendered += 1;
  }
  const { data } = await client.POST("/v1/validate", { body: whole });
  check(data?.valid === true && data.errors.length === 0, `${name}: ${data?.errors[0]?.detail}`);
}
// a mesh file as the body, and the rest of the job in the query
const file = await readFile("api/examples/meshes/nut.obj", "utf8");
const query = { preset: "catmull-clark", levels: 2, format: "glb", "output.compression": "meshopt" } as const;
const posted = await client.POST("/v1/render", {
  params: { query },
  body: file,
  bodySerializer: (text) => text as string,
  headers: { "Content-Type": "model/obj" },
  parseAs: "arrayBuffer",
});
check(text(new Uint8Array(posted.data as ArrayBuffer).slice(0, 4)) === "glTF", `a file: ${posted.error?.detail}`);
const told = await client.POST("/v1/render", {
  body: { input: { text: { format: "obj", data: file } }, plan: { preset: query.preset }, levels: query.levels,
          outputs: [{ format: query.format, compression: "meshopt" }] },
  parseAs: "arrayBuffer",
});
check(told.response.headers.get("etag") === posted.response.headers.get("etag"), "a file has the key of its job");
// batches: a list, and a template with a grid
type Batch = components["schemas"]["BatchRequest"];
const template: Job = { input, plan: { preset: "four-point", parameters: {} }, outputs: [{ format: "svg" }] };
const batches: [Batch, number][] = [
  [{ jobs: [{ ...template, levels: 1 }, { ...template, levels: 3 }] }, 2],
  [{ template, grid: [{ pointer: "/levels", values: [1, 2] },
                      { pointer: "/plan/parameters/w", values: [0, 0.05, "1/16"] }] }, 6],
];
for (const [body, n] of batches) {
  const { data, error } = await client.POST("/v1/batches", { body, params: { header: { Prefer: "wait=60" } } });
  check(data?.state === "done" && data.counts.done === n, `a batch: ${error?.detail ?? JSON.stringify(data)}`);
  const path = { id: data?.id ?? "" };
  const told = await client.GET("/v1/batches/{id}", { params: { path } });
  check(told.data?.items?.length === n, `a batch has ${told.data?.items?.length} items, not ${n}`);
  const zip = await client.GET("/v1/batches/{id}/archive.zip", { params: { path }, parseAs: "arrayBuffer" });
  check(text(new Uint8Array(zip.data as ArrayBuffer).slice(0, 2)) === "PK", `an archive: ${zip.error?.detail}`);
}
const refusal = await client.POST("/v1/render", { body: { input, plan: { word: "X" }, levels: 1 } });
check(refusal.error?.errors?.[0]?.pointer === "/plan/word", "a problem has its type");
const presets = await client.GET("/v1/presets");
const kinds = (presets.data ?? []).flatMap((preset) => preset.parameters.map((parameter) => parameter.kind));
check(kinds.includes("number"), "the catalogue has its types");
check(rendered > 100, `only ${rendered} results`);
console.log(`TypeScript client: ${rendered} results of ${Object.keys(jobs).length} example jobs`);
