// Colliders of the hulls of `lorica export hero.fbx hero.glb --engine unity`, in Unity with glTFast or UnityGLTF: put
// this file into a folder Editor, select the character in a scene, and choose Tools > Lorica > Make Colliders.
using UnityEditor;
using UnityEngine;

public static class LoricaColliders
{
    [MenuItem("Tools/Lorica/Make Colliders")]
    private static void Make()
    {
        int made = 0;
        foreach (MeshRenderer drawn in Selection.activeGameObject.GetComponentsInChildren<MeshRenderer>(true))
        {
            if (drawn.sharedMaterial == null || !drawn.sharedMaterial.name.StartsWith("lorica_collider")) continue;
            GameObject hull = drawn.gameObject;
            MeshCollider collider = Undo.AddComponent<MeshCollider>(hull);
            collider.sharedMesh = hull.GetComponent<MeshFilter>().sharedMesh;
            collider.convex = true;
            Undo.AddComponent<Rigidbody>(hull).isKinematic = true;  // it follows its bone
            Undo.RecordObject(drawn, "Make Colliders");
            drawn.enabled = false;
            ++made;
        }
        Debug.Log($"{made} colliders");
    }
}
