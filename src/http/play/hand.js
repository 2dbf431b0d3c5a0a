// What hands do to a viewer: orbit, pan, zoom, with mouse, fingers and keys.

/** Movement in pixels below which a press is a tap. Half of it makes taps of fingers into drags; twice of it makes
    drags jump. */
const TAP = 5;
/** Degrees that the camera goes around for a pixel: once around for 900 pixels. */
const DEGREES = 0.4;

/**
 * Lets hands move the camera of a viewer. `grip` may take presses: `press(x, y, event)` returns true where it holds
 * something, which then gets `drag(dx, dy, x, y)` and `release(moved)`; `tap(x, y)` is a press that did not move,
 * `hover(x, y)` a mouse that passes.
 */
export function handle(viewer, grip = {}) {
  const { canvas, camera } = viewer;
  const fingers = new Map();
  let held = null;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const span = () => {
    const [[ax, ay], [bx, by]] = [...fingers.values()];
    return { x: (ax + bx) / 2, y: (ay + by) / 2, length: Math.hypot(ax - bx, ay - by) || 1 };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const [x, y] = place(event);
    fingers.set(event.pointerId, [x, y]);
    if (fingers.size === 2) {
      if (held?.gripped) grip.release?.(held.moved);
      held = { pinch: span() };
      return;
    }
    const pans = event.button > 0 || event.shiftKey || event.ctrlKey;
    held = { x, y, from: [x, y], moved: false, pans, gripped: !pans && Boolean(grip.press?.(x, y, event)) };
  });
  canvas.addEventListener("pointermove", (event) => {
    const [x, y] = place(event);
    if (!held || !fingers.has(event.pointerId)) {
      if (event.pointerType === "mouse") grip.hover?.(x, y);
      return;
    }
    fingers.set(event.pointerId, [x, y]);
    if (held.pinch) {
      const now = span();
      camera.zoom(now.length / held.pinch.length);
      camera.pan(now.x - held.pinch.x, held.pinch.y - now.y, canvas.clientHeight);
      held.pinch = now;
      viewer.draw();
      grip.viewed?.();
      return;
    }
    if (!held.moved && Math.hypot(x - held.from[0], y - held.from[1]) < TAP) return;
    const [dx, dy] = [x - held.x, y - held.y];
    Object.assign(held, { x, y, moved: true });
    if (held.gripped) grip.drag(dx, dy, x, y);
    else if (held.pans) camera.pan(dx, -dy, canvas.clientHeight);
    else camera.orbit(dx * DEGREES, dy * DEGREES);
    viewer.draw();
    if (!held.gripped) grip.viewed?.();
  });
  const release = (event) => {
    fingers.delete(event.pointerId);
    const was = held;
    if (fingers.size === 0) held = null;
    if (!was || was.pinch) return;
    if (was.gripped) grip.release?.(was.moved);
    if (!was.moved && event.type === "pointerup") grip.tap?.(...was.from);
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.zoom(Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0012)));
    viewer.draw();
    grip.viewed?.();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-8, 0], ArrowRight: [8, 0], ArrowUp: [0, 8], ArrowDown: [0, -8] }[event.key];
    if (event.ctrlKey || event.metaKey || grip.key?.(event)) return;
    if (turn) camera.orbit(...turn);
    else if (event.key === "+" || event.key === "=") camera.zoom(1.15);
    else if (event.key === "-") camera.zoom(1 / 1.15);
    else return;
    event.preventDefault();
    viewer.draw();
    grip.viewed?.();
  });
}
