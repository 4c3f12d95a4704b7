// usage: node collider_schemas.mjs FILE.glb OUT.json FOLDER...
// Checks the physics extensions of a GLB against JSON schemas, and that their indices exist. The folders hold
// *.schema.json; a later one replaces those of earlier ones with the same name.
// Writes {"checked": {extension: number of objects}, "errors": [sentences]}.
import fs from 'node:fs';
import path from 'node:path';
import Ajv from 'ajv/dist/2020.js';

const [file, out, ...folders] = process.argv.slice(2);
const schemas = new Map();
for (const folder of folders) {
  for (const name of fs.readdirSync(folder).filter((each) => each.endsWith('.schema.json'))) {
    schemas.set(name, JSON.parse(fs.readFileSync(path.join(folder, name), 'utf8')));
  }
}
const ajv = new Ajv({ strict: false, allErrors: true });
for (const [name, schema] of schemas) ajv.addSchema({ ...schema, $id: name });

const bytes = fs.readFileSync(file);
const document = JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
const checked = {};
const errors = [];
function check(extension, schema, place, holder) {
  const value = holder?.extensions?.[extension];
  if (value === undefined) return undefined;
  checked[extension] = (checked[extension] ?? 0) + 1;
  if (!document.extensionsUsed?.includes(extension)) errors.push(`${place}: ${extension} is not in extensionsUsed`);
  const valid = ajv.getSchema(schema);
  if (!valid(value)) errors.push(...valid.errors.map((e) => `${place}: ${extension}${e.instancePath} ${e.message}`));
  return value;
}
function index(place, name, value, list) {
  if (value !== undefined && !(value in (list ?? []))) errors.push(`${place}: ${name} ${value} of ${list?.length ?? 0}`);
}

const shapes = check('OMI_physics_shape', 'glTF.OMI_physics_shape.schema.json', 'document', document)?.shapes;
for (const [i, shape] of (shapes ?? []).entries()) index(`shape ${i}`, 'mesh', shape.convex?.mesh, document.meshes);
for (const [i, node] of document.nodes.entries()) {
  const place = `node ${i}`;
  const body = check('OMI_physics_body', 'node.OMI_physics_body.schema.json', place, node);
  index(place, 'shape', body?.collider?.shape, shapes);
  const rigid = check('KHR_physics_rigid_bodies', 'node.KHR_physics_rigid_bodies.schema.json', place, node);
  index(place, 'mesh', rigid?.collider?.geometry?.mesh, document.meshes);
}
fs.writeFileSync(out, JSON.stringify({ checked, errors }));
