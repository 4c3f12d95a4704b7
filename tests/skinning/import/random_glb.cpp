#include "tests/skinning/import/random_glb.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "tests/skinning/import/glb_writer.h"

#include <array>
#include <cmath>

namespace lorica::test {

namespace {

using Json = nlohmann::json;

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  std::string make() {
    addNodes();
    for (int skins = below(4); skins > 0; --skins) addSkin();
    for (int meshes = 1 + below(4); meshes > 0; --meshes) addMesh();
    for (int clips = below(3); clips > 0; --clips) addClip();
    return out_.glb();
  }

 private:
  int below(int count) { return static_cast<int>(random_.bits() % static_cast<std::uint64_t>(count)); }
  bool oneIn(int count) { return below(count) == 0; }
  float between(double low, double high) { return static_cast<float>(random_.between(low, high)); }
  std::vector<float> floats(int count, double size) {
    std::vector<float> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(between(-size, size));
    return numbers;
  }
  std::vector<float> rotation() {
    std::vector<float> q = floats(4, 1.0);
    float norm = 0.0F;
    for (const float x : q) norm += x * x;
    norm = std::sqrt(norm) + 1e-6F;
    for (float& x : q) x /= norm;
    return q;
  }

  void addNodes() {
    nodeCount_ = 3 + below(10);
    for (int i = 0; i < nodeCount_; ++i) {
      Json node = {{"name", std::to_string(i)}};
      if (oneIn(4)) {
        std::vector<float> m = floats(16, 1.0);
        for (const int c : {0, 5, 10}) m[c] += 1.5F;  // sheared, but not flat
        for (const int c : {3, 7, 11}) m[c] = 0.0F;
        m[15] = 1.0F;
        node["matrix"] = m;
        fixed_.push_back(true);
      } else {
        if (!oneIn(3)) node["translation"] = floats(3, 1.0);
        if (!oneIn(3)) node["rotation"] = rotation();
        if (oneIn(3)) node["scale"] = {between(0.5, 2.0), between(-2.0, -0.5), between(0.5, 2.0)};
        if (oneIn(4)) node["scale"] = {1.5, 1.5, 1.5};
        fixed_.push_back(false);
      }
      out_.add("nodes", node);
      // Parents at lower or higher indices: any tree is valid.
      if (i > 0 && !oneIn(5)) out_.document["nodes"][below(i)]["children"].push_back(i);
    }
  }

  void addSkin() {
    Json skin;
    std::vector<int> joints;
    for (int n = 0; n < nodeCount_; ++n) {
      if (!oneIn(3)) joints.push_back(n);
    }
    if (joints.empty()) joints.push_back(0);
    skin["joints"] = joints;
    if (!oneIn(4)) {
      std::vector<Affine3> inverseBinds;
      for (std::size_t j = 0; j < joints.size(); ++j) {
        Affine3 m = Affine3::Identity();
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 4; ++c) m.matrix()(r, c) += random_.between(-0.4, 0.4);
        }
        inverseBinds.push_back(m);
      }
      skin["inverseBindMatrices"] = out_.matrices(inverseBinds);
    }
    skinSizes_.push_back(countOf(joints));
    out_.add("skins", skin);
  }

  int addPositions(int vertices) {
    switch (below(4)) {
      case 0: {  // normalised shorts
        std::vector<std::int16_t> shorts;
        for (int i = 0; i < 3 * vertices; ++i) shorts.push_back(static_cast<std::int16_t>(random_.bits()));
        return out_.accessor(shorts, "VEC3", true, 8);
      }
      case 1: {  // zeros, with some replaced
        std::vector<std::uint16_t> rows;
        for (int v = 0; v < vertices; v += 2) rows.push_back(static_cast<std::uint16_t>(v));
        const int rowView = out_.view(rows);
        const int valueView = out_.view(floats(3 * countOf(rows), 1.0));
        return out_.add("accessors", {{"componentType", 5126},
                                      {"count", vertices},
                                      {"type", "VEC3"},
                                      {"sparse", sparse(rows.size(), rowView, 5123, valueView)}});
      }
      case 2: {  // floats with a stride, some replaced
        const int base = out_.accessor(floats(3 * vertices, 1.0), "VEC3", false, 20);
        const std::vector<std::uint32_t> rows = {1, static_cast<std::uint32_t>(vertices - 1)};
        const int rowView = out_.view(rows);
        const int valueView = out_.view(floats(6, 1.0));
        out_.document["accessors"][base]["sparse"] = sparse(2, rowView, 5125, valueView);
        return base;
      }
      default:
        return out_.accessor(floats(3 * vertices, 1.0), "VEC3");
    }
  }

  void addInfluences(Json& attributes, int vertices, int bones) {
    const int sets = 1 + below(2);
    const int kind = below(3);
    for (int set = 0; set < sets; ++set) {
      std::vector<std::uint8_t> joints8;
      std::vector<std::uint16_t> joints16;
      std::vector<float> weights;
      std::vector<std::uint8_t> weights8;
      std::vector<std::uint16_t> weights16;
      for (int v = 0; v < vertices; ++v) {
        // Fractions of 1 that bytes and shorts can store: k / 255 and k / 65535 with sums of 255 and 65535.
        std::array<int, 4> shares{};
        const int whole = kind == 1 ? 255 : 65535;
        int left = set + 1 < sets ? whole / 2 : sets == 1 ? whole : whole - whole / 2;
        for (std::size_t i = 0; i < 4; ++i) {
          shares[i] = i == 3 ? left : below(left + 1);
          left -= shares[i];
          const int bone = below(bones);
          joints8.push_back(static_cast<std::uint8_t>(bone));
          joints16.push_back(static_cast<std::uint16_t>(bone));
          weights8.push_back(static_cast<std::uint8_t>(shares[i]));
          weights16.push_back(static_cast<std::uint16_t>(shares[i]));
          weights.push_back(static_cast<float>(shares[i]) / static_cast<float>(whole));
        }
      }
      const std::string name = std::to_string(set);
      attributes["JOINTS_" + name] = oneIn(2) ? out_.accessor(joints8, "VEC4") : out_.accessor(joints16, "VEC4");
      attributes["WEIGHTS_" + name] = kind == 0   ? out_.accessor(weights, "VEC4")
                                      : kind == 1 ? out_.accessor(weights8, "VEC4", true)
                                                  : out_.accessor(weights16, "VEC4", true);
    }
  }

  void addMesh() {
    const int node = below(nodeCount_);
    Json& drawn = out_.document["nodes"][node];
    if (drawn.contains("mesh")) return;
    const int skin = skinSizes_.empty() || oneIn(3) ? -1 : below(countOf(skinSizes_));
    const int targets = oneIn(3) ? 2 : 0;
    Json mesh;
    const int primitives = 1 + below(2);
    for (int p = 0; p < primitives; ++p) {
      const int vertices = 4 + below(9);
      Json primitive;
      primitive["attributes"]["POSITION"] = addPositions(vertices);
      for (int t = 0; t < targets; ++t) primitive["targets"].push_back({{"POSITION", addPositions(vertices)}});
      if (skin != -1) addInfluences(primitive["attributes"], vertices, skinSizes_[skin]);
      if (!oneIn(3)) primitive["mode"] = 4 + below(3);
      if (!oneIn(3)) {
        std::vector<std::uint8_t> indices;
        for (int i = 0; i < 3 + 3 * below(8); ++i) indices.push_back(static_cast<std::uint8_t>(below(vertices)));
        primitive["indices"] = out_.accessor(indices, "SCALAR");
      }
      mesh["primitives"].push_back(primitive);
    }
    if (targets > 0) mesh["weights"] = {0.5, -0.25};
    Json& position = out_.document["nodes"][node];
    if (targets > 0 && oneIn(2)) position["weights"] = {0.0, 1.0};
    position["mesh"] = out_.add("meshes", mesh);
    if (skin != -1) position["skin"] = skin;
  }

  void addClip() {
    Json clip;
    for (int n = 0; n < nodeCount_; ++n) {
      if (fixed_[n] || oneIn(3)) continue;
      for (const std::string path : {"translation", "rotation", "scale"}) {
        if (oneIn(2)) continue;
        const std::array<const char*, 3> kinds = {"STEP", "LINEAR", "CUBICSPLINE"};
        const int kind = below(3);
        const int keys = 1 + below(4);
        std::vector<float> times = {between(0.0, 0.5)};
        for (int k = 1; k < keys; ++k) times.push_back(times.back() + between(0.1, 1.0));
        std::vector<float> values;
        for (int k = 0; k < keys * (kind == 2 ? 3 : 1); ++k) {
          std::vector<float> value = path == "rotation" ? rotation() : floats(3, 1.0);
          if (path == "scale") value = {between(0.5, 2.0), between(0.5, 2.0), between(0.5, 2.0)};
          values.insert(values.end(), value.begin(), value.end());
        }
        const int input = out_.accessor(times, "SCALAR");
        int output = 0;
        if (path == "rotation" && kind != 2 && oneIn(2)) {  // normalised shorts
          std::vector<std::int16_t> shorts;
          for (const float x : values) shorts.push_back(static_cast<std::int16_t>(std::lround(32767.0F * x)));
          output = out_.accessor(shorts, "VEC4", true);
        } else {
          output = out_.accessor(values, path == "rotation" ? "VEC4" : "VEC3");
        }
        const std::size_t sampler = clip.contains("samplers") ? clip["samplers"].size() : 0;
        clip["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", kinds[kind]}});
        clip["channels"].push_back({{"sampler", sampler}, {"target", {{"node", n}, {"path", path}}}});
      }
    }
    if (!clip.is_null()) out_.add("animations", clip);
  }

  RandomNumbers random_;
  GlbWriter out_;
  int nodeCount_ = 0;
  std::vector<bool> fixed_;
  std::vector<int> skinSizes_;
};

}  // namespace

std::string randomGlb(std::uint64_t seed) {
  return Maker(seed).make();
}

}  // namespace lorica::test
