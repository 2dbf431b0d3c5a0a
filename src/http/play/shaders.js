// The programs of the viewer: what is drawn at each vertex and each pixel.

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
in vec3 from; in vec3 to; in vec4 tint; in vec2 corner; uniform mat4 matrix; uniform vec2 size;
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

const TEXTS = { surface: SURFACE, wires: WIRES, lines: LINES, dots: DOTS };

/** All programs by name, each with the places of its uniforms and of its attributes. */
export function programs(gl) {
  return Object.fromEntries(Object.entries(TEXTS).map(([name, texts]) => [name, made(gl, texts)]));
}

function made(gl, [vertex, fragment]) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "no shader");
  const [places, attributes] = [{}, {}];
  for (let at = 0; at < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); at += 1) {
    const { name } = gl.getActiveUniform(program, at);
    places[name] = gl.getUniformLocation(program, name);
  }
  for (let at = 0; at < gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); at += 1) {
    const { name } = gl.getActiveAttrib(program, at);
    attributes[name] = gl.getAttribLocation(program, name);
  }
  return { program, places, attributes };
}
