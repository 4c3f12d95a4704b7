// usage: node mujoco.mjs JOB.json OUT.json
// What MuJoCo makes of a model. JOB: {"model": file.xml or file.urdf, and any of
//   "meshes": [files]          that a URDF names, by their names alone
//   "folder": folder           with all files that the model names; the model is a file in it, and names them as it does
//   "rest": true               "inertias": of each body mass, moments, centre and axes; "contacts": pairs of bodies
//                              that touch at the start; "collides": the number of geoms that can
//   "floor": height            a floor is added, and the first body starts that much higher [m]
//   "seconds": s               steps that long: "warnings", "speed" (largest of all velocities) and "moved"
//                              (farthest that a body moves), both in the last second, "finite", "lowest" (z of a body),
//                              "places" (of each body by name)
//   "volumes": true            inertia is taken from the geoms: "masses" of the bodies by name, of density 1000
//   "mocap": [{"pose": {body: [x, y, z, qw, qx, qy, qz]}, "pairs": [[geom, geom]]}]
//                              places bodies: "distances" of each pair, at most 10 m
// } OUT has "bodies", "geoms", "joints", "mass" and what was asked for.
import fs from 'node:fs';
import path from 'node:path';
import load from '@mujoco/mujoco';

const [jobFile, outFile] = process.argv.slice(2);
const job = JSON.parse(fs.readFileSync(jobFile, 'utf8'));
const mj = await load();
let xml = fs.readFileSync(path.join(job.folder ?? '', job.model), 'utf8');
if (job.floor) xml = xml.replace('<worldbody>', '<worldbody><geom name="floor" type="plane" size="0 0 1"/>');
if (job.volumes) xml = xml.replace(/<inertial [^>]*\/>/g, '');

let model;
if (job.folder) {
  for (const name of fs.readdirSync(job.folder, { recursive: true })) {
    const from = path.join(job.folder, name), to = path.posix.join('/robot', name);
    if (fs.statSync(from).isDirectory()) continue;
    mj.FS.mkdirTree(path.posix.dirname(to));
    mj.FS.writeFile(to, new Uint8Array(fs.readFileSync(from)));
  }
  model = mj.MjModel.from_xml_path(path.posix.join('/robot', job.model));
} else if (job.meshes) {
  const vfs = new mj.MjVFS();
  for (const file of job.meshes) vfs.addBuffer(path.basename(file), new Uint8Array(fs.readFileSync(file)));
  model = mj.MjModel.from_xml_string(xml, vfs);
} else {
  model = mj.MjModel.from_xml_string(xml);
}
const data = new mj.MjData(model);
const numbers = (list) => Array.from(list ?? []);
const id = (kind, name) => mj.mj_name2id(model, kind.value, name);
const out = { bodies: model.nbody - 1, geoms: model.ngeom, joints: model.njnt, mass: numbers(model.body_mass).reduce((a, b) => a + b, 0) };

if (job.rest) {
  mj.mj_forward(model, data);
  const body = (geom) => mj.mj_id2name(model, mj.mjtObj.mjOBJ_BODY.value, model.geom_bodyid[geom]);
  const part = (list, b, n) => numbers(list).slice(n * b, n * b + n);
  out.inertias = {};
  for (let b = 1; b < model.nbody; ++b) {
    out.inertias[mj.mj_id2name(model, mj.mjtObj.mjOBJ_BODY.value, b)] = [model.body_mass[b], ...part(model.body_inertia, b, 3), ...part(model.body_ipos, b, 3), ...part(model.body_iquat, b, 4)];
  }
  const pairs = new Set();
  for (let c = 0; c < data.ncon; ++c) {
    const contact = data.contact.get(c);
    pairs.add([body(contact.geom1), body(contact.geom2)].sort().join(' '));
  }
  out.contacts = [...pairs].sort();
  out.collides = numbers(model.geom_contype).filter((type, g) => type || model.geom_conaffinity[g]).length;
}
if (job.volumes) {
  out.masses = {};
  for (let b = 1; b < model.nbody; ++b) out.masses[mj.mj_id2name(model, mj.mjtObj.mjOBJ_BODY.value, b)] = model.body_mass[b];
}
if (job.seconds) {
  if (job.floor) data.qpos[2] += job.floor;
  out.speed = 0;
  let before;
  while (data.time < job.seconds) {
    mj.mj_step(model, data);
    if (data.time <= job.seconds - 1) continue;
    before ??= numbers(data.xpos);
    for (const v of numbers(data.qvel)) out.speed = Math.max(out.speed, Math.abs(v));
  }
  out.moved = Math.max(...numbers(data.xpos).map((x, i) => Math.abs(x - before[i])));
  out.warnings = 0;
  for (let w = 0; w < data.warning.size(); ++w) out.warnings += data.warning.get(w).number;
  out.finite = numbers(data.qpos).every(Number.isFinite);
  out.places = {};
  for (let b = 1; b < model.nbody; ++b) out.places[mj.mj_id2name(model, mj.mjtObj.mjOBJ_BODY.value, b)] = numbers(data.xpos).slice(3 * b, 3 * b + 3);
  out.lowest = Math.min(...numbers(data.xpos).filter((_, i) => i % 3 === 2 && i > 2));
}
if (job.mocap) {
  out.distances = [];
  for (const { pose, pairs } of job.mocap) {
    for (const [name, p] of Object.entries(pose)) {
      const m = model.body_mocapid[id(mj.mjtObj.mjOBJ_BODY, name)];
      for (let i = 0; i < 3; ++i) data.mocap_pos[3 * m + i] = p[i];
      for (let i = 0; i < 4; ++i) data.mocap_quat[4 * m + i] = p[3 + i];
    }
    mj.mj_forward(model, data);
    for (const [a, b] of pairs) {
      out.distances.push(mj.mj_geomDistance(model, data, id(mj.mjtObj.mjOBJ_GEOM, a), id(mj.mjtObj.mjOBJ_GEOM, b), 10, null));
    }
  }
}
fs.writeFileSync(outFile, JSON.stringify(out));
