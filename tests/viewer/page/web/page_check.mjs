// usage: node page_check.mjs URL OUTFOLDER
// Drives the page of `lorica serve` in headless Chromium: pictures of it, dragging, throwing, VR. Prints JSON, which is also
// OUTFOLDER/result.json. Run it where `npm install puppeteer-core iwer` was done, or from a file there. CHROMIUM = path of
// the browser, PARTS = of the list at the end, to run fewer.
// It waits for states of the page, never for a time; what does not come within some minutes is an error.
import fs from 'node:fs';
import http from 'node:http';
import https from 'node:https';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [url, folder] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node page_check.mjs URL OUTFOLDER');
  process.exit(2);
}
const own = path.dirname(fileURLToPath(import.meta.url)),
  installed = fs.existsSync(path.join(own, 'node_modules')) ? own : process.cwd();
const require = createRequire(path.join(installed, 'package.json'));
const { default: puppeteer } = await import(pathToFileURL(require.resolve('puppeteer-core')));
fs.mkdirSync(folder, { recursive: true });

const kDesktop = { width: 1280, height: 720 },
  kSmall = { width: 640, height: 360 },
  kPhone = { width: 390, height: 844, hasTouch: true, isMobile: true };
const kWait = { timeout: 500000, polling: 50 };
const result = { errors: [], outside: [] };

const browser = await puppeteer.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: [
    '--no-sandbox',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
    '--ignore-gpu-blocklist',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--ignore-certificate-errors',
    '--host-resolver-rules=MAP plain.test 127.0.0.1',
  ],
  protocolTimeout: 600000,
});

/// @param quality  high where pictures are looked at: each is drawn without a GPU
async function open(size, { before, layers = { hulls: false }, query = '', quality = 'low' } = {}) {
  const context = await browser.createBrowserContext(),
    page = await context.newPage();
  page.on('pageerror', (error) => result.errors.push(error.message));
  page.on('console', (message) => {
    if (message.type() === 'error') result.errors.push(message.text());
  });
  page.on('request', (request) => {
    // nothing may leave the origin
    const to = request.url();
    if (!/^(blob|data):/.test(to) && new URL(to).host !== new URL(url).host) result.outside.push(to);
  });
  await page.setViewport(size);
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'light' }]);
  const choices = JSON.stringify({ quality, layers });
  await page.evaluateOnNewDocument((kept) => {
    try {
      localStorage.setItem('lorica', kept);
    } catch {
      /* about:blank */
    }
  }, choices);
  if (before) await page.evaluateOnNewDocument(before);
  await page.goto(url.replace(/(#|$)/, `${query}$1`), kWait);
  await until(
    page,
    () => window.loricaPage?.avatars.length > 0 && window.loricaPage.avatars.every((a) => a.loaded || a.failed),
  );
  await drawn(page);
  return page;
}
const until = (page, condition, ...values) =>
  page.waitForFunction(condition, kWait, ...values).catch((error) => {
    throw new Error(`${error.message}, for ${condition}`);
  });
/// Until the page has drawn twice what came since now; of a paused session, the next step.
async function drawn(page) {
  const { frames, pictures, paused } = await page.evaluate(() => ({
    frames: loricaPage.frames,
    pictures: loricaPage.pictures,
    paused: loricaPage.controls.pause?.value === true,
  }));
  if (paused) await page.keyboard.press('n');
  const enough = pictures + (paused ? 1 : 2);
  await until(page, (f, p) => loricaPage.frames > f && loricaPage.pictures >= p, frames, enough);
}
const shot = (page, name) => page.screenshot({ path: path.join(folder, `${name}.png`) });
const see = (page) => page.evaluate(() => JSON.parse(JSON.stringify(window.loricaPage)));
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
/// Steps of a paused session until something is so: neither depends on how quick the machine is.
async function steps(page, condition, ...values) {
  for (let step = 0; step < 200; ++step) {
    const is = await page.evaluate(condition, ...values);
    if (is) return is;
    await drawn(page);
  }
  throw new Error(`200 steps are not enough for ${condition}`);
}
/// How far a prop is from a place, if it is farther than so.
const away = (index, from, least) => {
  const moved = Math.hypot(...loricaPage.props[index].position.map((v, k) => v - from[k]));
  return moved > least ? moved : 0;
};
async function pause(page, on) {
  if ((await see(page)).controls.pause.value !== on) await page.keyboard.press(' ');
  await until(page, (is) => loricaPage.controls.pause.value === is, on);
}
/// The loose prop nearest to the middle that can be pressed, and where. It has to rest: of others the page may be a frame
/// behind. @param before  positions of all props a step ago @return [index, [x, y]]
const loose = (page, before) =>
  page.evaluate((old) => {
    const rests = ({ position, fixed }, i) => !fixed && Math.hypot(...position.map((v, k) => v - old[i][k])) < 0.002;
    const list = loricaPage.props.map((prop, index) => [index, rests(prop, index) ? loricaPage.screenOf(index) : null]);
    const away = ([, [x, y]]) => Math.hypot(x - innerWidth / 2, y - innerHeight / 2);
    return (
      list
        .filter(([, at]) => at && document.elementFromPoint(...at)?.id === 'view')
        .sort((a, b) => away(a) - away(b))[0] ?? null
    );
  }, before);

async function scheme(page, value) {
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value }]);
  await drawn(page);
}

async function play(page) {
  await until(page, () => loricaPage.state !== null && loricaPage.controls.pause);
  await page.keyboard.press(' ');
  await until(page, () => loricaPage.controls.pause.value);
  const { state } = await see(page);
  await shot(page, 'desktop_paused');
  result.play = { pausedAt: state.seconds };
  if (state.duration > 0) {
    await page.keyboard.press('Home');
    await until(page, (before) => loricaPage.state.seconds < Math.max(before, 0.2), state.seconds);
    result.play.restartedAt = (await see(page)).state.seconds;
  }
  await pause(page, false);
}

/// From now on the camera is the user's: the page does not move it back to show the whole avatar. A wheel does not swing on.
async function zoom(page) {
  const { camera } = await see(page);
  await page.mouse.move(60, 330);
  await page.mouse.wheel({ deltaY: -300 });
  await until(page, (from) => Math.hypot(...loricaPage.camera.map((v, k) => v - from[k])) > 0.1, camera);
  for (let last = null, now = camera; !last || distance(now, last) > 0; now = (await see(page)).camera) {
    last = now;
    await drawn(page);
  }
}

async function drag(page) {
  await until(page, () => loricaPage.props.every((prop) => prop.visible));
  await zoom(page);
  const positions = (await see(page)).props.map(({ position }) => position);
  await drawn(page);
  const found = await loose(page, positions);
  if (!found) {
    result.drag = { none: true };
    return;
  }
  const [, [x, y]] = found;
  const { camera } = await see(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await until(page, () => loricaPage.held >= 0);
  const { held, props } = await see(page);
  const before = props[held].position;
  for (let i = 1; i <= 12; ++i) await page.mouse.move(x - 8 * i, y - 12 * i);
  const moved = await steps(page, away, held, before, 0.15);
  await shot(page, 'desktop_drag');
  const after = await see(page);
  await page.mouse.up();
  await until(page, () => loricaPage.held === -1);
  result.drag = { index: held, moved, cameraMoved: distance(after.camera, camera) };

  // A drag beside all props orbits.
  const free = [60, 330];
  await page.mouse.move(...free);
  await page.mouse.down();
  await page.mouse.move(free[0] + 40, free[1], { steps: 4 });
  await page.mouse.up();
  await until(page, (from) => Math.hypot(...loricaPage.camera.map((v, k) => v - from[k])) > 0.1, camera);
  result.drag.orbits = true;
}

/// Begins a recording, or ends it. @return the name of its file, as it was before
async function record(page, on) {
  const { recording } = (await see(page)).state;
  await page.evaluate((label) => {
    const button = [...document.querySelectorAll('#panel button')].find((b) => b.textContent === label);
    if (button.disabled) throw new Error(button.title);
    button.click();
  }, on ? 'record from the start' : 'end the recording');
  await until(page, (wanted) => Boolean(loricaPage.state.recording) === wanted, on);
  await until(page, () => loricaPage.avatars.every((a) => a.loaded));
  return recording;
}

/// A video of some pictures, which is saved and which a browser shows: its size, how long it is, and how many colours are in it.
async function video(page) {
  const file = path.join(folder, 'lorica-001.webm'),
    browsers = await page.createCDPSession();
  fs.rmSync(file, { force: true });
  await browsers.send('Browser.setDownloadBehavior', {
    behavior: 'allow',
    browserContextId: page.browserContext().id,
    downloadPath: path.resolve(folder),
  });
  await page.keyboard.press('v');
  for (let i = 0; i < 3; ++i) await drawn(page);
  await shot(page, 'desktop_video');
  await page.keyboard.press('v');
  await until(page, () => loricaPage.videos === 1);
  while (!fs.existsSync(file)) await drawn(page);
  const other = await (await browser.createBrowserContext()).newPage();
  const shown = await other.evaluate(async (text) => {
    const film = document.createElement('video');
    film.muted = true;
    film.src = `data:video/webm;base64,${text}`;
    await film.play();
    await new Promise((resolve) => film.addEventListener('ended', resolve));
    const picture = new OffscreenCanvas(film.videoWidth, film.videoHeight).getContext('2d');
    picture.drawImage(film, 0, 0);
    const { data } = picture.getImageData(0, 0, film.videoWidth, film.videoHeight);
    const colors = new Set(new Uint32Array(data.buffer)).size;
    return { size: [film.videoWidth, film.videoHeight], seconds: film.currentTime, colors };
  }, fs.readFileSync(file).toString('base64'));
  await other.close();
  const canvas = await page.evaluate(() => [document.getElementById('view').width, document.getElementById('view').height]);
  result.video = { ...shown, canvas };
}

async function throwBall(page) {
  const { props, controls } = await see(page);
  if (controls.throw.no) {
    result.throw = { cannot: controls.throw.no };
    return;
  }
  await page.click('#bar button[aria-label="Throw a ball"]');
  await steps(page, (count) => loricaPage.props.length > count && loricaPage.props.at(-1).visible, props.length);
  const thrown = (await see(page)).props.at(-1).position;
  await steps(page, away, props.length, thrown, 0.3);
  await shot(page, 'desktop_throw');
  result.throw = { props: [props.length, (await see(page)).props.length] };
}

/// Until the avatar is wholly in what panels leave free, in its middle, and fills it.
async function framed(page) {
  await until(page, () => {
    const { avatar, free } = loricaPage.framed,
      [width, height] = [free[2] - free[0], free[3] - free[1]];
    const off = [0, 1].map((i) => Math.abs(avatar[i] + avatar[i + 2] - free[i] - free[i + 2]) / 2);
    const inside = [0, 1].every((i) => avatar[i] >= free[i] && avatar[i + 2] <= free[i + 2]);
    const fills = Math.max((avatar[2] - avatar[0]) / width, (avatar[3] - avatar[1]) / height);
    return inside && fills > 0.4 && off[0] < 0.12 * width && off[1] < 0.12 * height;
  });
  return (await see(page)).framed;
}

const parts = {
  async desktop() {
    const page = await open(kDesktop, { quality: 'high' });
    result.framed = await framed(page);
    await shot(page, 'desktop_light');
    const { frames, avatars, props, run, problems, quality, state } = await see(page);
    result.desktop = { frames, avatars, props: props.length, run, problems, quality, title: state?.title };
    await scheme(page, 'dark');
    await shot(page, 'desktop_dark');
    await scheme(page, 'light');
    await page.focus('#view');
    await page.keyboard.press('2');
    await drawn(page);
    await shot(page, 'desktop_hulls');
    await page.keyboard.press('2');
    await page.keyboard.press('h');
    await shot(page, 'desktop_help');
    result.helpFits = await page.$eval('#help', (help) => help.open && help.scrollHeight <= help.clientHeight);
    await page.keyboard.press('h'); // closes what it opened
    result.helpStays = await page.$eval('#help', (help) => help.open);
    await page.select('#panel select:has(option[value=automatic])', 'low');
    await page.focus('#view');
    await page.keyboard.press('f'); // the camera stays
    await video(page);
    await play(page);
    await record(page, true);
    await pause(page, true);
    await drag(page);
    await throwBall(page);
    result.recorded = await record(page, false);
    await page.close();
  },

  /// Pictures of all scenes of a server that goes on to the next one when it is asked to restart.
  async scenes() {
    const page = await open(kSmall, { layers: { hulls: true, depth: false }, quality: 'high' });
    result.scenes = [];
    for (let run = 0; ; ) {
      const index = result.scenes.length;
      await until(page, (i, before) => loricaPage.controls.scene?.value === i && loricaPage.run !== before, index, run);
      await page.evaluate(() => loricaPage.picture(['character', 'hulls', 'props', 'contacts', 'particles'], 'light'));
      await drawn(page);
      await until(page, () => loricaPage.particles.all > 0 || loricaPage.controls.scene.choices[loricaPage.controls.scene.value] !== 'sand');
      await until(page, () => [...loricaPage.avatars, ...loricaPage.props].every((a) => a.painted > 0 || a.visible));
      await drawn(page);
      const { controls, particles } = await see(page);
      run = (await see(page)).run;
      for (const [name, layers, background = 'transparent'] of [
        ['whole', ['character', 'props', 'particles', 'ground'], 'light'],
        ['character', ['character']],
        ['props', ['props']],
        ['particles', ['particles']],
        ['hulls', ['hulls']],
        ['contacts', ['contacts']],
      ]) {
        const png = await page.evaluate(
          async (l, b) => [...new Uint8Array(await (await loricaPage.picture(l, b)).arrayBuffer())],
          layers,
          background,
        );
        fs.writeFileSync(path.join(folder, `scene_${index}_${name}.png`), Buffer.from(png));
      }
      result.scenes.push({ name: controls.scene.choices[index], particles });
      if (index + 1 === controls.scene.choices.length) break;
      await page.keyboard.press('Home');
    }
    await page.close();
  },

  /// Pictures of the character alone: without an expression, then with each that E chooses.
  async expressions() {
    const page = await open({ width: 480, height: 540 }, { layers: { hulls: false, depth: false }, quality: 'high' });
    await until(page, () => loricaPage.controls.expression?.choices.length > 0);
    const expressions = (await see(page)).controls.expression.choices;
    result.expressions = ['none', ...expressions];
    for (let e = -1; e < expressions.length; ++e) {
      if (e >= 0) await page.keyboard.press('e');
      await until(page, (chosen) => loricaPage.controls.expression.value === chosen, e);
      await drawn(page);
      const png = await page.evaluate(async () => [
        ...new Uint8Array(await (await loricaPage.picture(['character'], 'transparent')).arrayBuffer()),
      ]);
      fs.writeFileSync(path.join(folder, `expression_${e + 1}.png`), Buffer.from(png));
    }
    await page.close();
  },

  /// Opens each of FILES: by the button, by its key, by dropping; then what cannot be opened.
  async files() {
    const page = await open(kDesktop);
    result.files = [];
    const loaded = () => loricaPage.avatars.length > 0 && loricaPage.avatars.every((a) => a.loaded);
    await page.evaluate(() => {
      window.said = []; // notices stay for some seconds only
      const hear = (records) =>
        records.forEach(({ addedNodes }) =>
          addedNodes.forEach((li) => li.className === 'problem' && window.said.push(li.textContent)),
        );
      new MutationObserver(hear).observe(document.getElementById('notices'), { childList: true });
    });
    const ways = {
      button: () =>
        page.evaluate(() => [...document.querySelectorAll('#panel button')].find((b) => b.firstChild.data === 'open a file ...').click()),
      key: () => page.focus('#view').then(() => page.keyboard.press('o')),
    };
    for (const [index, file] of process.env.FILES.split(',').entries()) {
      const before = await see(page),
        heard = await page.evaluate(() => window.said.length);
      const way = ['button', 'key', 'drop'][index % 3];
      if (way === 'drop') {
        const bytes = fs.readFileSync(file).toString('base64');
        await page.evaluate(
          (name, text) => {
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
            for (const type of ['dragenter', 'dragover', 'drop'])
              document.getElementById('view').dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
          },
          path.basename(file),
          bytes,
        );
      } else {
        const [chooser] = await Promise.all([page.waitForFileChooser(), ways[way]()]);
        await chooser.accept([file]);
      }
      await until(page, (run, count) => loricaPage.run !== run || window.said.length > count, before.run, heard);
      await until(page, loaded);
      await drawn(page);
      const { run, avatars, state, controls } = await see(page);
      const notices = await page.evaluate((count) => window.said.slice(count), heard);
      await shot(page, `opened_${index}`);
      result.files.push({
        way,
        exchanged: run !== before.run,
        avatars,
        title: state.title,
        characters: controls.avatar.choices,
        said: notices.join(' '),
      });
    }
    // Another motion, and the file once more, from the list.
    const chosen = (label) =>
      page.evaluate((text) => {
        const select = [...document.querySelectorAll('#panel label')].find((one) => one.textContent.startsWith(text)).querySelector('select');
        select.value = '0';
        select.dispatchEvent(new Event('change'));
      }, label);
    const { state: { title }, controls } = await see(page);
    const recents = controls.sent.choices,
      motions = controls.motion.choices;
    await chosen('motion');
    await until(page, (name) => loricaPage.state.title.includes(name), motions[0]);
    await chosen('recent files');
    await until(page, (before) => loricaPage.state.title === before, title);
    result.recents = recents;
    result.errors = result.errors.filter((text) => !text.includes('status of 415')); // the browser's words about notes.pdf
    await page.close();
  },

  /// What the page says when something is missing, and when the session ends, for which it asks by a restart.
  async wrong() {
    const bare = async (to, before) => {
      const page = await (await browser.createBrowserContext()).newPage();
      if (before) await page.evaluateOnNewDocument(before);
      await page.goto(to, kWait);
      return page;
    };
    const said = async (page, where, words) => {
      await until(page, (at, part) => document.querySelector(at)?.textContent.includes(part), where, words);
      return page.$eval(where, (element) => element.textContent);
    };
    // One page after the other: each draws all that its machine can.
    const read = async (page, ...what) => {
      const text = await said(page, ...what);
      await page.close();
      return text;
    };
    const wrong = {
      token: await read(await bare(url.replace(/#.*/, `#${'x'.repeat(22)}`)), '#connection', 'valid'),
      webgl: await read(await bare(url, 'HTMLCanvasElement.prototype.getContext = () => null;'), '.lone', 'WebGL'),
      webxr: await read(
        await bare(url, "Object.defineProperty(navigator, 'xr', { value: undefined });"),
        '#panel',
        'no VR or AR',
      ),
    };
    // An address without https:// leads to the one with it; a page that still comes by http, through another server, says it.
    const without = await bare(url.replace('https:', 'http:'));
    await until(without, () => window.loricaPage?.open);
    wrong.without = without.url() === url;
    await without.close();
    const between = http.createServer((request, response) => {
      const to = new URL(request.url, url);
      https.get(to, { rejectUnauthorized: false }, (answer) => {
        response.writeHead(answer.statusCode, answer.headers);
        answer.pipe(response);
      });
    });
    await new Promise((resolve) => between.listen(0, '127.0.0.1', resolve));
    const plain = await bare(`http://plain.test:${between.address().port}/`);
    wrong.secure = await plain.evaluate(() => window.isSecureContext);
    wrong.http = await read(plain, '#panel', 'https');
    between.close();
    const page = await open(kSmall);
    result.wrong = wrong;
    await page.keyboard.press('Home');
    result.wrong.over = await said(page, '#connection', 'over');
    result.errors = result.errors.filter((text) => !text.includes('WebSocket')); // it tries again
    await page.close();
  },

  /// As OBS has it: the picture alone, with an alpha channel, in an empty scene.
  async source() {
    const page = await open(kDesktop, { query: '?scene=none&background=transparent', quality: 'high' });
    await until(page, () => loricaPage.controls.scene?.choices[loricaPage.controls.scene.value] === 'none');
    await until(page, () => loricaPage.props.length === 0);
    const seen = await framed(page);
    await drawn(page);
    const png = await page.screenshot({ path: path.join(folder, 'source.png'), omitBackground: true });
    const other = await (await browser.createBrowserContext()).newPage();
    result.source = await other.evaluate(async (text) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
      const picture = new OffscreenCanvas(image.width, image.height).getContext('2d');
      picture.drawImage(image, 0, 0);
      const { data } = picture.getImageData(0, 0, image.width, image.height);
      const alphas = data.filter((_, i) => i % 4 === 3),
        share = (is) => alphas.filter(is).length / alphas.length;
      let [left, right] = [image.width, 0];
      alphas.forEach((a, i) => {
        if (a > 0) [left, right] = [Math.min(left, i % image.width), Math.max(right, i % image.width)];
      });
      return { size: [image.width, image.height], clear: share((a) => a === 0), opaque: share((a) => a === 255), left, right };
    }, Buffer.from(png).toString('base64'));
    result.source.framed = seen;
    result.source.problems = (await see(page)).problems;
    await other.close();
    const wrong = await open(kDesktop, { query: '?scene=nowhere&background=pink' });
    await until(wrong, () => loricaPage.problems.length === 2);
    result.source.wrong = (await see(wrong)).problems;
    await wrong.close();
    await page.close();
  },

  async phone() {
    const page = await open(kPhone);
    result.framed = await framed(page);
    await shot(page, 'phone_light');
    await page.tap('button[aria-label=Settings]');
    await until(page, () => !document.body.classList.contains('shut'));
    await drawn(page);
    await shot(page, 'phone_light_settings');
    await scheme(page, 'dark');
    await shot(page, 'phone_dark_settings');
    await page.tap('.handle button');
    await until(page, () => document.body.classList.contains('shut'));
    await drawn(page);
    await shot(page, 'phone_dark');
    result.phone = true;
    await page.close();
  },

  /// While a depth camera follows somebody, the server hears of the headset and says how far it knows it: for
  /// `lorica serve --virtual`, of others nothing is done. The emulated one stands still, which is too little to know it.
  async register() {
    const { page, button, placed } = await openWithHeadset();
    if (await page.evaluate(() => loricaPage.live)) {
      await page.select('#panel select:has(option[value=inside])', 'inside');
      await button('Enter VR');
      await placed();
      await until(page, () => loricaPage.registration !== null);
      result.register = await page.evaluate(() => loricaPage.registration);
    }
    await page.close();
  },

  /// The wearer stands, until the server says that they have to walk; then walks along a curve and looks about, until it
  /// says how the headset lies to its camera, and on for 10 s of the walk.
  async walk() {
    const { page, button, placed } = await openWithHeadset();
    await page.select('#panel select:has(option[value=inside])', 'inside');
    await button('Enter VR');
    await placed();
    await until(page, () => loricaPage.registration?.advice.includes('walk a curve'));
    const standing = await page.evaluate(() => loricaPage.registration);
    await page.evaluate(() => {
      window.walked = 0;
      const from = loricaPage.pictures;
      let last = null;
      window.walking = setInterval(() => {
        const t = (loricaPage.pictures - from) / 30,
          along = 0.8 * t, // in radians, and in metres for a circle of 1 m
          yaw = -along + 0.4 * Math.sin(0.9 * t),
          pitch = 0.2 * Math.sin(0.7 * t),
          at = [Math.cos(along), 1.6 + 0.02 * Math.sin(9 * t), Math.sin(along)];
        device.position.set(...at);
        const [cy, sy, cp, sp] = [Math.cos(yaw / 2), Math.sin(yaw / 2), Math.cos(pitch / 2), Math.sin(pitch / 2)];
        device.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
        if (last) window.walked += Math.hypot(at[0] - last[0], at[2] - last[2]);
        last = at;
      }, 10);
    });
    await until(page, () => loricaPage.registration?.known);
    const { walked, registration } = await page.evaluate(() => ({ walked, registration: loricaPage.registration }));
    for (const metres of [6, 8]) await until(page, (far) => window.walked > far, metres);
    const { registration: last } = await see(page);
    await until(page, () => loricaPage.rig.yaw === loricaPage.registration.yaw).catch(() => {});
    const { rig, registration: now } = await see(page);
    result.walk = { standing, walked, registration, last, now, rig };
    await page.evaluate(() => {
      clearInterval(window.walking);
      device.activeSession.end();
    });
    await until(page, () => loricaPage.mode === null);
    await page.close();
  },

  async vr() {
    const { page, button, placed } = await openWithHeadset();
    await button('Enter VR');
    await placed();
    await drawn(page);
    await shot(page, 'vr_beside');
    const { rig, camera, avatars } = await see(page);
    result.vr = {
      mode: 'vr',
      distance: Math.hypot(camera[0] - avatars[0].center[0], camera[2] - avatars[0].center[2]),
      eyeHeight: camera[1],
    };

    // A controller goes where a loose prop is, in the headset's own axes, 0.6 m before it, and points at it.
    const aim = (side, index) =>
      page.evaluate(
        (hand, i, { position, yaw }) => {
          const c = device.controllers[hand],
            p = loricaPage.props[i].position.map((x, k) => x - position[k]),
            cos = Math.cos(yaw),
            sin = Math.sin(yaw);
          c.position.set(cos * p[0] - sin * p[2], p[1], sin * p[0] + cos * p[2] + 0.6);
          c.quaternion.set(0, 0, 0, 1);
        },
        side,
        index,
        rig,
      );
    // While it is paused nothing moves away from the ray.
    const pictured = async (more) => {
      const before = await page.evaluate(() => loricaPage.pictures);
      await until(page, (p) => loricaPage.pictures > p, before + more);
    };
    const pull = (side, value) =>
      page.evaluate((hand, v) => device.controllers[hand].updateButtonValue('trigger', v), side, value);
    await pause(page, true);
    await pictured(2);
    const loose = await page.evaluate(() => {
      // the nearest to the line of sight first
      const { camera, avatars, props } = loricaPage,
        to = avatars[0].center.map((x, k) => x - camera[k]);
      const angle = ({ position }) => {
        const d = position.map((x, k) => x - camera[k]);
        return (d[0] * to[0] + d[1] * to[1] + d[2] * to[2]) / Math.hypot(...d);
      };
      return props
        .map((prop, i) => [i, prop])
        .filter(([, prop]) => !prop.fixed && prop.visible)
        .sort(([, a], [, b]) => angle(b) - angle(a))
        .map(([i]) => i);
    });
    // Each controller takes the first prop that it meets, and not the other's.
    const holds = {};
    for (const side of ['right', 'left']) {
      for (const index of loose) {
        await aim(side, index);
        await pictured(2);
        await pull(side, 1);
        await pictured(2);
        const [held = -1] = (await see(page)).inHands.filter((prop) => prop >= 0 && prop !== holds.right);
        if (held < 0) {
          await pull(side, 0);
          await pictured(2);
          continue;
        }
        holds[side] = held;
        break;
      }
    }
    if (Object.keys(holds).length === 2) {
      const from = (await see(page)).props.map(({ position }) => position);
      await pause(page, false);
      await page.evaluate(() => {
        for (const side of ['left', 'right']) {
          const p = device.controllers[side].position;
          p.set(p.x, p.y + 0.5, p.z);
        }
      });
      result.vr.grab = { holds };
      for (const side of ['left', 'right']) {
        const moved = await (await until(page, away, holds[side], from[holds[side]], 0.25)).jsonValue();
        result.vr.grab[side] = moved;
      }
      await shot(page, 'vr_grab');
      // Thrown: let go while the hand rises.
      await page.evaluate(() => {
        const p = device.controllers.right.position,
          { x, y, z } = p,
          from = loricaPage.pictures;
        window.rising = setInterval(() => p.set(x, y + 0.01 * (loricaPage.pictures - from), z), 5);
      });
      await pictured(4);
      const begin = performance.now();
      await pictured(8);
      result.vr.quick = performance.now() - begin < 2000; // else it is no throw
      for (const side of ['right', 'left']) {
        await pull(side, 0);
        await until(page, (prop) => !loricaPage.inHands.includes(prop), holds[side]);
      }
      await page.evaluate(() => clearInterval(window.rising));
      result.vr.released = (await page.evaluate(() => window.sent))
        .map((text) => JSON.parse(text))
        .filter(({ type }) => type === 'release')
        .slice(-2);
    } else await pause(page, false);
    await page.evaluate(() => {
      device.primaryInputMode = 'hand';
      device.hands.left.position.set(-0.2, 1.3, -0.3);
      device.hands.right.position.set(0.25, 1.3, -0.3);
    });
    await drawn(page);
    await drawn(page);
    await shot(page, 'vr_hands');
    await page.evaluate(() => device.activeSession.end());
    await until(page, () => loricaPage.mode === null);

    await page.select('#panel select:has(option[value=inside])', 'inside');
    await button('Enter VR');
    await placed();
    await drawn(page);
    await shot(page, 'vr_inside');
    const inside = await see(page);
    result.vr.inside = {
      eyeHeight: inside.camera[1],
      distance: Math.hypot(
        inside.camera[0] - inside.avatars[0].center[0],
        inside.camera[2] - inside.avatars[0].center[2],
      ),
    };
    await page.evaluate(() => device.activeSession.end());
    await until(page, () => loricaPage.mode === null);

    await button('Enter AR');
    await placed();
    await drawn(page);
    await shot(page, 'ar');
    result.vr.ar = true;
    await page.evaluate(() => device.activeSession.end());
    await until(page, () => loricaPage.mode === null);
    await drawn(page);
    await shot(page, 'desktop_after_vr');
    await page.close();
  },
};

/// The page on a machine with an emulated headset, before it is entered.
async function openWithHeadset() {
  const iwer = fs.readFileSync(
    path.join(path.dirname(require.resolve('iwer/package.json')), 'build', 'iwer.min.js'),
    'utf8',
  );
  const page = await open(kSmall, {
    before: `${iwer};window.sent = [];
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (text) { window.sent.push(text); send.call(this, text); };
    window.device = new IWER.XRDevice(IWER.metaQuest3);
    device.installRuntime({ forceInstall: true }); device.stereoEnabled = true; device.position.set(0.1, 1.6, 0.2);`,
  });
  const button = (text) =>
    page.evaluate(
      (t) => [...document.querySelectorAll('#panel button')].find((b) => b.textContent === t).click(),
      text,
    );
  const placed = () => until(page, () => loricaPage.mode !== null && loricaPage.rig.position.some((x) => x !== 0));
  await until(page, () =>
    [...document.querySelectorAll('#panel button')].some((b) => b.textContent === 'Enter VR' && !b.closest('[hidden]')),
  );
  return { page, button, placed };
}

let failed = '';
try {
  for (const name of process.env.PARTS?.split(',') ?? Object.keys(parts)) {
    failed = name;
    await parts[name]();
  }
  failed = '';
} catch (error) {
  result.failed = `${failed}: ${error.message}`;
} finally {
  await browser.close();
}
const text = JSON.stringify(result, null, 1);
fs.writeFileSync(path.join(folder, 'result.json'), text);
console.log(text);
process.exit(result.failed || result.errors.length > 0 || result.outside.length > 0 ? 1 : 0);
