// usage: node build.mjs OUT_FOLDER NODE_MODULES_PARENT [LORICA_PACKAGE]
// Makes the page that `lorica serve` embeds: page.js, page.css, index.html and licences.txt. With the folder of the npm
// package `lorica` it makes the page "Try Lorica" of the site instead, from try/. The packages of package.json have to be in
// NODE_MODULES_PARENT/node_modules, with the hashes of hashes.txt.
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = path.dirname(fileURLToPath(import.meta.url));
const fail = (sentence) => {
  console.error(`viewer/page/web/build.mjs: ${sentence}`);
  process.exit(1);
};
const [out, parent, own] = process.argv.slice(2);
if (!parent) fail('usage: node build.mjs OUT_FOLDER NODE_MODULES_PARENT [LORICA_PACKAGE]');
const lorica = own && path.resolve(own);
const folder = lorica ? path.join(here, 'try') : here;
const modules = path.join(path.resolve(parent), 'node_modules');

/// What npm says that it installed, by name.
function installed() {
  try {
    const { packages } = JSON.parse(fs.readFileSync(path.join(modules, '.package-lock.json'), 'utf8'));
    return new Map(Object.entries(packages).map(([folder, p]) => [folder.split('node_modules/').pop(), p]));
  } catch (error) {
    return fail(`${modules} has no list of packages (${error.code ?? error.message}): npm install them there`);
  }
}

/// Every package that is here has to be known with this hash, and those of package.json here. Of esbuild's programs only
/// that of this machine is installed.
function check(packages) {
  const known = new Map(
    fs
      .readFileSync(path.join(here, 'hashes.txt'), 'utf8')
      .split('\n')
      .filter((line) => line && !line.startsWith('#'))
      .map((line) => line.split(/\s+/))
      .map(([name, version, hash]) => [name, { version, hash }]),
  );
  const wanted = new Set(Object.keys(JSON.parse(fs.readFileSync(path.join(folder, 'package.json'), 'utf8')).dependencies));
  for (const [name, { version, integrity }] of packages) {
    const expected = known.get(name);
    if (!expected) {
      // other packages may live in the same folder; the bundle is checked below
      if (name.startsWith('@esbuild/')) fail(`${name} is not in hashes.txt`);
      continue;
    }
    if (version !== expected.version) fail(`${name} is ${version}, wanted is ${expected.version}`);
    if (integrity !== expected.hash) fail(`${name} ${version} has the hash ${integrity}, wanted is ${expected.hash}`);
    wanted.delete(name);
  }
  if (wanted.size > 0) fail(`${[...wanted].join(', ')} not installed in ${modules}`);
  return known;
}

const packages = installed();
const known = check(packages);
let esbuild;
try {
  esbuild = await import(
    pathToFileURL(createRequire(path.join(modules, 'esbuild', 'package.json')).resolve('esbuild'))
  );
} catch (error) {
  fail(`esbuild does not load: ${error.message.split('\n')[0]}`);
}

const start = performance.now();
const bundle = await esbuild
  .build({
    entryPoints: lorica
      ? { try: path.join(folder, 'main.js'), worker: path.join(lorica, 'worker.js') }
      : { page: path.join(here, 'src', 'main.js') },
    outdir: path.resolve(out),
    alias: lorica ? { lorica: path.join(lorica, 'lorica.js'), 'lorica/worker': path.join(lorica, 'worker.js'),
      'lorica/rapier': path.join(lorica, 'rapier.js') } : {},
    external: ['node:*'],
    bundle: true,
    splitting: lorica !== undefined, // what is needed later is loaded later
    chunkNames: '[name]',
    minify: true,
    format: 'esm',
    target: 'es2022',
    charset: 'utf8',
    legalComments: 'none',
    nodePaths: [modules],
    absWorkingDir: here,
    write: false,
    metafile: true,
    logLevel: 'silent',
  })
  .catch((error) =>
    fail(`${error.errors?.[0]?.text ?? error.message} in ${error.errors?.[0]?.location?.file ?? 'the page'}`),
  );
const seconds = (performance.now() - start) / 1000;

// Packages whose files are bundled, and those that these hold copies of.
const found = new Set(
  Object.keys(bundle.metafile.inputs)
    .map((file) => /node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(file)?.[1])
    .filter(Boolean),
);
for (const name of found)
  for (const other of Object.keys(packages.get(name)?.dependencies ?? {}))
    if (!other.includes('/types-')) found.add(other);
const bundled = [...found].sort();
for (const name of bundled) if (!known.has(name)) fail(`${name} is bundled but not in hashes.txt`);
const licences = bundled.map((name) => {
  const file = fs.readdirSync(path.join(modules, name)).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) fail(`${name} has no licence file`);
  return `${name} ${packages.get(name).version}\n\n${fs
    .readFileSync(path.join(modules, name, file), 'utf8')
    .replaceAll('\r', '')
    .trim()}\n`;
});

fs.mkdirSync(out, { recursive: true });
for (const file of bundle.outputFiles) fs.writeFileSync(file.path, file.contents);
const script = bundle.outputFiles[0].contents;
const copied = lorica ? ['index.html', 'try.css', '../page.css', '../../../../LICENSE'] : ['index.html', 'page.css'];
for (const file of copied) fs.copyFileSync(path.join(folder, file), path.join(out, path.basename(file)));
if (lorica) fs.copyFileSync(path.join(lorica, 'lorica.wasm'), path.join(out, 'lorica.wasm'));
fs.writeFileSync(
  path.join(out, 'licences.txt'),
  `The page of Lorica contains these packages.\n\n${licences.join(`\n${'-'.repeat(72)}\n\n`)}`,
);
console.log(
  `${path.basename(bundle.outputFiles[0].path)} ${script.length} bytes, ${gzipSync(script, { level: 9 }).length} with gzip, ${bundled.length} packages, bundled in ${seconds.toFixed(2)} s`,
);
