// A picture in two layers, so that of a frame that part is drawn which moved: what stays, and all of it.

/** Pixels around what moved that are drawn, too: half of the widest line or dot, and the smoothing of its edge. */
const MARGIN = 10;

export class Layers {
  #gl;
  #size = [0, 0];
  #still = null;
  #whole = null;
  #seen = "";
  /** The pixels that changed since the last frame, as a box; null for none. */
  #changed = null;

  constructor(gl) {
    this.#gl = gl;
  }

  /** Tells where something was, or is, that moves: a place of the picture, 0 to 1 from the left and from below. */
  touch(x, y) {
    const box = this.#changed ??= [1, 1, 0, 0];
    if (x < box[0]) box[0] = x;
    if (y < box[1]) box[1] = y;
    if (x > box[2]) box[2] = x;
    if (y > box[3]) box[3] = y;
  }

  /** Has the next frame be drawn from the beginning. */
  forget() {
    this.#seen = "";
  }

  /**
   * Draws a frame: `still()` what stays, where that is not known any more, and `moving()` the rest, where it changed.
   * `seen` says all that a frame depends on but for what was told by `touch`; `ratio` is the number of pixels of the
   * canvas for one of the page, `isKept` whether the canvas has the last frame.
   */
  draw({ width, height, ratio, seen, isKept }, still, moving) {
    const gl = this.#gl;
    this.#fit(width, height);
    const isKnown = seen === this.#seen;
    if (!isKnown) {
      this.#seen = seen;
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.#still.frame);
      still();
    }
    const all = [0, 0, width, height];
    const box = isKnown ? this.#box(width, height, Math.ceil(MARGIN * ratio)) : all;
    this.#changed = null;
    if (box) {
      this.#copy(this.#still.frame, this.#whole.frame, box, gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.#whole.frame);
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(box[0], box[1], box[2] - box[0], box[3] - box[1]);
      moving();
      gl.disable(gl.SCISSOR_TEST);
    }
    const shown = isKept ? box : all;
    if (shown) this.#copy(this.#whole.frame, null, shown, gl.COLOR_BUFFER_BIT);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  #box(width, height, margin) {
    if (!this.#changed) return null;
    const [left, low, right, high] = this.#changed;
    const within = (value, most) => Math.min(Math.max(value, 0), most);
    const box = [
      within(Math.floor(left * width) - margin, width), within(Math.floor(low * height) - margin, height),
      within(Math.ceil(right * width) + margin, width), within(Math.ceil(high * height) + margin, height),
    ];
    return box[0] < box[2] && box[1] < box[3] ? box : null;
  }

  #copy(from, to, [left, low, right, high], what) {
    const gl = this.#gl;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
    gl.blitFramebuffer(left, low, right, high, left, low, right, high, what, gl.NEAREST);
  }

  #fit(width, height) {
    if (this.#still && this.#size[0] === width && this.#size[1] === height) return;
    this.#size = [width, height];
    this.#seen = "";
    for (const layer of [this.#still, this.#whole]) this.#drop(layer);
    this.#still = this.#layer(width, height);
    this.#whole = this.#layer(width, height);
  }

  #layer(width, height) {
    const gl = this.#gl;
    const layer = { frame: gl.createFramebuffer(), color: gl.createRenderbuffer(), depth: gl.createRenderbuffer() };
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.frame);
    for (const [name, format, place] of [
      ["color", gl.RGBA8, gl.COLOR_ATTACHMENT0], ["depth", gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT],
    ]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, layer[name]);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, layer[name]);
    }
    return layer;
  }

  #drop(layer) {
    if (!layer) return;
    const gl = this.#gl;
    gl.deleteFramebuffer(layer.frame);
    gl.deleteRenderbuffer(layer.color);
    gl.deleteRenderbuffer(layer.depth);
  }
}
