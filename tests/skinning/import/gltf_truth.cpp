#include "tests/skinning/import/gltf_truth.h"

#include "geometry/files.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/value_of.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace lorica::test {

namespace {

using Json = nlohmann::json;

template <typename T>
T at(std::string_view bytes, std::size_t offset) {
  if (offset + sizeof(T) > bytes.size()) throw std::runtime_error("the truth is only for valid files");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

std::size_t componentBytes(int type) {
  return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
}

}  // namespace

Mat4 rotationMatrix(const Eigen::Vector4d& q) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  return Mat4{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 0},
              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 0},
              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), 0},
              {0, 0, 0, 1}};
}

GltfTruth::GltfTruth(std::string_view glb) {
  std::size_t offset = 12;
  while (offset + 8 <= glb.size()) {
    const auto bytes = at<std::uint32_t>(glb, offset);
    const auto kind = at<std::uint32_t>(glb, offset + 4);
    if (kind == 0x4E4F534A) document_ = Json::parse(glb.substr(offset + 8, bytes));
    if (kind == 0x004E4942) binary_ = glb.substr(offset + 8, bytes);
    offset += 8 + bytes;
  }
}

GltfTruth GltfTruth::ofFile(const std::filesystem::path& file) {
  return GltfTruth(valueOf(readFile(file)));
}

double GltfTruth::stored(const Json& accessor, int view, std::size_t offset, std::size_t element,
                         std::size_t component) const {
  const Json& bufferView = document_["bufferViews"][view];
  const int type = accessor["componentType"];
  const std::size_t size = componentBytes(type);
  const std::size_t tight = size * GlbWriter::componentsOf(accessor.value("type", "SCALAR"));
  const std::size_t byte = bufferView.value("byteOffset", std::size_t{0}) + offset +
                           element * bufferView.value("byteStride", tight) + component * size;
  const bool normalized = accessor.value("normalized", false);
  const auto scaled = [&](double c, double one) { return normalized ? std::max(c / one, -1.0) : c; };
  switch (type) {
    case 5120:
      return scaled(at<std::int8_t>(binary_, byte), 127.0);
    case 5121:
      return scaled(at<std::uint8_t>(binary_, byte), 255.0);
    case 5122:
      return scaled(at<std::int16_t>(binary_, byte), 32767.0);
    case 5123:
      return scaled(at<std::uint16_t>(binary_, byte), 65535.0);
    case 5125:
      return at<std::uint32_t>(binary_, byte);
    default:
      return static_cast<double>(at<float>(binary_, byte));
  }
}

double GltfTruth::number(int index, std::size_t element, std::size_t component) const {
  const std::size_t components = GlbWriter::componentsOf(document_["accessors"][index]["type"]);
  std::vector<double>& numbers = numbers_[index];
  if (numbers.empty()) {
    const std::size_t elements = count(index);
    for (std::size_t e = 0; e < elements; ++e) {
      for (std::size_t c = 0; c < components; ++c) numbers.push_back(numberInFile(index, e, c));
    }
  }
  return numbers.at(element * components + component);
}

double GltfTruth::numberInFile(int index, std::size_t element, std::size_t component) const {
  const Json& accessor = document_["accessors"][index];
  if (accessor.contains("sparse")) {
    const Json& sparse = accessor["sparse"];
    for (std::size_t i = sparse["count"]; i-- > 0;) {
      const Json& indices = sparse["indices"];
      if (stored(indices, indices["bufferView"], indices.value("byteOffset", std::size_t{0}), i, 0) !=
          static_cast<double>(element)) {
        continue;
      }
      const Json& values = sparse["values"];
      return stored(accessor, values["bufferView"], values.value("byteOffset", std::size_t{0}), i, component);
    }
  }
  if (!accessor.contains("bufferView")) return 0.0;
  return stored(accessor, accessor["bufferView"], accessor.value("byteOffset", std::size_t{0}), element, component);
}

std::size_t GltfTruth::count(int accessor) const {
  return document_["accessors"][accessor]["count"];
}

int GltfTruth::animationCount() const {
  return document_.contains("animations") ? static_cast<int>(document_["animations"].size()) : 0;
}

double GltfTruth::seconds(int animation) const {
  double last = 0.0;
  const Json& from = document_["animations"][animation];
  for (const Json& channel : from["channels"]) {
    if (channel["target"]["path"] == "weights") continue;
    const int input = from["samplers"][channel["sampler"].get<std::size_t>()]["input"];
    last = std::max(last, number(input, count(input) - 1, 0));
  }
  return last;
}

// Appendix C.
std::vector<double> GltfTruth::sampled(const Json& sampler, bool rotation, double time, std::size_t scalars) const {
  const int input = sampler["input"];
  const int output = sampler["output"];
  const std::string kind = sampler.value("interpolation", "LINEAR");
  const std::size_t keys = count(input);
  const std::size_t n = scalars > 0 ? scalars : rotation ? 4 : 3;
  const auto value = [&](std::size_t row) {
    std::vector<double> v(n);
    for (std::size_t c = 0; c < n; ++c) v[c] = scalars > 0 ? number(output, row * n + c, 0) : number(output, row, c);
    return v;
  };
  const auto normalised = [&](std::vector<double> v) {
    if (!rotation) return v;
    double sum = 0.0;
    for (const double x : v) sum += x * x;
    for (double& x : v) x /= std::sqrt(sum);
    return v;
  };
  const std::size_t perKey = kind == "CUBICSPLINE" ? 3 : 1;
  const std::size_t middle = kind == "CUBICSPLINE" ? 1 : 0;
  if (time <= number(input, 0, 0)) return normalised(value(middle));
  if (time >= number(input, keys - 1, 0)) return normalised(value(perKey * (keys - 1) + middle));
  std::size_t k = 0;
  while (number(input, k + 1, 0) <= time) ++k;
  const double td = number(input, k + 1, 0) - number(input, k, 0);
  const double t = (time - number(input, k, 0)) / td;
  std::vector<double> result(n);
  if (kind == "STEP") return normalised(value(k));
  if (kind == "CUBICSPLINE") {
    const auto vk = value(3 * k + 1), bk = value(3 * k + 2), a1 = value(3 * k + 3), v1 = value(3 * k + 4);
    for (std::size_t c = 0; c < n; ++c) {
      result[c] = (2 * std::pow(t, 3) - 3 * t * t + 1) * vk[c] + td * (std::pow(t, 3) - 2 * t * t + t) * bk[c] +
                  (-2 * std::pow(t, 3) + 3 * t * t) * v1[c] + td * (std::pow(t, 3) - t * t) * a1[c];
    }
    return normalised(result);
  }
  const auto from = normalised(value(k)), to = normalised(value(k + 1));
  double scaleFrom = 1.0 - t, scaleTo = t;
  if (rotation) {
    double dot = 0.0;
    for (std::size_t c = 0; c < n; ++c) dot += from[c] * to[c];
    const double angle = std::acos(std::min(1.0, std::abs(dot)));
    if (angle > 1e-6) {
      scaleFrom = std::sin(angle * (1.0 - t)) / std::sin(angle);
      scaleTo = std::sin(angle * t) / std::sin(angle);
    }
    if (dot < 0.0) scaleTo = -scaleTo;
  }
  for (std::size_t c = 0; c < n; ++c) result[c] = scaleFrom * from[c] + scaleTo * to[c];
  return normalised(result);
}

Mat4 GltfTruth::local(int index, int animation, double time) const {
  const Json& node = document_["nodes"][index];
  if (node.contains("matrix")) {
    Mat4 m;
    for (int i = 0; i < 16; ++i) m(i % 4, i / 4) = node["matrix"][i].get<double>();
    return m;
  }
  std::vector<double> t = node.value("translation", std::vector<double>{0.0, 0.0, 0.0});
  std::vector<double> r = node.value("rotation", std::vector<double>{0.0, 0.0, 0.0, 1.0});
  std::vector<double> s = node.value("scale", std::vector<double>{1.0, 1.0, 1.0});
  if (animation >= 0) {
    const Json& clip = document_["animations"][animation];
    for (const Json& channel : clip["channels"]) {
      if (channel["target"].value("node", -1) != index) continue;
      const std::string path = channel["target"]["path"];
      const Json& sampler = clip["samplers"][channel["sampler"].get<std::size_t>()];
      if (path == "translation") t = sampled(sampler, false, time);
      if (path == "rotation") r = sampled(sampler, true, time);
      if (path == "scale") s = sampled(sampler, false, time);
    }
  }
  Mat4 m = rotationMatrix(Eigen::Vector4d(r.data()).normalized());
  for (int c = 0; c < 3; ++c) {
    m.block<3, 1>(0, c) *= s[c];
    m(c, 3) = t[c];
  }
  return m;
}

std::vector<Mat4> GltfTruth::globals(int animation, double time) const {
  const Json& nodes = document_["nodes"];
  std::vector<int> parent(nodes.size(), -1);
  std::vector<Mat4> locals;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const Json& child : nodes[i].value("children", Json::array())) {
      parent[child.get<std::size_t>()] = static_cast<int>(i);
    }
    locals.push_back(local(static_cast<int>(i), animation, time));
  }
  std::vector<Mat4> all;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Mat4 m = locals[i];
    for (int p = parent[i]; p != -1; p = parent[p]) m = (locals[p] * m).eval();
    all.push_back(m);
  }
  return all;
}

std::vector<GltfTruth::Corners> GltfTruth::triangles(int animation, double time, bool morphing) const {
  std::vector<Corners> all;
  const Json& nodes = document_["nodes"];
  const std::vector<Mat4> global = globals(animation, time);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].contains("mesh")) continue;
    const Json& mesh = document_["meshes"][nodes[n]["mesh"].get<std::size_t>()];
    std::vector<Mat4> fromMesh;  // of each joint, or of the node
    if (nodes[n].contains("skin")) {
      const Json& skin = document_["skins"][nodes[n]["skin"].get<std::size_t>()];
      for (std::size_t j = 0; j < skin["joints"].size(); ++j) {
        Mat4 inverseBind = Mat4::Identity();
        if (skin.contains("inverseBindMatrices")) {
          for (int i = 0; i < 16; ++i) {
            inverseBind(i % 4, i / 4) = number(skin["inverseBindMatrices"], j, static_cast<std::size_t>(i));
          }
        }
        fromMesh.emplace_back(global[skin["joints"][j].get<std::size_t>()] * inverseBind);
      }
    } else {
      fromMesh.push_back(global[n]);
    }

    for (const Json& primitive : mesh["primitives"]) {
      const int mode = primitive.value("mode", 4);
      if (mode < 4) continue;
      const Json& attributes = primitive["attributes"];
      const std::size_t vertexCount = count(attributes["POSITION"]);
      const Json& weightSource = nodes[n].contains("weights") ? nodes[n] : mesh;
      auto morphWeights = weightSource.value("weights", std::vector<double>{});
      if (morphing && animation >= 0) {
        const Json& clip = document_["animations"][animation];
        for (const Json& channel : clip["channels"]) {
          if (channel["target"]["path"] != "weights" || channel["target"]["node"] != n) continue;
          morphWeights = sampled(clip["samplers"][channel["sampler"].get<std::size_t>()], false, time,
                                 primitive["targets"].size());
        }
      }

      std::vector<Vec3> placed(vertexCount);
      for (std::size_t v = 0; v < vertexCount; ++v) {
        Eigen::Vector4d p(0.0, 0.0, 0.0, 1.0);
        for (int c = 0; c < 3; ++c) {
          p[c] = number(attributes["POSITION"], v, c);
          for (std::size_t t = 0; t < morphWeights.size(); ++t) {
            p[c] += morphWeights[t] * number(primitive["targets"][t]["POSITION"], v, c);
          }
        }
        if (nodes[n].contains("skin") && attributes.contains("JOINTS_0")) {
          Eigen::Vector4d moved = Eigen::Vector4d::Zero();
          double sum = 0.0;
          for (int set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
            for (std::size_t i = 0; i < 4; ++i) {
              const double weight = number(attributes["WEIGHTS_" + std::to_string(set)], v, i);
              if (weight == 0.0) continue;
              const double joint = number(attributes["JOINTS_" + std::to_string(set)], v, i);
              moved += weight * (fromMesh[joint] * p);
              sum += weight;
            }
          }
          placed[v] = moved.head<3>() / sum;
        } else {
          placed[v] = (fromMesh.front() * p).head<3>();
        }
      }

      std::vector<std::size_t> indices;
      const std::size_t indexCount = primitive.contains("indices") ? count(primitive["indices"]) : vertexCount;
      for (std::size_t i = 0; i < indexCount; ++i) {
        indices.push_back(primitive.contains("indices") ? static_cast<std::size_t>(number(primitive["indices"], i, 0))
                                                        : i);
      }
      const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        if (indices[a] == indices[b] || indices[b] == indices[c] || indices[c] == indices[a]) return;
        all.push_back({placed[indices[a]], placed[indices[b]], placed[indices[c]]});
      };
      for (std::size_t i = 0; i + 2 < indexCount; i += mode == 4 ? 3 : 1) {
        if (mode == 4) add(i, i + 1, i + 2);
        if (mode == 5) add(i, i + (1 + i % 2), i + (2 - i % 2));
        if (mode == 6) add(i + 1, i + 2, 0);
      }
    }
  }
  return all;
}

}  // namespace lorica::test
