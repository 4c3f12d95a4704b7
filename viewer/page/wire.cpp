#include "viewer/page/wire.h"

#include "geometry/counts.h"
#include "geometry/little_endian.h"

#include <turbojpeg.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

enum class Section : std::uint16_t { kAvatar = 1, kFace, kProps, kHulls, kContacts, kParticles, kDepth };

constexpr std::array<std::pair<const char*, unsigned>, 5> kLayers = {{{"hulls", served::kHulls},
                                                                      {"contacts", served::kContacts},
                                                                      {"particles", served::kParticles},
                                                                      {"depth", served::kDepth},
                                                                      {"face", served::kFace}}};
constexpr std::array<const char*, 5> kShapes = {"box", "sphere", "capsule", "cylinder", "mesh"};
constexpr double kUnit = 32767.0;          // of shares in 16 bits
constexpr double kBetweenDepth = 0.08;     // images [s]
constexpr int kDepthQuality = 80;          // of JPEG
constexpr double kRigid = 1e-5;            // deviation of a joint's matrix from a rotation
constexpr std::size_t kMaxContacts = 256;  // of a frame

template <typename Number, typename... Numbers>
void put(std::string& bytes, Numbers... numbers) {
  (appendLittleEndian(static_cast<Number>(numbers), bytes), ...);
}

/// Writes over what is there.
template <typename Number>
void putAt(std::string& bytes, std::size_t at, std::size_t number) {
  std::string written;
  put<Number>(written, number);
  bytes.replace(at, written.size(), written);
}

void putFloats(std::string& bytes, const Vec3& v) {
  put<float>(bytes, v.x(), v.y(), v.z());
}

void putPose(std::string& bytes, const Vec3& position, const Mat3& rotation) {
  putFloats(bytes, position);
  const Quat q(rotation);
  for (const double part : {q.x(), q.y(), q.z(), q.w()}) {
    put<std::int16_t>(bytes, std::lround(std::clamp(part, -1.0, 1.0) * kUnit));
  }
}

std::uint8_t srgb(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return std::lround(255.0f * (c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f));
}

void putColor(std::string& bytes, const Vec3f& linear) {
  put<std::uint8_t>(bytes, srgb(linear.x()), srgb(linear.y()), srgb(linear.z()), 255);
}

void pad(std::string& bytes) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
}

/// Starts a section, whose length endSection() fills in. @return where its payload begins
std::size_t beginSection(std::string& bytes, Section kind, std::size_t index = 0) {
  put<std::uint16_t>(bytes, kind, index);
  put<std::uint32_t>(bytes, 0);
  return bytes.size();
}

void endSection(std::string& bytes, std::size_t begin) {
  putAt<std::uint32_t>(bytes, begin - 4, bytes.size() - begin);
  pad(bytes);
}

bool isRigid(const Affine3& transform) {
  return (transform.linear() * transform.linear().transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < kRigid &&
         transform.linear().determinant() > 0.0;
}

bool sameKind(const Prop& a, const Prop& b) {
  return a.shape == b.shape && a.halfExtents == b.halfExtents && a.color == b.color && a.mesh == b.mesh &&
         (a.mass > 0.0) == (b.mass > 0.0);
}

std::string meshBytes(const TriMesh& mesh) {
  std::string bytes;
  put<std::uint32_t>(bytes, mesh.vertices.size(), mesh.triangles.size());
  for (const Vec3& v : mesh.vertices) putFloats(bytes, v);
  for (const Triangle& t : mesh.triangles) put<std::uint32_t>(bytes, t[0], t[1], t[2]);
  return bytes;
}

nlohmann::json coordinates(const auto& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

unsigned servedLayer(std::string_view name) {
  const auto found = std::find_if(kLayers.begin(), kLayers.end(), [&](const auto& one) { return one.first == name; });
  return found == kLayers.end() ? 0 : found->second;
}

void ServedFrame::addFigure(const SceneFigure& from) {
  if (figures.size() == figureCount_) figures.emplace_back();
  Figure& figure = figures[figureCount_++];
  figure.avatar = from.number;
  figure.opacity = from.opacity;
  figure.worldFromModel.assign(from.worldFromModel.begin(), from.worldFromModel.end());
  figure.face.assign(from.expressions.begin(), from.expressions.end());
  figure.parts.resize((layers & served::kHulls) != 0 ? from.parts.size() : 0);
  for (std::size_t p = 0; p < figure.parts.size(); ++p) {
    const LivePart& live = from.parts[p];
    Part& part = figure.parts[p];
    part.worldFromPart = live.worldFromPart;
    part.color = partColor(from.colors.empty() ? static_cast<PartIndex>(p) : from.colors[p]);
    if (!shapes) continue;
    part.vertices.assign(live.shape.vertices.begin(), live.shape.vertices.end());
    part.triangles.assign(live.shape.triangles.begin(), live.shape.triangles.end());
    part.extent = 0.0;
    for (const Vec3& v : part.vertices) part.extent = std::max(part.extent, v.cwiseAbs().maxCoeff());
  }
}

void ServedFrame::take(const Scene& scene, unsigned asked, bool withShapes) {
  layers = asked;
  shapes = withShapes;
  time = scene.time;
  figureCount_ = 0;
  scene.eachFigure([&](const SceneFigure& figure) {
    if (figure.skeleton != nullptr) addFigure(figure);
  });
  figures.resize(figureCount_);
  props.assign(scene.props.begin(), scene.props.end());
  contacts.assign(scene.contacts.begin(), scene.contacts.begin() + std::min(scene.contacts.size(), kMaxContacts));
  particles.clear();
  allParticles = scene.particles.size();
  particleRadius = scene.particleRadius;
  particleColor = scene.particleColor;
  if ((layers & served::kParticles) != 0 && allParticles > 0) {
    const std::size_t each = (allParticles + kMaxServedParticles - 1) / kMaxServedParticles;
    for (std::size_t i = 0; i < allParticles; i += each) particles.push_back(scene.particles[i]);
  }
  depth.width = depth.height = 0;
  if (shapes && (layers & served::kDepth) != 0 && scene.inset != nullptr) depth = *scene.inset;
}

void FrameEncoder::encode(const ServedFrame& frame) {
  if (frame.run != run_) hulls_.clear();
  run_ = frame.run;
  time_ = frame.time;
  layers_ = frame.layers;
  avatars_.clear();
  faces_.clear();
  avatarSections_ = faceSections_ = 0;
  for (const ServedFrame::Figure& figure : frame.figures) {
    const bool rigid = std::all_of(figure.worldFromModel.begin(), figure.worldFromModel.end(), isRigid);
    const std::size_t begin = beginSection(avatars_, Section::kAvatar, figure.avatar);
    put<std::uint8_t>(avatars_, 1, rigid ? 0 : 1);
    put<std::uint16_t>(avatars_, figure.worldFromModel.size());
    put<float>(avatars_, figure.opacity);
    for (const Affine3& joint : figure.worldFromModel) {
      if (rigid) {
        putPose(avatars_, joint.translation(), joint.linear());
      } else {
        for (int row = 0; row < 3; ++row) {
          for (int column = 0; column < 4; ++column) put<float>(avatars_, joint(row, column));
        }
      }
    }
    endSection(avatars_, begin);
    ++avatarSections_;
    if (figure.face.empty()) continue;
    const std::size_t face = beginSection(faces_, Section::kFace, figure.avatar);
    for (const float weight : figure.face) put<float>(faces_, weight);
    endSection(faces_, face);
    ++faceSections_;
  }
  encodeHulls(frame);

  const bool same =
      frame.props.size() == known_.size() && std::equal(known_.begin(), known_.end(), frame.props.begin(), sameKind);
  if (!same || propsVersion_ == 0) describeProps(frame.props);
  propPoses_.resize(frame.props.size());
  std::string pose;
  for (std::size_t i = 0; i < frame.props.size(); ++i) {
    pose.clear();
    putPose(pose, frame.props[i].worldFromProp.translation(), frame.props[i].worldFromProp.linear());
    std::copy(pose.begin(), pose.end(), propPoses_[i].begin());
  }

  contacts_.clear();
  const std::size_t begin = beginSection(contacts_, Section::kContacts);
  put<std::uint32_t>(contacts_, frame.contacts.size());
  for (const Contact& contact : frame.contacts) {
    putFloats(contacts_, contact.point);
    putFloats(contacts_, contact.normal);
    put<float>(contacts_, contact.impulse);
  }
  endSection(contacts_, begin);

  particles_ = frame.particles;
  allParticles_ = frame.allParticles;
  particleRadius_ = frame.particleRadius;
  particleColor_ = frame.particleColor;
  depth_ = frame.depth.width > 0 ? jpegOf(frame.depth, kDepthQuality) : "";
}

void FrameEncoder::encodeHulls(const ServedFrame& frame) {
  hulls_.resize(frame.figures.size());
  for (std::size_t f = 0; f < hulls_.size(); ++f) {
    const ServedFrame::Figure& figure = frame.figures[f];
    hulls_[f].avatar = figure.avatar;
    hulls_[f].parts.resize(figure.parts.size());
    for (std::size_t p = 0; p < figure.parts.size(); ++p) {
      const ServedFrame::Part& part = figure.parts[p];
      EncodedPart& encoded = hulls_[f].parts[p];
      encoded.head.clear();
      putPose(encoded.head, part.worldFromPart.translation(), part.worldFromPart.linear());
      if (frame.shapes) encoded.extent = static_cast<float>(part.extent);
      put<float>(encoded.head, encoded.extent);
      putColor(encoded.head, part.color);
      if (!frame.shapes) continue;
      encoded.version.shape = ++shapeVersion_;
      encoded.vertices.clear();
      const double scale = part.extent > 0.0 ? kUnit / part.extent : 0.0;
      for (const Vec3& v : part.vertices) {
        for (const double c : {v.x(), v.y(), v.z()}) put<std::int16_t>(encoded.vertices, std::lround(c * scale));
      }
      if (encoded.version.faces != 0 && encoded.triangles == part.triangles) continue;
      encoded.triangles = part.triangles;
      encoded.version.faces = shapeVersion_;
      encoded.faces.clear();
      for (const Triangle& t : part.triangles) put<std::uint16_t>(encoded.faces, t[0], t[1], t[2]);
    }
  }
}

void FrameEncoder::describeProps(std::span<const Prop> props) {
  known_.assign(props.begin(), props.end());
  ++propsVersion_;
  nlohmann::ordered_json json = {{"type", "props"}, {"version", propsVersion_}};
  json["props"] = nlohmann::ordered_json::array();
  decltype(meshes_) meshes;
  for (const Prop& prop : props) {
    nlohmann::ordered_json one = {{"shape", kShapes[ordinalOf(prop.shape)]},
                                  {"half", coordinates(prop.halfExtents)},
                                  {"color", coordinates(prop.color)},
                                  {"fixed", prop.mass <= 0.0}};
    if (prop.mesh != nullptr) {
      const auto placeIn = [&](const auto& list) {
        return std::find_if(list.begin(), list.end(), [&](const auto& each) { return each.first == prop.mesh.get(); });
      };
      auto found = placeIn(meshes);
      if (found == meshes.end()) {
        const auto before = placeIn(meshes_);
        meshes.emplace_back(prop.mesh.get(), before != meshes_.end()
                                                 ? before->second
                                                 : std::make_shared<const std::string>(meshBytes(prop.mesh->shown)));
        found = meshes.end() - 1;
      }
      one["mesh"] = found - meshes.begin();
    }
    json["props"].push_back(std::move(one));
  }
  meshes_ = std::move(meshes);
  propsText_ = json.dump();
}

std::shared_ptr<const std::string> FrameEncoder::mesh(std::size_t number) const {
  return number < meshes_.size() ? meshes_[number].second : nullptr;
}

void FrameEncoder::compose(std::uint64_t number, unsigned layers, double now, ClientMemory& client,
                           std::string& message) const {
  layers &= layers_;
  if (client.run != run_ || client.propsVersion != propsVersion_) client.propPoses.clear();
  if (client.run != run_) client.parts.clear();
  client.run = run_;
  client.propsVersion = propsVersion_;

  message += "LRCF";
  put<std::uint16_t>(message, 1, 0);
  put<std::uint32_t>(message, run_, propsVersion_);
  put<std::uint64_t>(message, number);
  put<double>(message, time_);
  std::size_t sections = avatarSections_;
  message += avatars_;
  if ((layers & served::kFace) != 0) {
    message += faces_;
    sections += faceSections_;
  }

  const std::size_t props = beginSection(message, Section::kProps);
  put<std::uint32_t>(message, 0);
  std::uint32_t moved = 0;
  const bool all = client.propPoses.size() != propPoses_.size();
  client.propPoses.resize(propPoses_.size());
  for (std::size_t i = 0; i < propPoses_.size(); ++i) {
    if (!all && client.propPoses[i] == propPoses_[i]) continue;
    client.propPoses[i] = propPoses_[i];
    put<std::uint16_t>(message, i, 0);
    message.append(propPoses_[i].data(), propPoses_[i].size());
    ++moved;
  }
  putAt<std::uint32_t>(message, props, moved);
  endSection(message, props);
  ++sections;

  if ((layers & served::kHulls) != 0) {
    client.parts.resize(hulls_.size());
    for (std::size_t f = 0; f < hulls_.size(); ++f) {
      const std::size_t hulls = beginSection(message, Section::kHulls, hulls_[f].avatar);
      put<std::uint16_t>(message, hulls_[f].parts.size(), 0);
      client.parts[f].resize(hulls_[f].parts.size());
      for (std::size_t p = 0; p < hulls_[f].parts.size(); ++p) {
        const EncodedPart& part = hulls_[f].parts[p];
        ClientMemory::Part& has = client.parts[f][p];
        const bool shape = has.shape != part.version.shape, faces = shape && has.faces != part.version.faces;
        has = part.version;
        message += part.head;
        put<std::uint16_t>(message, shape ? part.vertices.size() / 6 : 0, faces ? part.triangles.size() : 0);
        if (shape) message += part.vertices;
        if (faces) message += part.faces;
        pad(message);
      }
      endSection(message, hulls);
      ++sections;
    }
  } else {
    client.parts.clear();
  }
  if ((layers & served::kContacts) != 0) {
    message += contacts_;
    ++sections;
  }
  if ((layers & served::kParticles) != 0 && !particles_.empty()) {
    const std::size_t each = (particles_.size() + client.particles - 1) / client.particles;
    Vec3f lowest = particles_.front(), highest = lowest;
    for (const Vec3f& p : particles_) {
      lowest = lowest.cwiseMin(p);
      highest = highest.cwiseMax(p);
    }
    const Vec3f size = (highest - lowest).cwiseMax(1e-6f);
    const std::size_t begin = beginSection(message, Section::kParticles);
    put<std::uint32_t>(message, allParticles_, (particles_.size() + each - 1) / each);
    put<float>(message, particleRadius_);
    putColor(message, particleColor_);
    putFloats(message, lowest.cast<double>());
    putFloats(message, size.cast<double>());
    for (std::size_t i = 0; i < particles_.size(); i += each) {
      const Vec3f share = (particles_[i] - lowest).cwiseQuotient(size) * 65535.0f;
      for (int c = 0; c < 3; ++c) put<std::uint16_t>(message, std::lround(std::clamp(share[c], 0.0f, 65535.0f)));
    }
    endSection(message, begin);
    ++sections;
  }
  if ((layers & served::kDepth) != 0 && !depth_.empty() && now - client.depthTime >= kBetweenDepth) {
    client.depthTime = now;
    const std::size_t begin = beginSection(message, Section::kDepth);
    message += depth_;
    endSection(message, begin);
    ++sections;
  }
  putAt<std::uint16_t>(message, 6, sections);
}

std::string jpegOf(const Image& image, int quality) {
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), &tjDestroy);
  unsigned char* made = nullptr;
  unsigned long size = 0;
  const int status = encoder == nullptr ? -1
                                        : tjCompress2(encoder.get(), image.rgba.data(), image.width, 0, image.height,
                                                      TJPF_RGBA, &made, &size, TJSAMP_420, quality, 0);
  std::string bytes(reinterpret_cast<const char*>(made), status == 0 ? size : 0);
  tjFree(made);
  return bytes;
}

}  // namespace lorica
