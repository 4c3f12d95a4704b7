// usage: node decode_osc.mjs FOLDER
// Decodes each *.osc of a folder with osc-min and writes NAME.json beside it: a list of {address, values}.
import fs from 'node:fs';
import path from 'node:path';
import { fromBuffer } from 'osc-min';

const flat = (packet) => (packet.oscType === 'bundle'
  ? packet.elements.flatMap(flat)
  : [{ address: packet.address, values: packet.args.map((argument) => argument.value) }]);

const folder = process.argv[2];
for (const file of fs.readdirSync(folder).filter((name) => name.endsWith('.osc'))) {
  const messages = flat(fromBuffer(fs.readFileSync(path.join(folder, file))));
  fs.writeFileSync(path.join(folder, file.replace('.osc', '.json')), JSON.stringify(messages));
}
