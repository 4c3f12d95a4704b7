/// The page "Try Lorica" in Chromium, from a file server without headers of its own.
/// usage: TRY=<folder of the page> node --test try_test.mjs
import assert from 'node:assert/strict';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import test from 'node:test';
import puppeteer from 'puppeteer-core';
import { makeTube } from './tube.mjs';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.wasm': 'application/wasm' };
const server = http.createServer((request, answer) => {
  const file = path.join(process.env.TRY, request.url === '/' ? 'index.html' : request.url.slice(1));
  if (!fs.existsSync(file)) {
    answer.writeHead(404).end();
    return;
  }
  answer.writeHead(200, { 'Content-Type': types[path.extname(file)] ?? 'text/plain' });
  fs.createReadStream(file).pipe(answer);
}).listen(0, '127.0.0.1');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'lorica-try-'));
const kWait = { timeout: 240000 };

/// Until a file of this name is whole.
const saved = async (name) => {
  const file = path.join(folder, name);
  for (let i = 0; i < 600 && !(fs.existsSync(file) && fs.statSync(file).size > 0); ++i) {
    await new Promise((done) => { setTimeout(done, 100); });
  }
  return fs.readFileSync(file);
};

test('a file is cut, its hulls follow it, balls are thrown, hulls are saved', { timeout: 900000 }, async () => {
  const tube = makeTube(), lines = [];
  for (let v = 0; v < tube.positions.length; v += 3) lines.push(`v ${tube.positions.slice(v, v + 3).join(' ')}`);
  for (let t = 0; t < tube.indices.length; t += 3) lines.push(`f ${tube.indices.slice(t, t + 3).map((i) => i + 1).join(' ')}`);
  fs.writeFileSync(path.join(folder, 'tube.obj'), lines.join('\n'));
  fs.writeFileSync(path.join(folder, 'broken.glb'), 'no model');
  const browser = await puppeteer.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', protocolTimeout: 300000,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--no-first-run'] });
  try {
    const page = await browser.newPage(), errors = [];
    page.on('pageerror', (error) => errors.push(error.message));
    page.on('requestfailed', (request) => errors.push(request.url()));
    await page.setViewport({ width: 640, height: 420 });
    const session = await page.createCDPSession();
    await session.send('Page.setDownloadBehavior', { behavior: 'allow', downloadPath: folder });
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const status = () => page.$eval('#status', (line) => line.textContent);
    const cutInto = (count) => page.waitForFunction((wanted) => document.body.dataset.hulls === wanted, kWait, String(count));
    // The character to begin with: its hulls move.
    await cutInto(16);
    const corner = () => page.evaluate(() => window.firstCorner());
    const before = await corner();
    await page.waitForFunction((old) => String(window.firstCorner()) !== old, kWait, String(before));
    // A mesh of the user's, in fewer parts; cancelled, and cut again.
    await page.evaluate(() => { document.getElementById('parts').value = 5; });
    await (await page.$('#file')).uploadFile(path.join(folder, 'tube.obj'));
    await cutInto(5);
    assert.equal(await status(), 'tube.obj: 5 hulls');
    await page.evaluate(() => { document.getElementById('parts').value = 60; document.getElementById('cut').click(); });
    await page.evaluate(() => document.getElementById('cancel').click());
    await page.waitForFunction(() => document.getElementById('status').textContent === 'tube.obj: cancelled', kWait);
    await page.evaluate(() => { document.getElementById('parts').value = 4; document.getElementById('cut').click(); });
    await cutInto(4);
    await page.click('#throw');
    await page.waitForFunction(() => document.body.dataset.balls === '6', kWait);
    for (const kind of ['obj', 'glb', 'lorica']) await page.click(`#save-${kind}`);
    assert.equal((await saved('tube_hulls.obj')).toString().match(/^o part_/gm).length, 4);
    assert.equal((await saved('tube_hulls.glb')).toString('latin1', 0, 4), 'glTF');
    assert.ok((await saved('tube.lorica')).length > 1000);
    await (await page.$('#file')).uploadFile(path.join(folder, 'broken.glb'));
    await page.waitForFunction(() => document.getElementById('status').textContent.startsWith('broken.glb: '), kWait);
    assert.deepEqual(errors, []);
    // On a phone nothing is wider than the screen.
    await page.setViewport({ width: 390, height: 844, isMobile: true, hasTouch: true });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  } finally {
    await browser.close();
    server.close();
    fs.rmSync(folder, { recursive: true });
  }
});
