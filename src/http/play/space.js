// Vectors and matrices of space, as WebGL has them: matrices by columns.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => scaled(a, 1 / (Math.hypot(...a) || 1));

/** The product of two matrices of 4 by 4. */
export function product(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column += 1) {
    for (let row = 0; row < 4; row += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += a[k * 4 + row] * b[column * 4 + k];
      out[column * 4 + row] = sum;
    }
  }
  return out;
}

/** The box around points that stand one behind the other: its middle, and the radius of the sphere around it. */
export function ball(flat) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let at = 0; at + 2 < flat.length; at += 3) {
    for (let axis = 0; axis < 3; axis += 1) {
      low[axis] = Math.min(low[axis], flat[at + axis]);
      high[axis] = Math.max(high[axis], flat[at + axis]);
    }
  }
  if (low[0] > high[0]) return { middle: [0, 0, 0], radius: 1 };
  return { middle: scaled(add(low, high), 0.5), radius: Math.hypot(...sub(high, low)) / 2 || 1 };
}

/** A camera that goes around a target: angles in degrees, as those of pictures of the service. */
export class Camera {
  azimuth = 35;
  elevation = 25;
  distance = 5;
  target = [0, 0, 0];
  radius = 1;
  fitted = { distance: 5, middle: [0, 0, 0] };
  up = "y";
  /** The vertical angle of view, in degrees. */
  fov = 30;

  /** Where it looks as six numbers: azimuth, elevation, distance, target. */
  get looks() {
    return [this.azimuth, this.elevation, this.distance, ...this.target].map((value) => Number(value.toPrecision(6)));
  }

  set looks([azimuth, elevation, distance, ...target]) {
    Object.assign(this, { azimuth, elevation, distance, target });
  }

  /** The camera of pictures of the service that look from here; what is as it was fitted is left to the service. */
  get ofPictures() {
    const { distance, middle } = this.fitted;
    const camera = {
      azimuth_deg: Math.round(this.azimuth * 10) / 10, elevation_deg: Math.round(this.elevation * 10) / 10,
    };
    const zoom = Number((distance / this.distance).toPrecision(4));
    if (zoom !== 1) camera.zoom = zoom;
    const target = this.target.map((value) => Number(value.toPrecision(6)));
    if (Math.hypot(...sub(this.target, middle)) > 1e-3 * this.radius) camera.target = target;
    return camera;
  }

  /** Looks at a ball so that all of it is seen. */
  fit({ middle, radius }, aspect) {
    this.target = middle;
    this.radius = radius;
    const half = this.fov * Math.PI / 360;
    this.distance = radius * 0.98 / Math.sin(Math.min(half, Math.atan(Math.tan(half) * Math.min(aspect, 1))));
    this.fitted = { distance: this.distance, middle };
  }

  /** The directions to the right, up and towards the eye. */
  get axes() {
    const [a, e] = [this.azimuth * Math.PI / 180, this.elevation * Math.PI / 180];
    const [right, forward, up] = [[Math.cos(a), 0, -Math.sin(a)], [Math.sin(a), 0, Math.cos(a)], [0, 1, 0]];
    const back = add(scaled(forward, Math.cos(e)), scaled(up, Math.sin(e)));
    const turned = this.up === "z" ? ([x, y, z]) => [x, -z, y] : (v) => v;
    return [turned(right), turned(cross(back, right)), turned(back)];
  }

  get eye() {
    return add(this.target, scaled(this.axes[2], this.distance));
  }

  /** The matrix from space to the cube of the screen. */
  matrix(aspect) {
    const [right, up, back] = this.axes;
    const eye = this.eye;
    const view = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const f = 1 / Math.tan(this.fov * Math.PI / 360);
    const near = Math.max(this.distance - 4 * this.radius, this.distance * 0.02);
    const far = this.distance + 6 * this.radius;
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
      2 * far * near / (near - far), 0];
    return product(lens, view);
  }

  /** Goes around the target by so many degrees. */
  orbit(right, up) {
    this.azimuth = (this.azimuth - right) % 360;
    this.elevation = Math.min(Math.max(this.elevation + up, -89), 89);
  }

  /** Comes closer by a factor. */
  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance / factor, this.radius * 0.05), this.radius * 60);
  }

  /** Units of space that a pixel is wide, at so much depth before the eye. */
  pixel(height, depth = this.distance) {
    return 2 * depth * Math.tan(this.fov * Math.PI / 360) / height;
  }

  /** Moves the target by pixels. */
  pan(right, up, height) {
    const size = this.pixel(height);
    const [x, y] = this.axes;
    this.target = add(this.target, add(scaled(x, -right * size), scaled(y, up * size)));
  }
}
