// What the page does: loads what the service answers, shows it, and tells what it saw.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

const WIDTH = 400;
const HEIGHT = 300;

// The part of the pixels that is not the background, and the mean colour of that part, from 0 to 255.
function seen(pixels, background) {
  const sum = [0, 0, 0];
  let n = 0;
  for (let at = 0; at < pixels.length; at += 4) {
    const differs = background.some((value, i) => Math.abs(pixels[at + i] - value) > 8);
    if (differs) {
      n += 1;
      sum.forEach((_, i) => (sum[i] += pixels[at + i]));
    }
  }
  return { share: n / (pixels.length / 4), mean: sum.map((value) => value / Math.max(n, 1)) };
}

// Loads a model as GLTFLoader does, and draws it before a white background.
window.showModel = async (url) => {
  const loader = new GLTFLoader().setCrossOrigin("anonymous").setMeshoptDecoder(MeshoptDecoder);
  const { scene: model } = await loader.loadAsync(url);
  const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true, antialias: true });
  renderer.setSize(WIDTH, HEIGHT);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xffffff);
  const light = new THREE.DirectionalLight(0xffffff, 2);
  light.position.set(1, 2, 3);
  scene.add(model, light, new THREE.AmbientLight(0xffffff, 1.5));
  const box = new THREE.Box3().setFromObject(model);
  const sphere = box.getBoundingSphere(new THREE.Sphere());
  const camera = new THREE.PerspectiveCamera(35, WIDTH / HEIGHT, sphere.radius / 100, sphere.radius * 100);
  camera.position.copy(sphere.center).add(new THREE.Vector3(0.5, 0.4, 1).setLength(sphere.radius * 3.6));
  camera.lookAt(sphere.center);
  renderer.render(scene, camera);
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * WIDTH * HEIGHT);
  gl.readPixels(0, 0, WIDTH, HEIGHT, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const names = [];
  let vertices = 0;
  model.traverse((object) => {
    if (object.name) names.push(object.name);
    if (object.isMesh) vertices += object.geometry.attributes.position.count;
  });
  const size = box.getSize(new THREE.Vector3()).toArray();
  return { ...seen(pixels, [255, 255, 255]), names, vertices, size };
};

// Shows a picture as <img> does, and reads its pixels, which only pictures that the page may read allow.
window.showPicture = async (url, background) => {
  const image = new Image();
  image.crossOrigin = "anonymous";
  image.src = url;
  document.body.replaceChildren(image);
  await image.decode();
  const canvas = new OffscreenCanvas(image.naturalWidth, image.naturalHeight);
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  return { ...seen(data, background), width: canvas.width, height: canvas.height };
};

// Asks, and tells what a page can read of the answer.
window.ask = async (url, options) => {
  const response = await fetch(url, options);
  const body = await response.arrayBuffer();
  return { status: response.status, headers: Object.fromEntries(response.headers), bytes: body.byteLength };
};

// Posts a mesh file as a page does that was given one.
window.post = async (url, text, type) => window.ask(url, { method: "POST", body: new Blob([text], { type }) });

window.ready = true;
