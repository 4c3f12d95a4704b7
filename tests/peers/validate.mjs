// usage: node validate.mjs FOLDER OUT.json
// What gltf-validator says of each file of a folder: {name: [{severity, code, pointer, message}]}, severity 0 = error.
import fs from 'node:fs';
import path from 'node:path';
import validator from 'gltf-validator';

const [folder, out] = process.argv.slice(2);
const found = {};
for (const name of fs.readdirSync(folder).sort()) {
  const bytes = new Uint8Array(fs.readFileSync(path.join(folder, name)));
  try {
    const report = await validator.validateBytes(bytes, { maxIssues: 0 });
    found[name] = report.issues.messages.map(({ severity, code, pointer, message }) => ({ severity, code, pointer: pointer ?? '', message }));
  } catch (error) { // it refuses what is no glTF at all
    found[name] = [{ severity: 0, code: 'NOT_GLTF', pointer: '', message: String(error) }];
  }
}
fs.writeFileSync(out, JSON.stringify(found));
