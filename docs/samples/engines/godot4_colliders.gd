# Bodies of the hulls of `lorica export hero.fbx hero.glb`, in Godot 4: choose this file as "Import Script"
# when hero.glb is imported. (With `--engine godot` Godot makes static bodies of its own accord.)
@tool
extends EditorScenePostImport

func _post_import(scene):
	var hulls = []
	find_hulls(scene, hulls)
	for hull in hulls:
		var body = AnimatableBody3D.new()
		var shape = CollisionShape3D.new()
		body.sync_to_physics = false  # the bone moves it
		body.name = hull.name
		body.transform = hull.transform
		shape.shape = hull.mesh.create_convex_shape()
		hull.get_parent().add_child(body)
		body.owner = scene
		body.add_child(shape)
		shape.owner = scene
		hull.get_parent().remove_child(hull)
		hull.free()
	print(hulls.size(), " colliders")
	return scene

func find_hulls(node, hulls):
	if node is MeshInstance3D and node.mesh.get_surface_count() > 0:
		var material = node.mesh.surface_get_material(0)
		if material != null and material.resource_name.begins_with("lorica_collider"):
			hulls.append(node)
	for child in node.get_children():
		find_hulls(child, hulls)
