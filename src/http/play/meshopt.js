// Reads the streams of EXT_meshopt_compression that the service writes: rows of attributes, triangles, octahedra.
//
// Source: A. Kapoulkine, glTF extension EXT_meshopt_compression (2021), appendix A: vertex codec version 0, index codec
// version 1, octahedral filter.

export const MESHOPT = "EXT_meshopt_compression";

/** Rows of a group, and most rows of a block. */
const GROUP = 16;
const BLOCK = 256;
/** Bytes of a block at most, and those at the end of a stream at least, which have the row before the first one. */
const BLOCK_BYTES = 8192;
const TAIL = 32;

const unzigzag = (value) => (value & 1 ? ~(value >>> 1) : value >>> 1);

/** The bytes that a stream stands for, given the bytes of its buffer. */
export function unpacked({ byteOffset = 0, byteLength, byteStride, count, mode, filter = "NONE" }, buffer) {
  const stream = new Uint8Array(buffer, byteOffset, byteLength);
  if (mode === "TRIANGLES" && stream[0] === 0xe1) return triangles(stream, count, byteStride).buffer;
  if (mode !== "ATTRIBUTES" || stream[0] !== 0xa0 || !["NONE", "OCTAHEDRAL"].includes(filter)) {
    throw new Error(`streams of ${MESHOPT} in the mode ${mode} with the filter ${filter} are not read here; ask for it `
      + 'with "compression": "none" or "quantize"');
  }
  const rows = attributes(stream, count, byteStride);
  if (filter === "OCTAHEDRAL") octahedra(rows, byteStride);
  return rows.buffer;
}

/** Rows of `stride` bytes, told byte by byte of the row as differences to the row before, in groups of 16. */
function attributes(stream, count, stride) {
  const out = new Uint8Array(count * stride);
  const last = stream.slice(stream.length - stride);
  const most = Math.min(BLOCK_BYTES / stride & ~(GROUP - 1), BLOCK);
  const end = stream.length - Math.max(stride, TAIL);
  let at = 1;
  for (let first = 0; first < count; first += most) {
    const n = Math.min(most, count - first);
    const groups = Math.ceil(n / GROUP);
    for (let byte = 0; byte < stride; byte += 1) {
      const head = at;
      at += Math.ceil(groups / 4);
      for (let group = 0; group < groups; group += 1) {
        if (at > end) throw new Error(`a stream of ${MESHOPT} ends too early`);
        const bits = [0, 2, 4, 8][stream[head + (group >> 2)] >> 2 * (group & 3) & 3];
        const from = at;
        at += bits * 2;
        for (let i = 0; i < GROUP; i += 1) {
          let value = bits === 0 ? 0 : stream[from + (i * bits >> 3)] >> 8 - bits - (i * bits & 7) & (1 << bits) - 1;
          // the largest number of few bits says that the difference follows in a byte of its own
          if ((bits === 2 || bits === 4) && value === (1 << bits) - 1) value = stream[at++];
          const row = group * GROUP + i;
          if (row >= n) continue;
          last[byte] += unzigzag(value);
          out[(first + row) * stride + byte] = last[byte];
        }
      }
    }
  }
  return out;
}

/** Triangles, told by edges and vertices that came before. */
function triangles(stream, count, stride) {
  const out = stride === 2 ? new Uint16Array(count) : new Uint32Array(count);
  const [edges, vertices] = [Array.from({ length: 16 }, () => [0, 0]), new Array(16).fill(0)];
  const table = stream.length - 16;
  let [next, last, at] = [0, 0, 1 + count / 3];
  const index = () => {
    let [value, shift, byte] = [0, 0, 0];
    do {
      if (at > table) throw new Error(`a stream of ${MESHOPT} ends too early`);
      byte = stream[at++];
      value |= (byte & 127) << shift;
      shift += 7;
    } while (byte > 127 && shift < 35);
    last = last + unzigzag(value) >>> 0;
    return last;
  };
  const seen = (vertex) => {
    vertices.unshift(vertex);
    vertices.pop();
  };
  const write = (i, a, b, c, pushed) => {
    out.set([a, b, c], 3 * i);
    edges.unshift(...pushed);
    edges.length = 16;
  };
  for (let i = 0; i < count / 3; i += 1) {
    const [high, low] = [stream[1 + i] >> 4, stream[1 + i] & 15];
    if (high < 15) {
      const [a, b] = edges[high];
      let c = vertices[low];
      if (low === 0) c = next++;
      else if (low === 15) c = index();
      else if (low > 12) c = last = last + (low === 13 ? -1 : 1) >>> 0;
      if (low === 0 || low > 12) seen(c);
      write(i, a, b, c, [[a, c], [c, b]]);
      continue;
    }
    const more = low < 14 ? stream[table + low] : stream[at++];
    if (low >= 14 && more === 0) next = 0;
    const codes = [low === 15 ? 15 : 0, more >> 4, more & 15];
    // numbers are counted first, then taken from those before, then read
    const found = codes.map((code) => (code === 0 ? next++ : vertices[code - 1]));
    if (low >= 14) codes.forEach((code, k) => { if (code === 15) found[k] = index(); });
    codes.forEach((code, k) => { if (code === 0 || (low >= 14 && code === 15)) seen(found[k]); });
    const [a, b, c] = found;
    write(i, a, b, c, [[a, c], [c, b], [b, a]]);
  }
  return out;
}

/** Turns points of an octahedron, of four bytes each, into unit vectors. */
function octahedra(rows, stride) {
  if (stride !== 4) throw new Error(`octahedra of ${stride} bytes are not read here; ask for "quantize"`);
  const signed = new Int8Array(rows.buffer);
  for (let at = 0; at < signed.length; at += 4) {
    let [x, y] = [signed[at], signed[at + 1]];
    const z = signed[at + 2] - Math.abs(x) - Math.abs(y);
    const fold = Math.min(z, 0);
    x += x >= 0 ? fold : -fold;
    y += y >= 0 ? fold : -fold;
    const size = 127 / (Math.hypot(x, y, z) || 1);
    signed.set([Math.round(x * size), Math.round(y * size), Math.round(z * size)], at);
  }
}
