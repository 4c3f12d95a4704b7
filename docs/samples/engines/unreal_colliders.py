"""Simple collision of the hulls of `lorica export hero.fbx hero.glb --engine unreal`, in Unreal 5 with the plugins
Python Editor Script and Editor Scripting Utilities: import hero.glb as separate meshes into /Game/Hero, then run
`py unreal_colliders.py /Game/Hero`. Attach each mesh to the bone that its name begins with, and hide it in the game.
"""
import sys
import unreal

made = 0
for path in unreal.EditorAssetLibrary.list_assets(sys.argv[1]):
    mesh = unreal.EditorAssetLibrary.load_asset(path)
    if not isinstance(mesh, unreal.StaticMesh) or mesh.get_material(0) is None:
        continue
    if mesh.get_material(0).get_name().startswith("lorica_collider"):
        # A hull is convex and has at most 32 vertices: one piece holds all of it.
        unreal.EditorStaticMeshLibrary.remove_collisions(mesh)
        unreal.EditorStaticMeshLibrary.set_convex_decomposition_collisions(mesh, 1, 32, 100000)
        unreal.EditorAssetLibrary.save_loaded_asset(mesh)
        made += 1
unreal.log(f"{made} colliders")
