// The hulls of `lorica export hero.glb hero.xml --per-bone` in MuJoCo: drops the figure on a floor for two seconds.
// npm install @mujoco/mujoco; node mujoco_bodies.mjs hero.xml (in Python: mujoco.MjModel.from_xml_path, and the same)
import fs from 'node:fs';
import load from '@mujoco/mujoco';

const mujoco = await load();
const xml = fs.readFileSync(process.argv[2], 'utf8')
  .replace('<worldbody>', '<worldbody><geom name="floor" type="plane" size="0 0 1"/>');
const model = mujoco.MjModel.from_xml_string(xml);
const data = new mujoco.MjData(model);
while (data.time < 2) mujoco.mj_step(model, data);
const mass = Array.from(model.body_mass).reduce((a, b) => a + b, 0);
const heights = Array.from(data.xpos).filter((_, i) => i > 2 && i % 3 === 2);
console.log(`${model.nbody - 1} bodies with ${model.nmesh} hulls, ${mass.toFixed(1)} kg; after 2 s the highest is at`,
  `${Math.max(...heights).toFixed(2)} m with ${data.ncon} contacts`);
