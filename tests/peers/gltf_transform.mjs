// usage: node gltf_transform.mjs FILE.glb OUT.json
// What gltf-transform reads of a GLB: {"nodes": {name: {"parent", "mesh", "triangles"}}, "skins": [number of joints]}.
import fs from 'node:fs';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';

const [file, out] = process.argv.slice(2);
const root = (await new NodeIO().registerExtensions(ALL_EXTENSIONS).read(file)).getRoot();
const nodes = {};
for (const node of root.listNodes()) {
  const mesh = node.getMesh();
  nodes[node.getName()] = {
    parent: node.getParentNode()?.getName() ?? '',
    mesh: mesh?.getName() ?? '',
    triangles: (mesh?.listPrimitives() ?? []).reduce((sum, p) => sum + (p.getIndices()?.getCount() ?? 0) / 3, 0),
  };
}
fs.writeFileSync(out, JSON.stringify({ nodes, skins: root.listSkins().map((skin) => skin.listJoints().length) }));
