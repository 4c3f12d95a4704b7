// usage: node encode_osc.mjs FOLDER
// Writes packets with npm's osc, as programs that send the VMC protocol lay them out; all of one pose: the hips at
// (0.1, 0.9, 0.2) turned by 90 degrees about Unity's X, the left upper arm by 90 degrees about Unity's Z.
import fs from 'node:fs';
import path from 'node:path';
import osc from 'osc/src/osc.js';

const h = Math.SQRT1_2;
const f = (...values) => values.map((value) => ({ type: 'f', value }));
const i = (...values) => values.map((value) => ({ type: 'i', value }));
const s = (value) => ({ type: 's', value });
const message = (address, ...args) => ({ address, args });
const bone = (name, ...values) => message('/VMC/Ext/Bone/Pos', s(name), ...f(...values));
const hips = (sign = 1) => bone('Hips', 0.1, 0.9, 0.2, sign * h, 0, 0, sign * h);
const arm = (name = 'LeftUpperArm', sign = 1) => bone(name, -0.2, 0, 0, 0, 0, sign * h, sign * h);
const root = (name = 'root', ...more) => message('/VMC/Ext/Root/Pos', s(name), ...f(0, 0, 0, 0, 0, 0, 1, ...more));
const bundle = (...packets) => ({ timeTag: osc.timeTag(0), packets });

const senders = {
  // one bundle of all bones; root, state and time by themselves
  reference_sample: [bundle(hips(), arm(), bone('LastBone', 0, 0, 0, 0, 0, 0, 1)), root('root', 1, 1, 1, 0, 0, 0),
    message('/VMC/Ext/OK', ...i(1, 3, 0, 1)), message('/VMC/Ext/T', ...f(12.5))],
  // each message in a packet of its own
  single_messages: [root(), hips(), arm(), message('/VMC/Ext/OK', ...i(1)), message('/VMC/Ext/T', ...f(1))],
  // one bundle with time, state, root and bones; quaternions negated
  slimevr: [bundle(message('/VMC/Ext/T', ...f(3)), message('/VMC/Ext/OK', ...i(1, 3, 0)), root(), hips(-1), arm(undefined, -1))],
  // the root has no name; neither state nor time; eyes
  vmagicmirror: [bundle(root(''), hips(), arm(), bone('LeftEye', 0, 0, 0, 0, 0, 0, 1))],
  // root alone, bones, expressions, state; names as in VRM 1.0
  xr_animator: [root(), bundle(bone('hips', 0.1, 0.9, 0.2, h, 0, 0, h), arm('leftUpperArm')),
    bundle(message('/VMC/Ext/Blend/Val', s('happy'), ...f(0.25)), message('/VMC/Ext/Blend/Apply')), message('/VMC/Ext/OK', ...i(1))],
  // bones without a root
  no_root: [bundle(hips(), arm())],
  // bundles in a bundle
  nested: [bundle(bundle(hips()), bundle(bundle(arm())))],
};
for (const [name, packets] of Object.entries(senders)) {
  packets.forEach((packet, index) => {
    fs.writeFileSync(path.join(process.argv[2], `${name}.${index}.osc`), osc.writePacket(packet, { metadata: true }));
  });
}
