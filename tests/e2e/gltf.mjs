// Judges glTF files with the Khronos validator; fails on the first file with an error or a warning, and says why.
import { readFile } from "node:fs/promises";
import { basename, dirname, join } from "node:path";
import validator from "gltf-validator";

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("no file to judge");
  process.exit(1);
}
let faulty = 0;
let notes = 0;
for (const file of files) {
  const beside = async (uri) => new Uint8Array(await readFile(join(dirname(file), uri)));
  const options = { uri: basename(file), maxIssues: 100, externalResourceFunction: beside };
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), options);
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  notes += numInfos + numHints;
  if (numErrors + numWarnings > 0) {
    faulty += 1;
    console.error(`${file}: ${numErrors} errors, ${numWarnings} warnings`);
    for (const issue of messages.filter((issue) => issue.severity <= 1)) {
      console.error(`  ${issue.code} ${issue.pointer ?? ""}: ${issue.message}`);
    }
  }
}
console.log(`glTF validator ${validator.version()}: ${files.length} files, ${faulty} with errors or warnings, ${notes} notes`);
process.exit(faulty > 0 ? 1 : 0);
