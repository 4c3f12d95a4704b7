#!/usr/bin/env node
/// npx lorica decompose mesh.obj -o hulls.obj: the least of `lorica decompose`, where only Node is.
import fs from 'node:fs';
import { load } from './lorica.js';

const USAGE = `usage: lorica decompose MESH.obj -o HULLS.obj [--parts N] [--concavity X] [--hull-vertices N]
                [--hull-planes N] [--preset fast|paper|quality] [--walls auto|solid|shell]
MESH.obj is one mesh. HULLS.obj gets an object for each part; with -o FILE.lorica the parts for Lorica itself.
Other formats, characters and everything else need the full command, which has the same name.`;

const fail = (sentence) => {
  console.error(`lorica: ${sentence}`);
  process.exit(2);
};

/// Vertices and triangles of an OBJ file; larger faces are cut into fans.
const parseObj = (text, name) => {
  const positions = [], indices = [];
  text.replace(/\\\r?\n/g, ' ').split('\n').forEach((line, at) => {
    const [kind, ...words] = line.trim().split(/\s+/);
    if (kind === 'v') {
      const point = words.slice(0, 3).map(Number);
      if (point.length < 3 || !point.every(Number.isFinite)) fail(`${name}, line ${at + 1}: found "${line}", expected v X Y Z`);
      positions.push(...point);
    } else if (kind === 'f') {
      const corners = words.map((word) => {
        const index = Number.parseInt(word, 10), count = positions.length / 3;
        const vertex = index < 0 ? count + index : index - 1;
        if (!(vertex >= 0 && vertex < count)) fail(`${name}, line ${at + 1}: found corner "${word}", expected 1 to ${count}`);
        return vertex;
      });
      for (let c = 2; c < corners.length; ++c) indices.push(corners[0], corners[c - 1], corners[c]);
    }
  });
  if (indices.length === 0) fail(`${name}: no faces, expected an OBJ file with a mesh`);
  return { positions, indices };
};

const formatObj = (hulls) => {
  const lines = [];
  let before = 1;
  hulls.forEach(({ positions, indices }, part) => {
    lines.push(`o part_${part}`);
    for (let v = 0; v < positions.length; v += 3) lines.push(`v ${positions[v]} ${positions[v + 1]} ${positions[v + 2]}`);
    for (let t = 0; t < indices.length; t += 3) {
      lines.push(`f ${indices[t] + before} ${indices[t + 1] + before} ${indices[t + 2] + before}`);
    }
    before += positions.length / 3;
  });
  return `${lines.join('\n')}\n`;
};

const NAMES = { '--parts': 'parts', '--concavity': 'concavity', '--hull-vertices': 'hullVertices',
  '--hull-planes': 'hullPlanes', '--preset': 'preset',
  '--walls': 'walls', '-o': 'output' };
const [command, ...rest] = process.argv.slice(2);
if (command === undefined || command === '-h' || command === '--help') {
  console.log(USAGE);
  process.exit(0);
}
if (command !== 'decompose') fail(`found "${command}", expected decompose\n${USAGE}`);
const options = {};
let input;
for (let i = 0; i < rest.length; ++i) {
  const name = NAMES[rest[i]];
  if (name === undefined && rest[i].startsWith('-')) fail(`found "${rest[i]}", expected one of ${Object.keys(NAMES).join(', ')}`);
  if (name === undefined) { input = rest[i]; continue; }
  const value = rest[++i];
  if (value === undefined) fail(`${rest[i - 1]} needs a value`);
  options[name] = ['preset', 'walls', 'output'].includes(name) ? value : Number(value);
  if (Number.isNaN(options[name])) fail(`${rest[i - 1]}: found "${value}", expected a number`);
}
const { output, ...settings } = options;
if (!input || !output) fail(`a mesh and -o are needed\n${USAGE}`);
try {
  const { positions, indices } = parseObj(fs.readFileSync(input, 'utf8'), input);
  const lorica = await load();
  if (process.stderr.isTTY) settings.onProgress = (done, wanted) => { process.stderr.write(`\r${done} of ${wanted || '?'} parts `); };
  const parts = lorica.decompose(positions, indices, settings);
  if (process.stderr.isTTY) process.stderr.write('\r\x1b[K');
  fs.writeFileSync(output, output.endsWith('.lorica') ? parts.bytes() : formatObj(parts.hulls));
  for (const note of [parts.repaired, parts.warning]) if (note) console.error(`${input}: ${note}`);
  console.log(`${output}: ${parts.count} hulls, ${(100 * parts.error).toFixed(1)} % more volume than the mesh, hash ${parts.hash}`);
} catch (error) {
  fail(error.code ? `${error.path ?? input}: ${error.message}` : `${input}: ${error.message}`);
}
