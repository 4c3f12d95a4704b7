// usage: node render.mjs CHARACTER SHOTS.json FOLDER [NAME...]
// Draws a glTF, GLB or VRM character with three.js and three-vrm in headless Chromium. See README.md.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import puppeteer from 'puppeteer-core';

const defaults = {
  width: 640,
  height: 640,
  eye: [0, 1, 4],
  target: [0, 0.9, 0],
  fov: 30,
  background: '#ffffff',
  metresPerUnit: 1,
  picture: true,
  vertices: false,
  lights: {
    direction: [-0.42, 1.0, 0.52],
    key: [0.75, 0.72, 0.68],
    sky: [0.3, 0.33, 0.36],
    ground: [0.2, 0.19, 0.18],
    environment: 'sky over ground',
    shadows: true,
  },
};

const [character, list, folder, ...wanted] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node render.mjs CHARACTER SHOTS.json FOLDER [NAME...]');
  process.exit(2);
}
const { shots, ...common } = JSON.parse(fs.readFileSync(list, 'utf8'));
const here = path.dirname(fileURLToPath(import.meta.url));
const bundle = await build({ entryPoints: [path.join(here, 'page.js')], bundle: true, format: 'iife', write: false, logLevel: 'error' });
const bytes = fs.readFileSync(character).toString('base64');
fs.mkdirSync(folder, { recursive: true });

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  protocolTimeout: 600000,
});
try {
  const page = await browser.newPage();
  page.on('console', (message) => console.error(`page: ${message.text().slice(0, 300)}`));
  await page.setContent('');
  await page.addScriptTag({ content: bundle.outputFiles[0].text });
  await page.evaluate((text) => { window.character = Uint8Array.from(atob(text), (c) => c.charCodeAt(0)); }, bytes);
  for (const [name, own] of Object.entries(shots)) {
    if (wanted.length > 0 && !wanted.includes(name)) continue;
    const options = { ...defaults, ...common, ...own };
    options.lights = { ...defaults.lights, ...common.lights, ...own.lights };
    const { picture, mask, ...rest } = await page.evaluate((o) => window.shoot(window.character, o), options);
    const file = path.join(folder, name);
    if (picture) fs.writeFileSync(`${file}.png`, Buffer.from(picture, 'base64'));
    if (mask) fs.writeFileSync(`${file}.mask.png`, Buffer.from(mask, 'base64'));
    if (rest.meshes) {
      fs.writeFileSync(`${file}.vertices`, Buffer.concat(rest.meshes.map((mesh) => Buffer.from(mesh.positions, 'base64'))));
      for (const mesh of rest.meshes) delete mesh.positions;
    }
    fs.writeFileSync(`${file}.json`, JSON.stringify({ options, ...rest }, null, 1));
  }
} finally {
  await browser.close();
}
