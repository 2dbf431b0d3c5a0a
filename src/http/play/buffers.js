// Buffers of numbers in WebGL2, and what programs read of them.

/** A buffer of these numbers. */
export function filled(gl, values, target = gl.ARRAY_BUFFER) {
  const buffer = gl.createBuffer();
  // element buffers belong to the vertex array that is bound, so none may be
  gl.bindVertexArray(null);
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, values, gl.DYNAMIC_DRAW);
  return buffer;
}

/** Writes numbers into a buffer, from a place in bytes on. */
export function refill(gl, buffer, values, from = 0) {
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferSubData(gl.ARRAY_BUFFER, from, values);
}

/** Attributes of a program by name, as `[buffer, size, stride, offset]` each, and the indices of what is drawn. */
export function arrayOf(gl, { attributes }, given, indices = null) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [name, [buffer, size, stride = 0, offset = 0]] of Object.entries(given)) {
    if (attributes[name] === undefined) continue;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(attributes[name]);
    gl.vertexAttribPointer(attributes[name], size, gl.FLOAT, false, stride, offset);
  }
  if (indices) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  return array;
}
