// Writes every example job as a TypeScript module in which it has to fit the type of jobs.
import { readdir, readFile } from "node:fs/promises";

const folder = "api/examples/jobs";
console.log('import type { components } from "./schema.js";\n');
console.log('export const jobs: Record<string, components["schemas"]["JobRequest"]> = {');
for (const file of (await readdir(folder)).sort()) {
  const job = (await readFile(`${folder}/${file}`, "utf8")).trim();
  console.log(`${JSON.stringify(file.replace(".json", ""))}: ${job},`);
}
console.log("};");
