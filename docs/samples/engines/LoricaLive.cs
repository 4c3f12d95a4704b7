// Live hulls of a skinned character in Unity, through lorica_c.dll (put it into Assets/Plugins/x86_64): add this to the object
// that has the SkinnedMeshRenderer. The hulls are in world space each frame; Cast() asks them, which hits what is drawn and not
// a capsule. Without a file of parts they are made when the scene starts, which takes seconds.
// Run with Mono and stand-ins for Unity's classes; never tried in Unity itself.
using System;
using System.Runtime.InteropServices;
using UnityEngine;

public sealed class LoricaLive : MonoBehaviour
{
    public TextAsset parts;  // a .lorica file of this mesh, renamed to .bytes; none = made at the start
    public int count = 16;   // parts, if they are made
    public bool drawn = true;

    [StructLayout(LayoutKind.Sequential)]
    private struct Skin
    {
        public UIntPtr size;
        public IntPtr name, vertices;
        public UIntPtr vertexCount;
        public IntPtr triangles;
        public UIntPtr triangleCount;
        public IntPtr joints, weights;
        public UIntPtr jointsPerVertex;
        public IntPtr jointFromModel;
        public UIntPtr jointCount;
        public IntPtr poses;
        public UIntPtr poseCount;
    }

    [StructLayout(LayoutKind.Sequential)]
    private struct BodyOptions
    {
        public UIntPtr size;
        public int parts, hullVertices;
        public double cover;
        public int threads;
        public IntPtr progress, user;
    }

    [StructLayout(LayoutKind.Sequential)]
    private struct Hull
    {
        public UIntPtr size;
        public IntPtr vertices;
        public UIntPtr vertexCount;
        public IntPtr triangles;
        public UIntPtr triangleCount;
        public double volume;
    }

    [DllImport("lorica_c")] private static extern IntPtr lorica_last_error();
    [DllImport("lorica_c")] private static extern int lorica_character_make(ref Skin skin, IntPtr options, out IntPtr character);
    [DllImport("lorica_c")] private static extern void lorica_character_free(IntPtr character);
    [DllImport("lorica_c")] private static extern int lorica_body_make(IntPtr character, ref BodyOptions options, out IntPtr body);
    [DllImport("lorica_c")] private static extern int lorica_body_from_bytes(IntPtr character, byte[] bytes, UIntPtr count, out IntPtr body);
    [DllImport("lorica_c")] private static extern UIntPtr lorica_body_part_count(IntPtr body);
    [DllImport("lorica_c")] private static extern void lorica_body_free(IntPtr body);
    [DllImport("lorica_c")] private static extern int lorica_live_make(IntPtr body, out IntPtr live);
    [DllImport("lorica_c")] private static extern void lorica_live_free(IntPtr live);
    [DllImport("lorica_c")] private static extern int lorica_live_pose(IntPtr live, double[] matrices, UIntPtr joints);
    [DllImport("lorica_c")] private static extern int lorica_live_hull(IntPtr live, UIntPtr part, ref Hull hull);
    [DllImport("lorica_c")] private static extern int lorica_live_cast_rays(IntPtr live, double[] rays, UIntPtr count, double reach,
        double radius, double[] half, int[] parts, double[] distances, double[] positions, double[] normals);

    private readonly double[] ray = new double[6], distance = new double[1], position = new double[3], normal = new double[3];
    private readonly int[] hit = new int[1];
    private SkinnedMeshRenderer skin;
    private Transform[] bones;
    private double[] matrices;
    private double[] points = new double[0];
    private int[] corners = new int[0];
    private IntPtr live = IntPtr.Zero;
    private int partCount;

    private static void Check(int status)
    {
        if (status != 0) throw new InvalidOperationException(Marshal.PtrToStringUTF8(lorica_last_error()));
    }

    private static void Write(Matrix4x4 matrix, double[] to, int at)
    {
        for (int i = 0; i < 16; ++i) to[at + i] = matrix[i];  // by columns, as Lorica has them
    }

    private void ReadBones()
    {
        for (int j = 0; j < bones.Length; ++j) Write(bones[j].localToWorldMatrix, matrices, 16 * j);
    }

    private void OnEnable()
    {
        skin = GetComponent<SkinnedMeshRenderer>();
        bones = skin.bones;
        matrices = new double[16 * bones.Length];
        Mesh mesh = skin.sharedMesh;
        Vector3[] positions = mesh.vertices;
        BoneWeight[] influences = mesh.boneWeights;
        var vertices = new double[3 * positions.Length];
        var joints = new int[4 * positions.Length];
        var weights = new double[4 * positions.Length];
        for (int v = 0; v < positions.Length; ++v)
        {
            for (int k = 0; k < 3; ++k) vertices[3 * v + k] = positions[v][k];
            BoneWeight own = influences[v];
            new[] { own.boneIndex0, own.boneIndex1, own.boneIndex2, own.boneIndex3 }.CopyTo(joints, 4 * v);
            new double[] { own.weight0, own.weight1, own.weight2, own.weight3 }.CopyTo(weights, 4 * v);
        }
        var inverse = new double[16 * bones.Length];
        for (int j = 0; j < bones.Length; ++j) Write(mesh.bindposes[j], inverse, 16 * j);
        ReadBones();
        int[] triangles = mesh.triangles;
        GCHandle[] pinned = Array.ConvertAll(new object[] { vertices, triangles, joints, weights, inverse, matrices },
            array => GCHandle.Alloc(array, GCHandleType.Pinned));
        IntPtr character = IntPtr.Zero, body = IntPtr.Zero;
        try
        {
            var given = new Skin
            {
                size = (UIntPtr)Marshal.SizeOf<Skin>(), vertices = pinned[0].AddrOfPinnedObject(),
                vertexCount = (UIntPtr)positions.Length, triangles = pinned[1].AddrOfPinnedObject(),
                triangleCount = (UIntPtr)(triangles.Length / 3), joints = pinned[2].AddrOfPinnedObject(),
                weights = pinned[3].AddrOfPinnedObject(), jointFromModel = pinned[4].AddrOfPinnedObject(),
                jointCount = (UIntPtr)bones.Length, poses = pinned[5].AddrOfPinnedObject(), poseCount = (UIntPtr)1,
            };
            Check(lorica_character_make(ref given, IntPtr.Zero, out character));
            var options = new BodyOptions { size = (UIntPtr)Marshal.SizeOf<BodyOptions>(), parts = count };
            if (parts != null) Check(lorica_body_from_bytes(character, parts.bytes, (UIntPtr)parts.bytes.Length, out body));
            else Check(lorica_body_make(character, ref options, out body));
            partCount = (int)lorica_body_part_count(body);
            Check(lorica_live_make(body, out live));
        }
        finally
        {
            foreach (GCHandle one in pinned) one.Free();
            lorica_body_free(body);  // the live body keeps what it needs
            lorica_character_free(character);
        }
    }

    private void OnDisable()
    {
        lorica_live_free(live);
        live = IntPtr.Zero;
    }

    private void LateUpdate()  // after the animation
    {
        ReadBones();
        Check(lorica_live_pose(live, matrices, (UIntPtr)bones.Length));
    }

    /// The nearest hull on the way of a ray, or of a ball that is swept along it.
    public bool Cast(Ray along, float reach, float radius, out int part, out Vector3 point, out Vector3 outward)
    {
        for (int k = 0; k < 3; ++k)
        {
            ray[k] = along.origin[k];
            ray[3 + k] = along.direction[k];
        }
        Check(lorica_live_cast_rays(live, ray, (UIntPtr)1, reach, radius, null, hit, distance, position, normal));
        part = hit[0];
        point = new Vector3((float)position[0], (float)position[1], (float)position[2]);
        outward = new Vector3((float)normal[0], (float)normal[1], (float)normal[2]);
        return part >= 0;
    }

    private void OnDrawGizmos()
    {
        if (!drawn || live == IntPtr.Zero) return;
        for (int p = 0; p < partCount; ++p)
        {
            var hull = new Hull { size = (UIntPtr)Marshal.SizeOf<Hull>() };
            if (lorica_live_hull(live, (UIntPtr)p, ref hull) != 0) return;
            int numbers = 3 * (int)hull.vertexCount, indices = 3 * (int)hull.triangleCount;
            if (points.Length < numbers) points = new double[numbers];
            if (corners.Length < indices) corners = new int[indices];
            if (indices == 0) continue;
            Marshal.Copy(hull.vertices, points, 0, numbers);
            Marshal.Copy(hull.triangles, corners, 0, indices);
            for (int e = 0; e < indices; ++e)
            {
                int a = 3 * corners[e], b = 3 * corners[e % 3 == 2 ? e - 2 : e + 1];
                if (a > b) continue;
                Gizmos.DrawLine(new Vector3((float)points[a], (float)points[a + 1], (float)points[a + 2]),
                    new Vector3((float)points[b], (float)points[b + 1], (float)points[b + 2]));
            }
        }
    }
}
