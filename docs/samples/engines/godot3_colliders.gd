# Bodies of the hulls of `lorica export hero.fbx hero.glb`, in Godot 3.2 or later: choose this file as "Custom Script"
# when hero.glb is imported. (With `--engine godot` Godot makes static bodies of its own accord.)
tool
extends EditorScenePostImport

func post_import(scene):
	var hulls = []
	find_hulls(scene, hulls)
	for hull in hulls:
		var body = KinematicBody.new()
		var shape = CollisionShape.new()
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
	if node is MeshInstance and node.mesh.get_surface_count() > 0:
		var material = node.mesh.surface_get_material(0)
		if material != null and material.resource_name.begins_with("lorica_collider"):
			hulls.append(node)
	for child in node.get_children():
		find_hulls(child, hulls)
