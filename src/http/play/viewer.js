// A viewer of surfaces in WebGL2: a lit surface, lines of any width, dots; a camera that goes around them.

import { Camera, sub, dot, add, scaled, unit } from "./space.js";

const SURFACE = [`#version 300 es
in vec3 position; in vec3 normal; uniform mat4 matrix; out vec3 place; out vec3 n;
void main() { place = position; n = normal; gl_Position = matrix * vec4(position, 1.0); }`, `#version 300 es
precision highp float;
in vec3 place; in vec3 n; uniform vec3 eye, right, up, front, back; uniform bool faceted; out vec4 color;
void main() {
  vec3 sight = normalize(eye - place);
  vec3 m = faceted ? cross(dFdx(place), dFdy(place)) : n;
  m = dot(m, m) > 0.0 ? normalize(m) : sight;
  bool outside = faceted ? true : dot(m, sight) >= 0.0;
  if (faceted && dot(m, sight) < 0.0) m = -m;
  if (!outside) m = -m;
  vec3 side = cross(up, right);
  vec3 key = normalize(right * -0.5 + up * 0.75 - side * 0.7);
  float lit = 0.48 + 0.52 * max(dot(m, key), 0.0) + 0.16 * max(dot(m, normalize(right)), 0.0)
    + 0.06 * dot(m, up);
  float shine = pow(max(dot(reflect(-key, m), sight), 0.0), 36.0) * 0.28;
  float rim = pow(1.0 - max(dot(m, sight), 0.0), 4.0) * 0.12;
  color = vec4((gl_FrontFacing || faceted ? front : back) * lit + shine + rim, 1.0);
}`];

const LINES = [`#version 300 es
in vec2 corner; in vec3 from; in vec3 to; in vec4 tint; uniform mat4 matrix; uniform vec2 size;
uniform float width, lift; out vec4 paint; out float across;
void main() {
  vec4 a = matrix * vec4(from, 1.0), b = matrix * vec4(to, 1.0);
  if (a.w < 0.001 || b.w < 0.001) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  vec2 way = (b.xy / b.w - a.xy / a.w) * size;
  vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
  vec4 p = corner.x < 0.5 ? a : b;
  p.xy += vec2(-along.y, along.x) / size * corner.y * (width + 1.0) * p.w;
  p.z -= lift * p.w;
  paint = tint; across = corner.y * (width + 1.0);
  gl_Position = p;
}`, `#version 300 es
precision highp float;
in vec4 paint; in float across; uniform float width, fade; out vec4 color;
void main() { float edge = clamp(0.5 * (width + 1.0) - 0.5 * abs(across) + 0.25, 0.0, 1.0);
  color = vec4(paint.rgb, paint.a * fade * edge); }`];

const DOTS = [`#version 300 es
in vec3 position; in vec4 tint; in float large; uniform mat4 matrix; uniform float lift, ratio; out vec4 paint;
out float px;
void main() { gl_Position = matrix * vec4(position, 1.0); gl_Position.z -= lift * gl_Position.w; paint = tint;
  px = large * ratio; gl_PointSize = px; }`, `#version 300 es
precision highp float;
in vec4 paint; in float px; uniform float fade; uniform vec3 paper; out vec4 color;
void main() { float r = length(gl_PointCoord - 0.5) * px; float cover = clamp(0.5 * px - r, 0.0, 1.0);
  float ring = clamp(r - 0.5 * px + 2.6, 0.0, 1.0);
  color = vec4(mix(paper, paint.rgb, max(ring, paint.a)), cover * fade); }`];

const WIRES = [`#version 300 es
in vec3 position; uniform mat4 matrix;
void main() { gl_Position = matrix * vec4(position, 1.0); gl_Position.z -= 0.00002 * gl_Position.w; }`, `#version 300 es
precision highp float;
uniform vec4 tint; out vec4 color;
void main() { color = tint; }`];

const CORNERS = new Float32Array([0, -1, 1, -1, 0, 1, 1, 1]);

/** Pixels drawn for one of CSS in each direction while nothing moves, which smooths edges. Half of it has stairs; twice
    of it takes four times as long, which nobody sees. */
const RATIO_AT_REST = 2;
/** How long nothing moves before a picture is drawn finely. Half of it interrupts slow hands; twice of it is seen. */
const REST_MS = 180;
/** Milliseconds between frames above which fewer pixels are drawn while things move, and below which more. */
const SLOW_MS = 28;
const QUICK_MS = 19;
/** Parts of the pixels in each direction that are drawn while things move, and after how many frames of one kind the
    next part is tried: a canvas of another size costs a frame. Half of it swings; twice of it is slow to help. */
const PARTS = [1, 0.7, 0.5, 0.35];
const PATIENCE = 4;

export class Viewer {
  camera = new Camera();
  #gl;
  #programs;
  #corners;
  #surface = null;
  #wires = null;
  #groups = new Map();
  #frame = 0;
  #rest = 0;
  #last = 0;
  #part = 0;
  #slow = 0;
  #before;
  #colors = { front: [0.55, 0.66, 0.86], back: [0.75, 0.6, 0.5], paper: [1, 1, 1], wire: [0.1, 0.16, 0.3, 0.35] };
  faceted = false;
  showsSurface = true;
  showsWires = false;
  /** Frames drawn so far. */
  drawn = 0;

  /** A viewer on a canvas; `before` is called before each frame. Throws where there is no WebGL2. */
  constructor(canvas, before = () => {}) {
    this.canvas = canvas;
    this.#before = before;
    this.#gl = canvas.getContext("webgl2", { antialias: false, alpha: true, premultipliedAlpha: false });
    if (!this.#gl) throw new Error("This browser has no WebGL2, which surfaces are shown by. Curves work without it.");
    this.#start();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.#start();
      this.onrestored?.();
    });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  #start() {
    const programs = { surface: SURFACE, wires: WIRES, lines: LINES, dots: DOTS };
    this.#programs = Object.fromEntries(Object.entries(programs).map(([name, texts]) => [name, this.#program(texts)]));
    this.#corners = this.#buffer(CORNERS);
    this.#surface = this.#wires = null;
    this.#groups.clear();
  }

  #program([vertex, fragment]) {
    const gl = this.#gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "no shader");
    const places = {};
    for (let at = 0; at < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); at += 1) {
      const { name } = gl.getActiveUniform(program, at);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  #buffer(values, target = this.#gl.ARRAY_BUFFER) {
    const buffer = this.#gl.createBuffer();
    this.#fill(buffer, values, target);
    return buffer;
  }

  #fill(buffer, values, target = this.#gl.ARRAY_BUFFER) {
    // element buffers belong to the vertex array that is bound, so none may be
    this.#gl.bindVertexArray(null);
    this.#gl.bindBuffer(target, buffer);
    this.#gl.bufferData(target, values, this.#gl.DYNAMIC_DRAW);
  }

  /** Fills a buffer anew that has as many numbers. */
  #refill(buffer, values) {
    const gl = this.#gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, values);
  }

  #attribute({ program }, name, buffer, size, { stride = 0, offset = 0, each = 0 } = {}) {
    const gl = this.#gl;
    const place = gl.getAttribLocation(program, name);
    if (place < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(place, each);
  }

  /** Sets colours: `front`, `back`, `paper` as three numbers from 0 to 1, `wire` as four. */
  setColors(colors) {
    Object.assign(this.#colors, colors);
    this.draw();
  }

  /** Shows a surface: positions and normals of vertices, triangles by index; `wires` are the ends of its edges. */
  setSurface({ positions, normals, triangles, wires }) {
    const gl = this.#gl;
    const isNew = this.#surface?.triangles !== triangles || this.#surface?.count !== positions.length;
    if (!isNew) {
      this.#refill(this.#surface.positions, positions);
      this.#refill(this.#surface.normals, normals);
      this.draw();
      return;
    }
    this.clearSurface();
    const made = {
      triangles, count: positions.length, n: triangles.length, positions: this.#buffer(positions),
      normals: this.#buffer(normals), indices: this.#buffer(triangles, gl.ELEMENT_ARRAY_BUFFER),
      array: gl.createVertexArray(),
    };
    gl.bindVertexArray(made.array);
    this.#attribute(this.#programs.surface, "position", made.positions, 3);
    this.#attribute(this.#programs.surface, "normal", made.normals, 3);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made.indices);
    gl.bindVertexArray(null);
    this.#surface = made;
    if (wires) this.#wires = { indices: this.#buffer(wires, gl.ELEMENT_ARRAY_BUFFER), n: wires.length };
    this.draw();
  }

  /** Shows no surface. */
  clearSurface() {
    const gl = this.#gl;
    if (this.#surface) {
      for (const name of ["positions", "normals", "indices"]) gl.deleteBuffer(this.#surface[name]);
      gl.deleteVertexArray(this.#surface.array);
    }
    if (this.#wires) gl.deleteBuffer(this.#wires.indices);
    this.#surface = this.#wires = null;
  }

  /** Shows lines: rows of two ends and a colour (10 numbers each), `width` in pixels; drawn faint where hidden. */
  setLines(name, rows, { width = 2, behind = 0.25 } = {}) {
    this.#setGroup(name, "lines", rows, 10, { width, behind });
  }

  /** Shows dots: rows of a place, a colour and a diameter in pixels (8 numbers each). */
  setDots(name, rows, { behind = 0.3, lift = 8e-5 } = {}) {
    this.#setGroup(name, "dots", rows, 8, { behind, lift });
  }

  #setGroup(name, kind, rows, size, options) {
    const values = rows instanceof Float32Array ? rows : new Float32Array(rows);
    const known = this.#groups.get(name) ?? { buffer: this.#gl.createBuffer() };
    this.#groups.set(name, Object.assign(known, { kind, n: values.length / size, ...options }));
    this.#fill(known.buffer, values);
    this.draw();
  }

  /** Draws in the next frame. */
  draw() {
    this.#frame ||= requestAnimationFrame((now) => {
      this.#frame = 0;
      this.#pace(now);
      this.#before();
      this.#draw(Math.min(window.devicePixelRatio || 1, RATIO_AT_REST) * PARTS[this.#part]);
      this.drawn += 1;
      clearTimeout(this.#rest);
      // a machine that is slow already would take seconds for four times the pixels
      const ratio = this.#part === 0 ? RATIO_AT_REST : window.devicePixelRatio || 1;
      this.#rest = setTimeout(() => requestAnimationFrame(() => this.#frame || this.#draw(ratio)), REST_MS);
    });
  }

  /** Draws fewer pixels while frames come slowly, and more again when they come in time. */
  #pace(now) {
    const passed = now - this.#last;
    this.#last = now;
    if (passed > 2000) return;
    if (passed > SLOW_MS) this.#slow = Math.max(this.#slow, 0) + 1;
    else if (passed < QUICK_MS) this.#slow = Math.min(this.#slow, 0) - 0.1;
    if (Math.abs(this.#slow) < PATIENCE) return;
    this.#part = Math.min(Math.max(this.#part + Math.sign(this.#slow), 0), PARTS.length - 1);
    this.#slow = 0;
  }

  get aspect() {
    return (this.canvas.clientWidth || 1) / (this.canvas.clientHeight || 1);
  }

  #draw(ratio) {
    const { canvas } = this;
    const gl = this.#gl;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(...this.#colors.paper, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const matrix = this.camera.matrix(this.aspect);
    if (this.#surface && this.showsSurface) this.#drawSurface(matrix);
    if (this.#wires && this.#surface && this.showsWires) this.#drawWires(matrix);
    // machines that are slow see hidden lines again when nothing moves
    for (const pass of ratio < 0.7 ? ["before"] : ["behind", "before"]) {
      gl.depthMask(pass === "before");
      gl.depthFunc(pass === "before" ? gl.LEQUAL : gl.GREATER);
      for (const group of this.#groups.values()) this.#drawGroup(group, pass, matrix, [width, height], ratio);
    }
    gl.depthMask(true);
    gl.depthFunc(gl.LEQUAL);
  }

  #drawSurface(matrix) {
    const gl = this.#gl;
    const { program, places } = this.#programs.surface;
    const [right, up] = this.camera.axes;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    const vectors = { eye: this.camera.eye, right, up, front: this.#colors.front, back: this.#colors.back };
    for (const [name, value] of Object.entries(vectors)) gl.uniform3fv(places[name], value);
    gl.uniform1i(places.faceted, this.faceted ? 1 : 0);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.bindVertexArray(this.#surface.array);
    gl.drawElements(gl.TRIANGLES, this.#surface.n, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindVertexArray(null);
  }

  /** Edges of all faces, as lines a pixel wide: there may be many. */
  #drawWires(matrix) {
    const gl = this.#gl;
    const { program, places } = this.#programs.wires;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    gl.uniform4fv(places.tint, this.#colors.wire);
    this.#attribute(this.#programs.wires, "position", this.#surface.positions, 3);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.#wires.indices);
    gl.drawElements(gl.LINES, this.#wires.n, gl.UNSIGNED_INT, 0);
  }

  #drawGroup({ kind, buffer, n, width, behind, lift = 8e-5 }, pass, matrix, size, ratio) {
    if (n === 0 || (pass === "behind" && behind === 0)) return;
    const gl = this.#gl;
    const used = this.#programs[kind];
    const { program, places } = used;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    gl.uniform1f(places.lift, pass === "before" ? lift : 0);
    gl.uniform1f(places.fade, pass === "before" ? 1 : behind);
    if (kind === "lines") {
      gl.uniform2fv(places.size, size);
      gl.uniform1f(places.width, width * ratio);
      this.#attribute(used, "corner", this.#corners, 2);
      this.#attribute(used, "from", buffer, 3, { stride: 40, each: 1 });
      this.#attribute(used, "to", buffer, 3, { stride: 40, offset: 12, each: 1 });
      this.#attribute(used, "tint", buffer, 4, { stride: 40, offset: 24, each: 1 });
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, n);
    } else {
      gl.uniform3fv(places.paper, this.#colors.paper);
      gl.uniform1f(places.ratio, ratio);
      this.#attribute(used, "position", buffer, 3, { stride: 32 });
      this.#attribute(used, "tint", buffer, 4, { stride: 32, offset: 12 });
      this.#attribute(used, "large", buffer, 1, { stride: 32, offset: 28 });
      gl.drawArrays(gl.POINTS, 0, n);
    }
    for (let place = 0; place < 8; place += 1) {
      gl.disableVertexAttribArray(place);
      gl.vertexAttribDivisor(place, 0);
    }
  }

  /** Where a point of space is seen: pixels of the canvas, and its depth before the eye. */
  seen(point) {
    const m = this.camera.matrix(this.aspect);
    const [x, y, z] = point;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
    const above = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return [(across + 1) * width / 2, (1 - above) * height / 2, w];
  }

  /** The ray through a pixel: where it begins, and its direction. */
  ray(px, py) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const size = this.camera.pixel(height, 1);
    const [right, up, back] = this.camera.axes;
    const across = add(scaled(right, (px - width / 2) * size), scaled(up, (height / 2 - py) * size));
    return { from: this.camera.eye, way: unit(sub(across, back)) };
  }

  /** How far along the line of sight a point is. */
  depth(point) {
    return dot(sub(this.camera.eye, point), this.camera.axes[2]);
  }
}
