#include "geometry/files.h"
#include "geometry/math.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/gltf_truth.h"
#include "tests/support/datasets.h"
#include "tests/support/utf16.h"
#include "tests/support/value_of.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <gtest/gtest.h>

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lorica::test {
namespace {

Mat4 matrixOf(const aiMatrix4x4& m) {
  Mat4 out;
  out << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return out;
}

template <typename Key>
std::pair<unsigned, double> keyAt(const Key* keys, unsigned count, double tick) {
  if (tick <= keys[0].mTime) return {0, 0.0};
  if (tick >= keys[count - 1].mTime) return {count - 1, 0.0};
  unsigned k = 0;
  while (keys[k + 1].mTime <= tick) ++k;
  return {k, (tick - keys[k].mTime) / (keys[k + 1].mTime - keys[k].mTime)};
}

Vec3 vectorAt(const aiVectorKey* keys, unsigned count, double tick) {
  const auto [k, part] = keyAt(keys, count, tick);
  const aiVector3D& a = keys[k].mValue;
  const aiVector3D& b = keys[std::min(k + 1, count - 1)].mValue;
  return (1.0 - part) * Vec3(a.x, a.y, a.z) + part * Vec3(b.x, b.y, b.z);
}

Eigen::Vector4d rotationAt(const aiQuatKey* keys, unsigned count, double tick) {
  const auto [k, part] = keyAt(keys, count, tick);
  const aiQuaternion& qa = keys[k].mValue;
  const aiQuaternion& qb = keys[std::min(k + 1, count - 1)].mValue;
  const Eigen::Vector4d a = Eigen::Vector4d(qa.x, qa.y, qa.z, qa.w).normalized();
  Eigen::Vector4d b = Eigen::Vector4d(qb.x, qb.y, qb.z, qb.w).normalized();
  if (a.dot(b) < 0.0) b = -b;
  const double angle = std::acos(std::min(1.0, a.dot(b)));
  if (angle < 1e-6) return a;
  return std::sin((1.0 - part) * angle) / std::sin(angle) * a + std::sin(part * angle) / std::sin(angle) * b;
}

void addNode(const aiScene& scene, const aiNode& node, const Mat4& parent, int animation, double seconds,
             std::map<std::string, Mat4>& all) {
  Mat4 local = matrixOf(node.mTransformation);
  if (animation >= 0) {
    const aiAnimation& clip = *scene.mAnimations[animation];
    const double tick = seconds * (clip.mTicksPerSecond > 0.0 ? clip.mTicksPerSecond : 25.0);
    for (unsigned c = 0; c < clip.mNumChannels; ++c) {
      const aiNodeAnim& channel = *clip.mChannels[c];
      if (channel.mNodeName != node.mName) continue;
      const Eigen::Vector4d q = rotationAt(channel.mRotationKeys, channel.mNumRotationKeys, tick);
      local = rotationMatrix(q);
      const Vec3 scale = vectorAt(channel.mScalingKeys, channel.mNumScalingKeys, tick);
      for (int i = 0; i < 3; ++i) local.col(i) *= scale[i];
      local.block<3, 1>(0, 3) = vectorAt(channel.mPositionKeys, channel.mNumPositionKeys, tick);
    }
  }
  const Mat4 global = parent * local;
  all.emplace(node.mName.C_Str(), global);
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    addNode(scene, *node.mChildren[c], global, animation, seconds, all);
  }
}

void addCorners(const aiScene& scene, const aiNode& node, const std::map<std::string, Mat4>& nodes,
                std::vector<Vec3>& corners) {
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    std::vector<Eigen::Vector4d> placed(mesh.mNumVertices, Eigen::Vector4d::Zero());
    std::vector<double> sums(mesh.mNumVertices, 0.0);
    const auto point = [&](unsigned v) {
      return Eigen::Vector4d(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z, 1.0);
    };
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const Mat4 carry = nodes.at(mesh.mBones[b]->mName.C_Str()) * matrixOf(mesh.mBones[b]->mOffsetMatrix);
      for (unsigned w = 0; w < mesh.mBones[b]->mNumWeights; ++w) {
        const aiVertexWeight& weight = mesh.mBones[b]->mWeights[w];
        placed[weight.mVertexId] += static_cast<double>(weight.mWeight) * (carry * point(weight.mVertexId));
        sums[weight.mVertexId] += static_cast<double>(weight.mWeight);
      }
    }
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      if (mesh.mNumBones == 0) placed[v] = nodes.at(node.mName.C_Str()) * point(v);
      if (mesh.mNumBones > 0) placed[v] /= sums[v];
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices != 3) continue;
      for (unsigned c = 0; c < 3; ++c) corners.emplace_back(placed[mesh.mFaces[f].mIndices[c]].head<3>());
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) addCorners(scene, *node.mChildren[c], nodes, corners);
}

/// Transforms of assimp's nodes with linear keys, computed by 4x4 matrices without any code of import/. In the file's
/// units and axes.
/// @param animation  -1: at rest
std::map<std::string, Mat4> assimpNodes(const aiScene& scene, int animation, double seconds) {
  std::map<std::string, Mat4> all;
  addNode(scene, *scene.mRootNode, Mat4::Identity(), animation, seconds, all);
  return all;
}

/// The corners of all triangles, skinned as assimp defines it: the sum of weight * node * offset * vertex, divided by
/// the sum of the weights. Nodes in assimp's order, their meshes, their faces.
std::vector<Vec3> assimpCorners(const aiScene& scene, int animation, double seconds) {
  std::vector<Vec3> corners;
  addCorners(scene, *scene.mRootNode, assimpNodes(scene, animation, seconds), corners);
  return corners;
}

/// A file read by Lorica, and by assimp for comparison.
struct Both {
  Both(const std::filesystem::path& path, bool fbx) : file(readCharacterFile(path)) {
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, !fbx);
    scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  }
  Result<CharacterFile> file;
  Assimp::Importer importer;
  const aiScene* scene = nullptr;
};

/// The largest distance of joints from assimp's nodes of the same name [m].
double farthestJoint(const CharacterFile& file, const aiScene& scene, int clip, double time) {
  const Skeleton& skeleton = file.character.skeleton;
  Pose pose = restPose(skeleton);
  if (clip >= 0) sampleClip(file.clips[clip], time, pose);
  std::vector<Affine3> worldFromJoint(pose.size());
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  const std::map<std::string, Mat4> nodes = test::assimpNodes(scene, clip, time);
  double farthest = 0.0;
  int found = 0;
  for (int j = 0; j < skeleton.jointCount(); ++j) {
    const auto node = nodes.find(skeleton.joint(j).name);
    if (node == nodes.end()) continue;
    ++found;
    const Vec3 expected = file.metresPerUnit * node->second.block<3, 1>(0, 3);
    farthest = std::max(farthest, (worldFromJoint[j].translation() - expected).norm());
  }
  EXPECT_GT(found, 5);
  return farthest;
}

double farthestCorner(const CharacterFile& file, const aiScene& scene, int clip, double time) {
  const std::vector<Vec3> posed = test::posedVertices(file, clip, time);
  const std::vector<Vec3> expected = test::assimpCorners(scene, clip, time);
  EXPECT_EQ(3 * file.character.mesh.triangles.size(), expected.size());
  double farthest = 0.0;
  std::size_t corner = 0;
  for (const Triangle& triangle : file.character.mesh.triangles) {
    for (const VertexIndex v : triangle) {
      farthest = std::max(farthest, (posed[v] - file.metresPerUnit * expected[corner]).norm());
      ++corner;
    }
  }
  return farthest;
}

TEST(FbxFile, ACharacterInCentimetresStandsInMetres) {
  LORICA_REQUIRE_DATASET(path, "characters/arnaud/arnaud.fbx");
  const Both both(path, true);
  ASSERT_TRUE(both.file.ok()) << both.file.error().message;
  ASSERT_NE(both.scene, nullptr);
  const CharacterFile& file = *both.file;
  EXPECT_EQ(file.format, "FBX");
  EXPECT_EQ(file.metresPerUnit, 0.01);
  EXPECT_NEAR(file.character.height, 1.83, 0.01);
  EXPECT_EQ(file.character.mesh.triangles.size(), 6670u);
  EXPECT_EQ(file.repairedVertices, 0);
  EXPECT_LE(farthestCorner(file, *both.scene, -1, 0.0), 1e-5 * file.character.height);
  // Once welded it is the closed surface that its source describes.
  TriMesh welded = file.character.mesh;
  weldEqualVertices(welded);
  EXPECT_EQ(welded.vertices.size(), 3337u);
  EXPECT_TRUE(checkClosedTwoManifold(welded).ok());
}

TEST(FbxFile, ClipFilesMoveTheSameJoints) {
  LORICA_REQUIRE_DATASET(character, "characters/arnaud/arnaud.fbx");
  const CharacterFile body = test::valueOf(readCharacterFile(character));
  for (const std::string name : {"run", "walk", "crossarms", "atlas"}) {
    SCOPED_TRACE(name);
    const Both both(test::dataset("characters/arnaud/" + name + ".fbx"), true);
    ASSERT_TRUE(both.file.ok()) << both.file.error().message;
    ASSERT_NE(both.scene, nullptr);
    const CharacterFile& clipFile = *both.file;
    EXPECT_TRUE(clipFile.character.mesh.vertices.empty());
    ASSERT_EQ(clipFile.clips.size(), 1u);
    const Clip& clip = clipFile.clips[0];
    EXPECT_GT(clip.seconds, 0.5);
    for (const double part : {0.0, 0.31, 0.77, 1.0}) {
      EXPECT_LE(farthestJoint(clipFile, *both.scene, 0, part * clip.seconds), 1.8e-5);
    }
    // All 53 bones of the body exist by name.
    int shared = 0;
    for (const Joint& joint : body.character.skeleton.joints()) {
      const auto joints = clipFile.character.skeleton.joints();
      shared += std::any_of(joints.begin(), joints.end(), [&](const Joint& j) { return j.name == joint.name; }) ? 1 : 0;
    }
    EXPECT_GE(shared, 53);
  }
}

TEST(FbxFile, SkinsAndClipsInOneFileAgreeWithAssimpsOwnMeaning) {
  int seen = 0;
  for (const char* name : {"huesitos.fbx", "animation_with_skeleton.fbx"}) {
    const std::filesystem::path path = std::filesystem::path("/usr/share/assimp/models/FBX") / name;
    if (!std::filesystem::exists(path)) continue;
    ++seen;
    const Both both(path, true);
    ASSERT_TRUE(both.file.ok()) << both.file.error().message;
    ASSERT_NE(both.scene, nullptr);
    for (const double time : {0.0, 0.25, 0.61, 2.0}) {
      EXPECT_LE(farthestCorner(*both.file, *both.scene, 0, time), 1e-5 * both.file->character.height) << name;
    }
  }
  if (seen == 0) GTEST_SKIP() << "the Debian package assimp-testmodels is not installed";
}

/// A tetrahedron 0, x, y, z in a text FBX file.
std::string fbxText(const std::string& settings) {
  return "; FBX 7.3.0 project file\n"
         "FBXHeaderExtension:  {\n FBXHeaderVersion: 1003\n FBXVersion: 7300\n}\n"
         "GlobalSettings:  {\n Version: 1000\n Properties70:  {\n" +
         settings +
         " }\n}\n"
         "Objects:  {\n"
         " Geometry: 100, \"Geometry::\", \"Mesh\" {\n"
         "  Vertices: *12 {\n   a: 0,0,0,100,0,0,0,100,0,0,0,100\n  }\n"
         "  PolygonVertexIndex: *12 {\n   a: 0,2,-2,0,1,-4,0,3,-3,1,2,-4\n  }\n"
         " }\n"
         " Model: 200, \"Model::Tetra\", \"Mesh\" {\n  Version: 232\n }\n"
         "}\n"
         "Connections:  {\n C: \"OO\",200,0\n C: \"OO\",100,200\n}\n";
}

std::string property(const std::string& name, int value) {
  return "  P: \"" + name + "\", \"int\", \"Integer\", \"\"," + std::to_string(value) + "\n";
}

Result<CharacterFile> parsedText(const std::string& text, const std::string& name) {
  return parseCharacterFile(std::as_bytes(std::span(text)), name);
}

/// The tetrahedron with a shape that moves its fourth corner by 50 cm in y.
std::string fbxMorphText() {
  std::string text = fbxText("");
  const auto insert = [&](const std::string& before, const std::string& what) { text.insert(text.find(before), what); };
  insert(
      " Model: 200",
      " Geometry: 101, \"Geometry::Smile\", \"Shape\" {\n  Indexes: *1 {\n   a: 3\n  }\n  Vertices: *3 {\n   a: "
      "0,50,0\n  }\n  Normals: *3 {\n   a: 0,0,0\n  }\n }\n"
      " Deformer: 300, \"Deformer::\", \"BlendShape\" {\n }\n"
      " Deformer: 301, \"SubDeformer::Smile\", \"BlendShapeChannel\" {\n  DeformPercent: 0\n  FullWeights: *1 {\n   a: "
      "100\n  }\n }\n");
  text.insert(text.rfind("}\n"), " C: \"OO\",300,100\n C: \"OO\",301,300\n C: \"OO\",101,301\n");
  return text;
}

TEST(FbxFile, ShapesAreMorphTargetsInMetres) {
  const CharacterFile file = test::valueOf(parsedText(fbxMorphText(), "t.fbx"));
  ASSERT_EQ(file.morphs.targets.size(), 1u);
  const MorphTarget& smile = file.morphs.targets[0];
  EXPECT_NE(smile.name.find("Smile"), std::string::npos) << smile.name;
  EXPECT_EQ(smile.defaultWeight, 0.0F);
  ASSERT_EQ(smile.offsets.size(), 3u);  // each face has its own corner there
  for (const MorphOffset& offset : smile.offsets) {
    EXPECT_NEAR(file.character.mesh.vertices[offset.vertex].z(), 1.0, 1e-6);
    EXPECT_TRUE(offset.position.isApprox(Vec3f(0.0F, 0.5F, 0.0F), 1e-5F)) << offset.position.transpose();
  }
  ASSERT_EQ(file.expressions.list.size(), 1u);
  EXPECT_EQ(file.expressions.list[0].name, smile.name);
}

/// The same with a clip that moves the shape to 100, then to 25 percent.
/// @param range  properties of the clip
std::string fbxMorphClipText(const std::string& range) {
  std::string text = fbxMorphText();
  text.insert(text.find(" Model: 200"),
              " AnimationStack: 400, \"AnimStack::Grin\", \"\" {\n" + range +
                  " }\n"
                  " AnimationLayer: 401, \"AnimLayer::Base\", \"\" {\n }\n"
                  " AnimationCurveNode: 402, \"AnimCurveNode::DeformPercent\", \"\" {\n  Properties70:  {\n   P: "
                  "\"d|DeformPercent\", \"Number\", \"\", \"A\",0\n  }\n }\n"
                  " AnimationCurve: 403, \"AnimCurve::\", \"\" {\n  Default: 0\n  KeyVer: 4008\n  KeyTime: *3 {\n   a: "
                  "0,46186158000,92372316000\n  }\n  KeyValueFloat: *3 {\n   a: 0,100,25\n  }\n }\n");
  text.insert(text.rfind("}\n"),
              " C: \"OO\",401,400\n C: \"OO\",402,401\n C: \"OP\",402,301, \"DeformPercent\"\n C: \"OP\",403,402, "
              "\"d|DeformPercent\"\n");
  return text;
}

TEST(FbxFile, ClipsMoveItsShapes) {
  const std::string twoSeconds =
      "  Properties70:  {\n   P: \"LocalStop\", \"KTime\", \"Time\", \"\",92372316000\n  }\n";
  for (const std::string& range : {std::string(), twoSeconds}) {
    const CharacterFile file = test::valueOf(parsedText(fbxMorphClipText(range), "t.fbx"));
    ASSERT_EQ(file.clips.size(), 1u);
    ASSERT_EQ(file.morphs.clips.size(), 1u);
    for (const std::string& note : file.notes) EXPECT_EQ(note.find("weights"), std::string::npos) << note;
    std::vector<float> weights = {-1.0F};
    for (const auto& [time, weight] : {std::pair(0.0, 0.0F), {0.25, 0.25F}, {1.0, 1.0F}, {1.5, 0.625F}, {9.0, 0.25F}}) {
      sampleMorphWeights(file.morphs.clips[0], time, weights);
      EXPECT_NEAR(weights[0], weight, 1e-5F) << time;
    }
  }
}

TEST(FbxFile, ItsUnitAndAxesAreFollowed) {
  // Z up, -Y to the front, as in 3ds Max; the unit is 2 cm.
  const std::string settings = property("UpAxis", 2) + property("UpAxisSign", 1) + property("FrontAxis", 1) +
                               property("FrontAxisSign", -1) + property("CoordAxis", 0) + property("CoordAxisSign", 1) +
                               "  P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",2\n";
  const CharacterFile file = test::valueOf(parsedText(fbxText(settings), "t.fbx"));
  EXPECT_NEAR(file.metresPerUnit, 0.02, 1e-12);
  const Aabb box = boundsOf(file.character.mesh.vertices);
  EXPECT_NEAR((box.min - Vec3(0.0, 0.0, -2.0)).norm(), 0.0, 1e-6) << box.min;
  EXPECT_NEAR((box.max - Vec3(2.0, 2.0, 0.0)).norm(), 0.0, 1e-6) << box.max;
  EXPECT_NEAR(signedVolume(file.character.mesh.vertices, file.character.mesh.triangles), 8.0 / 6.0, 1e-6);

  const CharacterFile plain = test::valueOf(parsedText(fbxText(""), "t.fbx"));
  EXPECT_EQ(plain.metresPerUnit, 0.01);
  EXPECT_NEAR((boundsOf(plain.character.mesh.vertices).max - Vec3::Ones()).norm(), 0.0, 1e-6);
}

TEST(FbxFile, ThatIsTooOldSaysSo) {
  std::string old = fbxText("");
  old.replace(old.find("7300"), 4, "6100");
  const Result<CharacterFile> text = parsedText(old, "t.fbx");
  ASSERT_FALSE(text.ok());
  EXPECT_EQ(text.error().message, "t.fbx: FBX 6.1 is too old: export it as FBX 7.x (2011 or later)");
  const Result<CharacterFile> binary =
      parsedText(std::string("Kaydara FBX Binary  \0\x1a\0\x70\x17\0\0", 27) + std::string(100, '\0'), "b.fbx");
  ASSERT_FALSE(binary.ok());
  EXPECT_EQ(binary.error().message, "b.fbx: FBX 6.0 is too old: export it as FBX 7.x (2011 or later)");
}

/// A tetrahedron whose corner at z follows the bone "tip", the others "root"; "tip" is 60 cm above "root".
std::string colladaText(const std::string& upAxis) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>)" +
         upAxis + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
 <source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 0 100 0 0 0 100</float_array>
  <technique_common><accessor source="#pa" count="4" stride="3">
   <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
 </source>
 <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
 <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
  <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g">
 <bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
 <source id="j"><Name_array id="ja" count="2">root tip</Name_array>
  <technique_common><accessor source="#ja" count="2" stride="1"><param name="JOINT" type="name"/></accessor></technique_common>
 </source>
 <source id="b"><float_array id="ba" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
  1 0 0 0 0 1 0 0 0 0 1 -60 0 0 0 1</float_array>
  <technique_common><accessor source="#ba" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common>
 </source>
 <source id="w"><float_array id="wa" count="1">1</float_array>
  <technique_common><accessor source="#wa" count="1" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common>
 </source>
 <joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints>
 <vertex_weights count="4"><input semantic="JOINT" source="#j" offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/>
  <vcount>1 1 1 1</vcount><v>0 0 0 0 0 0 1 0</v></vertex_weights>
</skin></controller></library_controllers>
<library_visual_scenes><visual_scene id="s">
 <node id="root" sid="root" name="root" type="JOINT">
  <node id="tip" sid="tip" name="tip" type="JOINT"><translate>0 0 60</translate></node></node>
 <node id="n" name="body"><instance_controller url="#c"><skeleton>#root</skeleton></instance_controller></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>)";
}

TEST(ColladaFile, BlanksAroundItsUpAxisDoNotMatter) {
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    const CharacterFile expected = test::valueOf(parsedText(colladaText(up), "t.dae"));
    for (const std::string& blank : {up + " ", "\n\t" + up, "\r\n  " + up + "\n"}) {
      const CharacterFile file = test::valueOf(parsedText(colladaText(blank), "t.dae"));
      EXPECT_EQ(file.character.mesh.vertices, expected.character.mesh.vertices) << blank;
    }
  }
  EXPECT_FALSE(parsedText(colladaText(" ").substr(0, 200), "t.dae").ok());
}

TEST(ColladaFile, InUtf16IsAsInUtf8) {
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    const std::string text = colladaText(up);
    const CharacterFile expected = test::valueOf(parsedText(text, "t.dae"));
    for (const bool little : {true, false}) {
      for (const bool mark : {true, false}) {
        const CharacterFile file = test::valueOf(parsedText(test::asUtf16(text, little, mark), "t.dae"));
        EXPECT_EQ(file.format, "COLLADA");
        EXPECT_EQ(file.character.mesh.vertices, expected.character.mesh.vertices) << up;
        EXPECT_EQ(file.skins, 1);
      }
    }
  }
  const Result<CharacterFile> half = parsedText(test::asUtf16(colladaText("Y_UP").substr(0, 900), true, true), "t.dae");
  EXPECT_FALSE(half.ok());
}

TEST(ColladaFile, ItsUnitAxesAndSkinAreFollowed) {
  for (const bool zUp : {false, true}) {
    const CharacterFile file = test::valueOf(parsedText(colladaText(zUp ? "Z_UP" : "Y_UP"), "t.dae"));
    EXPECT_EQ(file.format, "COLLADA");
    EXPECT_EQ(file.skins, 1);
    EXPECT_EQ(file.repairedVertices, 0);
    EXPECT_NEAR(file.character.height, 1.0, 1e-6);
    EXPECT_NEAR(signedVolume(file.character.mesh.vertices, file.character.mesh.triangles), 1.0 / 6.0, 1e-6);
    // The position of the bone's tip, with Y up.
    const Skeleton& skeleton = file.character.skeleton;
    Pose pose = restPose(skeleton);
    std::vector<Affine3> worldFromJoint(pose.size());
    computeWorldFromJoint(skeleton, pose, worldFromJoint);
    bool found = false;
    for (int j = 0; j < skeleton.jointCount(); ++j) {
      if (skeleton.joint(j).name != "tip") continue;
      found = true;
      const Vec3 expected = zUp ? Vec3(0.0, 0.6, 0.0) : Vec3(0.0, 0.0, 0.6);
      EXPECT_NEAR((worldFromJoint[j].translation() - expected).norm(), 0.0, 1e-6);
    }
    EXPECT_TRUE(found);
    // At rest the skin is as it was bound.
    const std::vector<Vec3> rest = test::posedVertices(file, -1, 0.0);
    for (std::size_t v = 0; v < rest.size(); ++v) {
      EXPECT_NEAR((rest[v] - file.character.mesh.vertices[v]).norm(), 0.0, 1e-6);
    }
  }
}

TEST(AssimpFile, BrokenFilesAreRefusedInASentence) {
  const std::string fbx = fbxText("");
  for (const std::size_t length : {30u, 120u, 400u}) {
    const Result<CharacterFile> file = parsedText(fbx.substr(0, length), "t.fbx");
    ASSERT_FALSE(file.ok()) << length;
    EXPECT_EQ(file.error().message.substr(0, 7), "t.fbx: ") << file.error().message;
  }
  const std::string collada = colladaText("Y_UP");
  for (std::size_t length = 100; length < collada.size() - 12; length += 500) {
    const Result<CharacterFile> file = parsedText(collada.substr(0, length), "t.dae");
    ASSERT_FALSE(file.ok()) << length;
    EXPECT_EQ(file.error().message.substr(0, 23), "t.dae: broken COLLADA: ") << file.error().message;
  }
}

TEST(ColladaFile, WhatAssimpDoesNotBearIsRefusedBefore) {
  struct Row {
    std::string from, to, message;
  };
  for (const auto& [from, to, message] : std::initializer_list<Row>{
           {"<p>0 2 1", "<p>0 x 1", "line 11: <p> contains byte 120, expected whole numbers"},
           {"<v>0 0", "<v>0 \x9e", "line 27: <v> contains byte 158, expected whole numbers"},
           {R"(count="32")", R"(count="-2")", "line 18: <float_array> has no count, expected a whole number"},
           {R"(count="32")", R"(count="4000000000")",
            "line 18: <float_array> declares 4,000,000,000 values in 67 bytes"},
           {R"(count="2" stride="16")", R"(count="3" stride="16")",
            "line 20: <accessor> reads 48 values of 'ba', which has 32"},
           {R"(source="#pa")", R"(source="#pb")", "line 6: <accessor> reads from 'pb', which does not exist"},
           {"<library_geometries>", "<!-- <p>x</p> --><library_geometries>", "read"}}) {
    std::string text = colladaText("Y_UP");
    text.replace(text.find(from), from.size(), to);
    const Result<CharacterFile> file = parsedText(text, "t.dae");
    EXPECT_EQ(file.ok() ? "t.dae: read" : file.error().message, "t.dae: " + message);
  }
}

TEST(AssimpFile, EveryShortenedBinaryFbxFailsCleanlyOrReadsWhatIsThere) {
  LORICA_REQUIRE_DATASET(path, "characters/arnaud/run.fbx");
  const std::string whole = test::valueOf(readFile(path));
  int refused = 0;
  for (std::size_t length = 23; length < whole.size(); length += length < 200 ? 13 : 33331) {
    const Result<CharacterFile> file = parsedText(whole.substr(0, length), "t.fbx");
    if (!file.ok()) ++refused;
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace lorica::test
