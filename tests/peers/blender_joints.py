# usage: blender -b --factory-startup --python-exit-code 1 --python blender_joints.py -- JOBS.json OUT.json
# Where Blender has the joints of animated files. JOBS is a list of {"file": .., "frames": [..]}: seconds of a .glb,
# numbers of frames of a .bvh from 0. OUT has for each job a list with {name: [[x, y, z], ...]} for each frame: world
# positions of the bones and objects of that name, Z up, in the file's units (of a .bvh: metres).
import json
import sys

import bpy
import numpy
from io_anim_bvh import import_bvh

# Debian 12's Blender is older than its numpy and Python, which no longer have these.
numpy.bool = bool
import_bvh.open = lambda path, mode: open(path, mode.replace('U', ''))

FPS = 30


def load(file):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    if file.endswith('.bvh'):
        bpy.ops.import_anim.bvh(filepath=file, global_scale=0.01)
    else:
        bpy.ops.import_scene.gltf(filepath=file)


def joints():
    found = {}
    for thing in bpy.context.scene.objects:
        found.setdefault(thing.name, []).append(list(thing.matrix_world.translation))
    for thing in bpy.context.scene.objects:
        if thing.type == 'ARMATURE':
            for bone in thing.pose.bones:
                found.setdefault(bone.name, []).append(list((thing.matrix_world @ bone.matrix).translation))
    return found


def at(file, frame):
    position = 1 + frame if file.endswith('.bvh') else frame * FPS
    bpy.context.scene.frame_set(int(position), subframe=position - int(position))
    return joints()


jobs, out = sys.argv[sys.argv.index('--') + 1:]
results = []
for job in json.load(open(jobs)):
    load(job['file'])
    results.append([at(job['file'], frame) for frame in job['frames']])
json.dump(results, open(out, 'w'))
