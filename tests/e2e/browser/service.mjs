// A service and a browser for tests of pages.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createServer as createSocket } from "node:net";
import { chromium } from "playwright-core";

// A port that nobody listens on.
async function freePort() {
  const socket = createSocket();
  await new Promise((resolve) => socket.listen(0, "127.0.0.1", resolve));
  const { port } = socket.address();
  await new Promise((resolve) => socket.close(resolve));
  return port;
}

// Starts a service that keeps nothing in memory.
export async function startService(binary, ...more) {
  const port = await freePort();
  const given = ["serve", "--listen", `127.0.0.1:${port}`, "--cache-bytes", "0", ...more];
  const service = spawn(binary, given, { stdio: "ignore" });
  const origin = `http://127.0.0.1:${port}`;
  for (let left = 200; ; left -= 1) {
    if (await fetch(`${origin}/livez`).then((answer) => answer.ok, () => false)) return { service, origin };
    assert(left > 0 && service.exitCode === null, "the service does not start");
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

// Starts Chromium. Pictures are drawn by software, so that they are the same on every machine; root has no sandbox.
export async function launch(...more) {
  const root = process.getuid?.() === 0 ? ["--no-sandbox"] : [];
  const args = [...root, "--use-angle=swiftshader", "--enable-unsafe-swiftshader", ...more];
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
}
