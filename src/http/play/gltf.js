// Reads glTF 2.0 as the service writes it: GLB, or a document with buffers beside it, of several levels of detail.

import { MESHOPT, unpacked } from "./meshopt.js";
import { product } from "./space.js";

const TYPES = {
  5120: [Int8Array, 127], 5121: [Uint8Array, 255], 5122: [Int16Array, 32767], 5123: [Uint16Array, 65535],
  5125: [Uint32Array, 1], 5126: [Float32Array, 1],
};
const WIDTHS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const KNOWN = ["KHR_mesh_quantization", "MSFT_lod", MESHOPT];

/** Most bytes of one file or buffer: what a page can hold without being felt. */
const MOST_BYTES = 256 << 20;

/** Signed links of models whose buffers are beside them. */
const SIGNED = /\/v1\/r\/[^/]+\/\d+\/[^/]+\/model\.gltf$/;

async function fetched(url, signal) {
  const answer = await fetch(url, { signal });
  if (!answer.ok) {
    const problem = await answer.json().catch(() => ({}));
    throw new Error(problem.detail ?? `${answer.status} for ${url}`);
  }
  const bytes = await answer.arrayBuffer();
  if (bytes.byteLength > MOST_BYTES) throw new Error(`${url} has ${bytes.byteLength} bytes; the most is ${MOST_BYTES}`);
  // a signed link opens what lies beside it, and no other address of the service
  const beside = SIGNED.test(answer.url) ? "" : answer.headers.get("content-location") ?? "";
  return { bytes, place: new URL(beside, answer.url) };
}

/** The parts of a GLB: its document and its buffer. */
function parted(bytes) {
  const view = new DataView(bytes);
  if (bytes.byteLength < 20 || view.getUint32(0, true) !== 0x46546c67) return null;
  let [document, buffer] = [null, null];
  for (let at = 12; at + 8 <= bytes.byteLength;) {
    const [length, kind] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
    const chunk = bytes.slice(at + 8, at + 8 + length);
    if (kind === 0x4e4f534a) document = JSON.parse(new TextDecoder().decode(chunk));
    else buffer ??= chunk;
    at += 8 + length;
  }
  return { document, buffer };
}

/**
 * Loads a model and hands its levels to `show`, the coarsest first: `{ positions, normals, triangles, color }`, with
 * `level` counting from 0 and `of` levels in all.
 */
export async function load(src, show, signal) {
  const { bytes, place } = await fetched(new URL(src, document.baseURI), signal);
  const glb = parted(bytes);
  const model = glb?.document ?? JSON.parse(new TextDecoder().decode(bytes));
  const unknown = (model.extensionsRequired ?? []).find((name) => !KNOWN.includes(name));
  if (unknown) throw new Error(`the model needs ${unknown}; ask for it with "compression": "none" or "quantize"`);
  const buffers = new Map(glb?.buffer ? [[0, glb.buffer]] : []);
  const levels = levelsOf(model);
  for (const [at, nodes] of levels.entries()) {
    for (const buffer of neededBy(model, nodes)) {
      if (!buffers.has(buffer)) {
        buffers.set(buffer, (await fetched(new URL(model.buffers[buffer].uri, place), signal)).bytes);
      }
    }
    if (signal?.aborted) return;
    show({ ...merged(model, nodes, buffers), level: at, of: levels.length });
  }
}

/** The nodes of each level of detail, the coarsest first; one level where there are no others. */
function levelsOf(model) {
  const roots = model.scenes?.[model.scene ?? 0]?.nodes ?? model.nodes.map((_, at) => at);
  const all = roots.map((root) => [root, ...(model.nodes[root].extensions?.MSFT_lod?.ids ?? [])]);
  const most = Math.max(...all.map((ids) => ids.length));
  const levels = [];
  for (let depth = most - 1; depth >= 0; depth -= 1) {
    levels.push(all.map((ids) => ids[Math.min(depth, ids.length - 1)]));
  }
  return levels;
}

const IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

function matrixOf({ matrix, translation = [0, 0, 0], rotation = [0, 0, 0, 1], scale = [1, 1, 1] }) {
  if (matrix) return matrix;
  const [x, y, z, w] = rotation;
  const [a, b, c] = scale;
  return [
    a * (1 - 2 * (y * y + z * z)), a * 2 * (x * y + z * w), a * 2 * (x * z - y * w), 0,
    b * 2 * (x * y - z * w), b * (1 - 2 * (x * x + z * z)), b * 2 * (y * z + x * w), 0,
    c * 2 * (x * z + y * w), c * 2 * (y * z - x * w), c * (1 - 2 * (x * x + y * y)), 0, ...translation, 1,
  ];
}

/** The primitives below nodes, each with the matrix that places it. */
function* primitives(model, nodes, above = IDENTITY) {
  for (const at of nodes) {
    const node = model.nodes[at];
    const matrix = product(above, matrixOf(node));
    for (const primitive of model.meshes?.[node.mesh]?.primitives ?? []) yield { primitive, matrix };
    yield* primitives(model, node.children ?? [], matrix);
  }
}

/** The stream that a view is decoded from, or the view itself. */
const streamOf = (view) => view.extensions?.[MESHOPT] ?? view;

function neededBy(model, nodes) {
  const needed = new Set();
  for (const { primitive } of primitives(model, nodes)) {
    const { POSITION, NORMAL } = primitive.attributes;
    for (const accessor of [POSITION, NORMAL, primitive.indices]) {
      const view = model.accessors[accessor]?.bufferView;
      if (view !== undefined) needed.add(streamOf(model.bufferViews[view]).buffer);
    }
  }
  return needed;
}

/** The numbers of an accessor, one row behind the other; normalized ones as fractions. */
function numbers(model, at, buffers, make = Float32Array) {
  const { bufferView, byteOffset = 0, componentType, count, type, normalized } = model.accessors[at];
  const view = model.bufferViews[bufferView];
  const [Type, whole] = TYPES[componentType];
  const width = WIDTHS[type];
  const bytes = Type.BYTES_PER_ELEMENT;
  const stride = view.byteStride ?? width * bytes;
  const stream = streamOf(view);
  const isPacked = stream !== view;
  const start = (isPacked ? 0 : view.byteOffset ?? 0) + byteOffset;
  const data = new DataView(isPacked ? unpacked(stream, buffers.get(stream.buffer)) : buffers.get(view.buffer), start);
  const name = `get${Type.name.replace("Array", "")}`;
  const out = new make(count * width);
  for (let row = 0; row < count; row += 1) {
    for (let i = 0; i < width; i += 1) {
      const value = data[name](row * stride + i * bytes, true);
      out[row * width + i] = normalized ? Math.max(value / whole, -1) : value;
    }
  }
  return out;
}

const gamma = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/** All triangles below nodes as one mesh. */
function merged(model, nodes, buffers) {
  const parts = [];
  let color = null;
  for (const { primitive, matrix } of primitives(model, nodes)) {
    if ((primitive.mode ?? 4) !== 4) continue;
    const positions = placed(numbers(model, primitive.attributes.POSITION, buffers), matrix, 1);
    const { NORMAL } = primitive.attributes;
    const normals = NORMAL === undefined ? null : placed(numbers(model, NORMAL, buffers), matrix, 0);
    const triangles = primitive.indices === undefined
      ? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i)
      : numbers(model, primitive.indices, buffers, Uint32Array);
    parts.push({ positions, normals, triangles });
    const factor = model.materials?.[primitive.material]?.pbrMetallicRoughness?.baseColorFactor;
    color ??= factor ? factor.slice(0, 3).map(gamma) : null;
  }
  if (parts.length === 0) throw new Error("the model holds no triangles");
  const sum = (name) => parts.reduce((total, part) => total + part[name].length, 0);
  const [positions, normals] = [new Float32Array(sum("positions")), new Float32Array(sum("positions"))];
  const triangles = new Uint32Array(sum("triangles"));
  let [at, corner] = [0, 0];
  for (const part of parts) {
    positions.set(part.positions, at);
    if (part.normals) normals.set(part.normals, at);
    triangles.set(part.triangles.map((v) => v + at / 3), corner);
    at += part.positions.length;
    corner += part.triangles.length;
  }
  return { positions, normals, triangles, color, faceted: parts.some((part) => !part.normals) };
}

/** Places (w = 1) or directions (w = 0) where a matrix puts them. */
function placed(rows, m, w) {
  for (let at = 0; at < rows.length; at += 3) {
    const [x, y, z] = [rows[at], rows[at + 1], rows[at + 2]];
    for (let i = 0; i < 3; i += 1) rows[at + i] = m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i] * w;
  }
  return rows;
}
