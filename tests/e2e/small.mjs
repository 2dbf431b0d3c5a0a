// Renders examples with each way to make glTF smaller, and loads the files with three.js and the decoder of npm
// meshoptimizer: each triangle is where it is in the plain file, within the error that the file states.
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { MeshoptDecoder } from "meshoptimizer";
import { LoadingManager, Texture, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

// three.js tells the progress of what it fetches as browsers do
globalThis.ProgressEvent ??= class extends Event {};

const [binary, jobs, out] = process.argv.slice(2);
mkdirSync(out, { recursive: true });
const WAYS = {
  plain: {},
  cache: { vertex_order: "cache" },
  quantize: { compression: "quantize" },
  meshopt: { compression: "meshopt" },
};
const LODS = { lod: {}, lod_meshopt: { compression: "meshopt" } };

/** A scene of a file; buffers beside it are read from its folder. */
async function loaded(path) {
  const bytes = readFileSync(path);
  const manager = new LoadingManager().setURLModifier((url) =>
    url.endsWith(".bin") ? `data:;base64,${readFileSync(join(dirname(path), basename(url))).toString("base64")}` : url);
  const loader = new GLTFLoader(manager).setMeshoptDecoder(MeshoptDecoder);
  // pictures are for browsers
  loader.register(() => ({ name: "no pictures", loadTexture: async () => new Texture() }));
  const data = path.endsWith(".glb") ? bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length) : bytes.toString();
  return loader.parseAsync(data, "");
}

/** The corners of all triangles of a scene, where they are in the world, with the name of the group. */
function triangles(gltf) {
  const found = [];
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse((object) => {
    if (!object.isMesh) return;
    const { position, normal } = object.geometry.attributes;
    const index = object.geometry.index;
    for (let i = 0; i < index.count; i += 3) {
      const corners = [0, 1, 2].map((k) => {
        const v = index.getX(i + k);
        const place = new Vector3().fromBufferAttribute(position, v).applyMatrix4(object.matrixWorld);
        return { place, normal: normal && new Vector3().fromBufferAttribute(normal, v).normalize() };
      });
      found.push(corners);
    }
  });
  return found;
}

/** Has each triangle of one list a partner in the other with the same corners, up to an error? */
function compare(name, plain, small, error) {
  if (plain.length !== small.length) throw new Error(`${name}: ${small.length} triangles for ${plain.length}`);
  const side = 16 * error;
  const cell = (p) => [p.x, p.y, p.z].map((x) => Math.floor(x / side));
  const middle = (corners) => corners.reduce((sum, c) => sum.add(c.place), new Vector3()).divideScalar(3);
  const cells = new Map();
  for (const corners of plain) {
    const key = cell(middle(corners)).join();
    if (!cells.has(key)) cells.set(key, []);
    cells.get(key).push(corners);
  }
  const near = (a, b) => ["x", "y", "z"].every((k) => Math.abs(a.place[k] - b.place[k]) <= error);
  let turned = 0;
  for (const corners of small) {
    const [x, y, z] = cell(middle(corners));
    let partner;
    for (let i = 0; i < 27 && !partner; i += 1) {
      const key = [x + (i % 3) - 1, y + (Math.floor(i / 3) % 3) - 1, z + Math.floor(i / 9) - 1].join();
      for (const other of cells.get(key) ?? []) {
        const turn = [0, 1, 2].find((t) => corners.every((corner, k) => near(corner, other[(k + t) % 3])));
        if (turn !== undefined) {
          partner = [0, 1, 2].map((k) => other[(k + turn) % 3]);
          break;
        }
      }
    }
    if (!partner) throw new Error(`${name}: no triangle at ${middle(corners).toArray()} within ${error}`);
    corners.forEach((corner, k) => {
      if (corner.normal) turned = Math.max(turned, (corner.normal.angleTo(partner[k].normal) * 180) / Math.PI);
    });
  }
  return turned;
}

await MeshoptDecoder.ready;
let files = 0;
for (const file of readdirSync(jobs).filter((file) => /-(glb|gltf)\.json$/.test(file))) {
  const job = JSON.parse(readFileSync(join(jobs, file)));
  if (!job.input.mesh || job.input.mesh.frames) continue;
  const name = basename(file, ".json");
  for (const format of ["glb", "gltf"]) {
    let plain;
    // three.js shows the finest level
    const lod = [...new Set([0, job.levels ?? 0])];
    const levels = Object.entries(LODS).map(([way, options]) => [way, { ...options, lod }]);
    for (const [way, options] of [...Object.entries(WAYS), ...(format === "gltf" ? levels : [])]) {
      const path = join(out, `${name}-${way}.${format}`);
      writeFileSync(`${path}.json`, JSON.stringify({ ...job, outputs: [{ format, ...options }] }));
      execFileSync(binary, ["render", `${path}.json`, "-o", path], { stdio: ["ignore", "ignore", "inherit"] });
      const gltf = await loaded(path);
      const all = triangles(gltf);
      plain ??= all;
      const stated = gltf.parser.json.meshes.at(-1).extras?.position_error ?? 0;
      // three.js transforms in f64 what glTF stores in f32, and its attributes are f32
      const size = plain.flat().reduce((most, { place }) => Math.max(most, ...place.toArray().map(Math.abs)), 0);
      const turned = compare(path, plain, all, stated + 1e-6 * size);
      const bytes = readFileSync(path).length;
      console.log(`${basename(path)}: ${bytes} bytes, within ${stated}, normals turn by ${turned.toFixed(2)} degrees`);
      if (turned > 1.3) throw new Error(`${path}: normals turn by ${turned} degrees`);
      files += 1;
    }
  }
}
if (files === 0) throw new Error("no file was compared");
console.log(`${files} files are what they should be in three.js`);
