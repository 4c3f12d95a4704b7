"""Rigid bodies of the hulls of `lorica export hero.fbx hero.glb`, in Blender 3.4 or later.

blender --python blender_colliders.py -- hero.glb   (with -b and --save hero.blend: without a window)
"""
import os
import sys
import bpy
import numpy

numpy.bool = bool  # Debian 12's Blender is older than its numpy, which no longer has this

arguments = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=os.path.abspath(arguments[0]))
bpy.ops.rigidbody.world_add()
hulls = [o for o in bpy.data.objects if o.type == "MESH" and o.data.materials
         and o.data.materials[0] is not None and o.data.materials[0].name.startswith("lorica_collider")]
for hull in hulls:
    bpy.context.view_layer.objects.active = hull
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    hull.rigid_body.kinematic = True  # it follows its bone
    hull.rigid_body.collision_shape = "CONVEX_HULL"
    hull.display_type = "WIRE"
    hull.hide_render = True
print(f"{len(hulls)} colliders on {len({h.parent_bone for h in hulls})} bones")
if "--save" in arguments:
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(arguments[arguments.index("--save") + 1]))
