// Plays with the page /play as people do: every control, by mouse, fingers and keys; what it shows has to be what the
// service answers. Screenshots go into a folder.
//
//     node play.mjs BINARY SCREENSHOTS [ORIGIN]      ORIGIN: a service that runs already
import { launch, startService } from "./service.mjs";
import { checkCurves } from "./play-curves.mjs";
import { checkElement } from "./play-element.mjs";
import { checkSurfaces } from "./play-surfaces.mjs";
import { checkTaking } from "./play-taking.mjs";
import { checkFirstPicture, checkFrames, checkParts, checkTouch, screenshots } from "./play-whole.mjs";

const [binary, folder, running] = process.argv.slice(2);
const started = Date.now();
const { service, origin } = running ? { origin: running } : await startService(binary);
// the page is drawn as by machines without a graphics processor; curves are not to be drawn by an emulated one
const browser = await launch("--disable-gpu-rasterization");
try {
  const told = [];
  const only = process.env.PLAY_ONLY?.split(",");
  const checks = {
    checkFirstPicture, checkCurves, checkTaking, checkSurfaces, checkElement, checkTouch, checkParts, checkFrames,
    screenshots,
  };
  for (const [name, check] of Object.entries(checks)) {
    if (only && !only.includes(name)) continue;
    told.push(await check({ browser, origin, folder, binary }));
  }
  const seconds = (Date.now() - started) / 1000;
  console.log(`play: ${told.filter(Boolean).join("; ")}, in ${seconds} s`);
} finally {
  await browser.close();
  service?.kill("SIGTERM");
}
