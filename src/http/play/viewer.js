// A viewer of surfaces in WebGL2: a lit surface, lines of any width, dots; a camera that goes around them.

import { Layers } from "./layers.js";
import { Marks } from "./marks.js";
import { Model } from "./model.js";
import { programs } from "./shaders.js";
import { Camera, sub, dot, add, scaled, unit } from "./space.js";

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
  #layers;
  #model;
  #marks;
  #frame = 0;
  #rest = 0;
  #last = 0;
  #slowness = 0;
  #slow = 0;
  #opaque;
  #isLayered = false;
  #colors = { front: [0.55, 0.66, 0.86], back: [0.75, 0.6, 0.5], paper: [1, 1, 1], wire: [0.1, 0.16, 0.3, 0.35] };
  faceted = false;
  showsSurface = true;
  showsWires = false;
  /** The size of the canvas in pixels of the page. */
  size = [0, 0];
  /** Frames drawn so far. */
  drawn = 0;

  /** A viewer on a canvas, through which the page is seen unless it is `opaque`. Throws where there is no WebGL2. */
  constructor(canvas, { opaque = false } = {}) {
    this.canvas = canvas;
    this.#opaque = opaque;
    // the picture is kept, so that of the next one that part is drawn which moved
    const options = { antialias: false, alpha: !opaque, premultipliedAlpha: false, preserveDrawingBuffer: true };
    this.#gl = canvas.getContext("webgl2", options);
    if (!this.#gl) throw new Error("This browser has no WebGL2, which surfaces are shown by. Curves work without it.");
    this.#start();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.#start();
      this.onrestored?.();
    });
    new ResizeObserver(() => {
      this.measure();
      this.draw();
    }).observe(canvas);
  }

  #start() {
    this.#programs = programs(this.#gl);
    this.#layers = new Layers(this.#gl);
    const touch = (...given) => this.#touch(...given);
    this.#model = new Model(this.#gl, this.#programs, this.#layers, touch);
    this.#marks = new Marks(this.#gl, this.#programs, this.#layers, touch);
  }

  /** Sets colours: `front`, `back`, `paper` as three numbers from 0 to 1, `wire` as four. */
  setColors(colors) {
    Object.assign(this.#colors, colors);
    this.#layers.forget();
    this.draw();
  }

  /**
   * Shows a surface: positions and normals of vertices, triangles by index; `wires` are the ends of its edges. With
   * `part` (as of `partOf`) nothing else changed since the last time.
   */
  setSurface({ positions, normals, triangles, wires, part = null }) {
    this.#model.set({ positions, normals, triangles, wires, part });
    this.draw();
  }

  /** Shows no surface. */
  clearSurface() {
    this.#model.clear();
  }

  /** Shows lines: rows of two ends and a colour (10 numbers each), `width` in pixels; drawn faint where hidden. */
  setLines(name, rows, { width = 2, behind = 0.25 } = {}) {
    this.#marks.set(name, "lines", rows, { width, behind });
    this.draw();
  }

  /** Shows dots: rows of a place, a colour and a diameter in pixels (8 numbers each). */
  setDots(name, rows, { behind = 0.3, lift = 8e-5 } = {}) {
    this.#marks.set(name, "dots", rows, { behind, lift });
    this.draw();
  }

  /** Tells the layers of places that change, each the next three of `step` numbers. */
  #touch(rows, step, to, from = 0) {
    const m = this.camera.matrix(this.aspect);
    for (let at = from; at < to; at += step) {
      const [x, y, z] = [rows[at], rows[at + 1], rows[at + 2]];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      // what is behind the eye may be anywhere
      if (!(w > 0)) {
        this.#layers.forget();
        return;
      }
      const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
      const above = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
      this.#layers.touch((1 + across) / 2, (1 + above) / 2);
    }
  }

  /** Draws in the next frame. */
  draw() {
    this.#frame ||= requestAnimationFrame((now) => {
      this.#frame = 0;
      this.#pace(now);
// a part of the surface is drawn soon enough in all its pixels
      const share = this.#model.meshes.moving ? 1 : PARTS[this.#slowness];
      this.#draw(Math.min(window.devicePixelRatio || 1, RATIO_AT_REST) * share, true);
      this.drawn += 1;
      clearTimeout(this.#rest);
      // a machine that is slow already would take seconds for four times the pixels
      const ratio = this.#slowness === 0 ? RATIO_AT_REST : window.devicePixelRatio || 1;
      this.#rest = setTimeout(() => requestAnimationFrame(() => this.#frame || this.#draw(ratio, false)), REST_MS);
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
    this.#slowness = Math.min(Math.max(this.#slowness + Math.sign(this.#slow), 0), PARTS.length - 1);
    this.#slow = 0;
  }

  /** Asks the page for the size of the canvas, which is kept: asking in every frame has the page laid out twice. */
  measure() {
    this.size = [this.canvas.clientWidth, this.canvas.clientHeight];
  }

  get aspect() {
    return (this.size[0] || 1) / (this.size[1] || 1);
  }

  /** Draws a frame; while things move, of a part of the surface that moves alone where that is. */
  #draw(ratio, moves) {
    const { canvas } = this;
    const gl = this.#gl;
    const [width, height] = this.size.map((pixels) => Math.round(pixels * ratio));
    if (width === 0 || height === 0) return;
    const isOther = canvas.width !== width || canvas.height !== height;
    if (isOther) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    const matrix = this.camera.matrix(this.aspect);
    const { still, moving } = this.#model.meshes;
    const under = () => {
      this.#begin();
      if (still) this.#drawMesh(still, matrix);
    };
    const over = () => {
      if (moving) this.#drawMesh(moving, matrix);
      this.#marks.draw({ matrix, size: [width, height], ratio, paper: this.#colors.paper });
    };
    if (moving && moves) {
      const seen = [...matrix, this.faceted, this.showsSurface, this.showsWires, ratio].join();
      this.#layers.draw({ width, height, ratio, seen, isKept: this.#isLayered && !isOther }, under, over);
    } else {
      under();
      over();
    }
    this.#isLayered = Boolean(moving && moves);
  }

  #begin() {
    const gl = this.#gl;
    gl.clearColor(...this.#colors.paper, this.#opaque ? 1 : 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  #drawMesh(mesh, matrix) {
    if (this.showsSurface) this.#drawFaces(mesh, matrix);
    if (this.showsWires) this.#drawWires(mesh, matrix);
  }

  #drawFaces({ faces, n }, matrix) {
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
    gl.bindVertexArray(faces);
    gl.drawElements(gl.TRIANGLES, n, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindVertexArray(null);
  }

  /** Edges of all faces, as lines a pixel wide: there may be many. */
  #drawWires({ lines, nWires }, matrix) {
    const gl = this.#gl;
    const { program, places } = this.#programs.wires;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.matrix, false, matrix);
    gl.uniform4fv(places.tint, this.#colors.wire);
    gl.bindVertexArray(lines);
    gl.drawElements(gl.LINES, nWires, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  }

  /** Where a point of space is seen: pixels of the canvas, and its depth before the eye. */
  seen(point) {
    const m = this.camera.matrix(this.aspect);
    const [x, y, z] = point;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    const across = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w;
    const above = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
    const [width, height] = this.size;
    return [(across + 1) * width / 2, (1 - above) * height / 2, w];
  }

  /** The ray through a pixel: where it begins, and its direction. */
  ray(px, py) {
    const [width, height] = this.size;
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
