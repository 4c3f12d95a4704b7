#include "bindings/character_body.h"
#include "bindings/live_contacts.h"
#include "bindings/python/arrays.h"
#include "bindings/python/docstrings.h"
#include "bindings/python/work.h"
#include "export/contact_export.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;
using py::literals::operator""_a;

struct CharacterHandle {
  CharacterPointer owner;
  [[nodiscard]] const Character& character() const { return *owner->character; }
};

struct BodyHandle {
  std::shared_ptr<const CharacterBody> body;
};

/// One frame, independent of those before and after it.
struct Frame {
  double time = 0.0;
  std::vector<ConvexHull> hulls;
  std::vector<Affine3> worldFromJoint;
};
struct FrameHandle {
  std::shared_ptr<const Frame> frame;
};

const Vec3 kNowhere = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());

std::vector<HullRay> raysFrom(const py::object& origins, const py::object& directions, double reach, double radius,
                              const Vec3& half) {
  const std::vector<Vec3> from = pointsFrom(origins), along = pointsFrom(directions);
  if (from.size() != along.size() && from.size() != 1) {
    throw py::value_error(
        fmt::format("origins: found {}, expected 1, or one for each of {} directions", from.size(), along.size()));
  }
  if (const Result<void> fine = checkCast(reach, radius, half); !fine) raise(fine.error());
  std::vector<HullRay> rays;
  for (std::size_t i = 0; i < along.size(); ++i) {
    rays.push_back({from[from.size() == 1 ? 0 : i], along[i], reach, radius, half});
  }
  return rays;
}

/// A live body that threads may share: one frame at a time.
class Live {
 public:
  explicit Live(const BodyHandle& body) : live_(body.body) {}

  /// Called without the interpreter's lock. @param move  moves the body
  template <typename Move>
  FrameHandle frameAfter(double time, const Move& move) {
    const std::lock_guard lock(mutex_);
    move(live_);
    Frame frame;
    frame.time = time;
    frame.hulls.assign(live_.hulls().begin(), live_.hulls().end());
    frame.worldFromJoint.assign(live_.worldFromJoint().begin(), live_.worldFromJoint().end());
    return {std::make_shared<const Frame>(std::move(frame))};
  }

  std::vector<SelfContact> contacts() {
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    const std::span<const SelfContact> found = contacts_.ofItself(live_);
    return {found.begin(), found.end()};
  }

  std::vector<ShapeContact> touches(const py::object& points, double radius) {
    const std::vector<Vec3> given = pointsFrom(points);
    const RoundedShape shape{given, radius};
    if (const Result<void> fine = checkShape(shape); !fine) raise(fine.error());
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    const std::span<const ShapeContact> found = contacts_.withShape(live_, shape);
    return {found.begin(), found.end()};
  }

  py::tuple cast(const py::object& origins, const py::object& directions, double reach, double radius,
                 const std::array<double, 3>& half) {
    return castEach(raysFrom(origins, directions, reach, radius, Vec3(half.data())), [this](const HullRay& ray) {
      const HullHit hit = live_.rays().nearest(ray);
      return std::tuple(hit.part, hit ? hit.distance : kInfinity, hit ? hit.position : kNowhere,
                        hit ? hit.normal : kNowhere);
    });
  }

  py::tuple castOnSkin(const py::object& origins, const py::object& directions, double reach) {
    const py::tuple met = castEach(raysFrom(origins, directions, reach, 0.0, Vec3::Zero()), [this](const HullRay& ray) {
      const SkinHit hit = live_.castOnSkin(ray);
      return std::tuple(hit.triangle, hit.distance, hit ? hit.position : kNowhere, hit ? hit.weights : kNowhere);
    });
    return py::make_tuple(met[0], met[3], met[1], met[2]);
  }

  /// Poses of the parts and their velocities.
  py::tuple motion(double seconds) {
    if (const Result<void> fine = checkSeconds(seconds); !fine) raise(fine.error());
    const auto count = static_cast<py::ssize_t>(live_.parts().size());
    using Array = py::array_t<double>;
    Array now({count, py::ssize_t{4}, py::ssize_t{4}}), before({count, py::ssize_t{4}, py::ssize_t{4}});
    Array linear({count, py::ssize_t{3}}), angular({count, py::ssize_t{3}});
    double *to = now.mutable_data(), *from = before.mutable_data();
    double *along = linear.mutable_data(), *about = angular.mutable_data();
    {
      const py::gil_scoped_release released;
      const std::lock_guard lock(mutex_);
      for (const LivePart& part : live_.parts()) {
        const PartVelocity velocity = velocityOf(part, seconds);
        for (int row = 0; row < 4; ++row) {
          for (int column = 0; column < 4; ++column) {
            *to++ = part.worldFromPart(row, column);
            *from++ = part.previousWorldFromPart(row, column);
          }
        }
        along = std::copy_n(velocity.linear.data(), 3, along);
        about = std::copy_n(velocity.angular.data(), 3, about);
      }
    }
    return py::make_tuple(now, before, linear, angular);
  }

  /// What the parts swept since the last pose.
  py::list swept() {
    const auto hulls = std::make_shared<std::vector<ConvexHull>>();
    {
      const py::gil_scoped_release released;
      const std::lock_guard lock(mutex_);
      for (const LivePart& part : live_.parts()) hulls->push_back(sweptHull(part));
    }
    return hullList(*hulls, hulls);
  }

  FrameHandle pose(const py::object& matrices) {
    const std::vector<Affine3> worldFromJoint = transformsFrom(matrices, live_.worldFromJoint().size());
    const py::gil_scoped_release released;
    return frameAfter(0.0, [&](LiveCharacter& live) { live.place(worldFromJoint); });
  }

 private:
  /// Arrays of an index, a distance, a position and another vector for each ray.
  template <typename Cast>
  py::tuple castEach(const std::vector<HullRay>& rays, const Cast& cast) {
    const auto count = static_cast<py::ssize_t>(rays.size());
    py::array_t<std::int32_t> indices(count);
    py::array_t<double> distances(count), positions({count, py::ssize_t{3}}), others({count, py::ssize_t{3}});
    std::int32_t* index = indices.mutable_data();
    double *distance = distances.mutable_data(), *position = positions.mutable_data(), *other = others.mutable_data();
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    for (const HullRay& ray : rays) {
      const auto& [itsIndex, itsDistance, itsPosition, itsOther] = cast(ray);
      *index++ = itsIndex;
      *distance++ = itsDistance;
      position = std::copy_n(itsPosition.data(), 3, position);
      other = std::copy_n(itsOther.data(), 3, other);
    }
    const py::gil_scoped_acquire again;
    return py::make_tuple(indices, distances, positions, others);
  }

  std::mutex mutex_;
  LiveCharacter live_;
  LiveContacts contacts_;
};

/// A motion on a live body.
struct Player {
  SkeletalMotion motion;
  std::string firstGuess;
  std::shared_ptr<Live> live;
  int next = 0;

  FrameHandle step() {
    if (next >= motion.frameCount()) throw py::stop_iteration();
    const int index = next++;
    const py::gil_scoped_release released;
    return live->frameAfter(motion.times[index], [&](LiveCharacter& body) { body.pose(motion.pose(index)); });
  }

  FrameHandle at(double seconds) const {
    if (!std::isfinite(seconds))
      throw py::value_error(fmt::format("time: found {}, expected a finite number", seconds));
    const py::gil_scoped_release released;
    Pose pose = restPose(motion.skeleton);
    poseAt(motion, seconds, pose);
    return live->frameAfter(seconds, [&](LiveCharacter& body) { body.pose(pose); });
  }
};

std::vector<std::string> jointNames(const Character& character) {
  std::vector<std::string> names;
  for (const Joint& joint : character.skeleton.joints()) names.push_back(joint.name);
  return names;
}

std::vector<int> jointParents(const Character& character) {
  std::vector<int> parents;
  for (const Joint& joint : character.skeleton.joints()) parents.push_back(joint.parent);
  return parents;
}

std::string pathFrom(const py::object& file) {
  return py::module_::import("os").attr("fsencode")(file).cast<std::string>();
}

CharacterHandle openNamed(const py::object& file, const std::optional<py::object>& map, const std::string& walls,
                          double thickness, double bodyResolution, std::vector<std::string> hidden,
                          std::vector<std::string> expressions) {
  const std::string name = pathFrom(file);
  CharacterOptions reading;
  if (map) reading.map = pathFrom(*map);
  reading.bodyResolution = bodyResolution;
  reading.walls = wallChoiceNamed(walls);
  if (!reading.walls) throw py::value_error(fmt::format("walls: found {}, expected solid, auto or shell", walls));
  if (*reading.walls == WallChoice::kSolid) reading.walls.reset();  // what is flat has no other body
  reading.thickness = thickness;
  reading.hidden = std::move(hidden);
  reading.expressions = std::move(expressions);
  return {resultAside<CharacterPointer>(py::none(), [&](const DecomposeProgress& report) {
    ProgramHost host(report);
    return openCharacter(name, reading, host);
  })};
}

BodyHandle makeBodyOf(const CharacterHandle& character, int parts, std::optional<double> cover, int hullVertices,
                      int threads, const py::object& progress) {
  if (cover && !(std::isfinite(*cover) && *cover >= 0.0)) {
    throw py::value_error(fmt::format("cover: found {}, expected 0 or more", *cover));
  }
  if (cover && *cover == 0.0) cover.reset();
  using Pointer = std::shared_ptr<const CharacterBody>;
  auto made = resultAside<Pointer>(progress, [&](const DecomposeProgress& report) {
    ProgramHost host(report, threads, parts);
    return makeCharacterBody(character.owner, {parts, {cover, hullVertices}}, host);
  });
  warnOf(made->warning);
  return {std::move(made)};
}

BodyHandle loadBody(const CharacterHandle& character, const fs::path& file) {
  using Pointer = std::shared_ptr<const CharacterBody>;
  auto read = resultAside<Pointer>(py::none(),
                                   [&](const DecomposeProgress&) { return readCharacterBody(character.owner, file); });
  warnOf(read->warning);
  return {std::move(read)};
}

py::dict contactsOf(const py::object& motion, const py::object& character, const py::object& scene, double near,
                    const std::string& clip, bool mirror, const py::object& decomposition, int threads,
                    const py::object& progress) {
  ContactRequest request;
  request.near = near;
  request.cast.motion = pathFrom(motion);
  request.cast.character = pathFrom(character);
  request.cast.scene = pathFrom(scene);
  request.cast.body.decomposition = pathFrom(decomposition);
  request.cast.performing.clip = clip;
  request.cast.performing.mirror = mirror;
  const auto labels = resultAside<ContactLabels>(progress, [&](const DecomposeProgress& report) {
    ProgramHost host(report, threads);
    return findContacts(request, host);
  });
  py::dict arrays;
  const Result<void> done = forEachArray(labels, [&](const NamedArray& array) -> Result<void> {
    const std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end());
    arrays[array.name.c_str()] = py::array(py::dtype(array.type), shape, array.bytes.data());
    return {};
  });
  if (!done) raise(done.error());
  return arrays;
}

std::shared_ptr<Player> play(const py::object& motion, const BodyHandle& body, const std::string& clip, bool mirror) {
  const std::string name = pathFrom(motion);
  auto performed = resultAside<Performance>(py::none(), [&](const DecomposeProgress& report) {
    ProgramHost host(report);
    return performanceOf(body.body->character(), name, clip, mirror, host);
  });
  return std::make_shared<Player>(
      Player{std::move(performed.motion), std::move(performed.firstGuess), std::make_shared<Live>(body)});
}

void addCharacter(py::module_& module) {
  py::class_<CharacterHandle>(module, "Character", docOf("Character"))
      .def(py::init(&openNamed), "file"_a = "mannequin", py::kw_only(), "map"_a = py::none(), "walls"_a = "solid",
           "thickness"_a = 0.0, "body_resolution"_a = 0.0, "hidden"_a = std::vector<std::string>(),
           "expressions"_a = std::vector<std::string>(), docOf("Character.__init__"))
      .def_property_readonly(
          "name", [](const CharacterHandle& self) { return textFrom(self.character().name); }, docOf("Character.name"))
      .def_property_readonly(
          "height", [](const CharacterHandle& self) { return self.character().height; }, docOf("Character.height"))
      .def_property_readonly(
          "joints", [](const CharacterHandle& self) { return jointNames(self.character()); }, docOf("Character.joints"))
      .def_property_readonly(
          "parents", [](const CharacterHandle& self) { return jointParents(self.character()); },
          docOf("Character.parents"))
      .def_property_readonly(
          "clips",
          [](const CharacterHandle& self) {
            std::vector<std::string> names;
            for (const Clip& clip : self.owner->clips()) names.push_back(clip.name);
            return names;
          },
          docOf("Character.clips"))
      .def_property_readonly(
          "first_guess", [](const CharacterHandle& self) { return guessAbout(*self.owner); },
          docOf("Character.first_guess"))
      .def_property_readonly(
          "notes", [](const CharacterHandle& self) { return notesOf(*self.owner); }, docOf("Character.notes"))
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view(self.cast<const CharacterHandle&>().character().mesh.vertices, self);
          },
          docOf("Character.vertices"))
      .def_property_readonly(
          "faces",
          [](const py::object& self) {
            return view(self.cast<const CharacterHandle&>().character().mesh.triangles, self);
          },
          docOf("Character.faces"))
      .def("body", &makeBodyOf, "parts"_a = 0, py::kw_only(), "cover"_a = py::none(), "hull_vertices"_a = 0,
           "threads"_a = 0, "progress"_a = py::none(), docOf("Character.body"))
      .def("load_body", &loadBody, "file"_a, docOf("Character.load_body"))
      .def("__repr__", [](const CharacterHandle& self) {
        return textFrom(fmt::format("<lorica.Character {} with {}>", self.character().name,
                                    counted(self.character().skeleton.jointCount(), "joint")));
      });
}

void addBody(py::module_& module) {
  py::class_<BodyHandle>(module, "Body", docOf("Body"))
      .def_property_readonly(
          "character", [](const BodyHandle& self) { return CharacterHandle{self.body->owner}; },
          docOf("Body.character"))
      .def(
          "__len__", [](const BodyHandle& self) { return self.body->content.decomposition.parts.size(); },
          docOf("Body.__len__"))
      .def_property_readonly(
          "error", [](const BodyHandle& self) { return self.body->content.meanError; }, docOf("Body.error"))
      .def(
          "live", [](const BodyHandle& self) { return std::make_shared<Live>(self); }, docOf("Body.live"))
      .def(
          "save", [](const BodyHandle& self, const fs::path& file) { save(self.body->content, file); }, "file"_a,
          docOf("Body.save"))
      .def("__repr__", [](const BodyHandle& self) {
        return textFrom(fmt::format("<lorica.Body of {}: {}>", self.body->character().name,
                                    counted(std::ssize(self.body->content.decomposition.parts), "part")));
      });
}

/// (3,) float64, read-only, no copy: a vector of a contact.
template <typename Contact>
auto vectorOf(Vec3 Contact::*member) {
  return [member](const py::object& self) {
    return view(std::span(&(self.cast<const Contact&>().*member), 1), self).attr("reshape")(3);
  };
}

void addFrame(py::module_& module) {
  py::class_<FrameHandle>(module, "Frame", docOf("Frame"))
      .def_property_readonly(
          "time", [](const FrameHandle& self) { return self.frame->time; }, docOf("Frame.time"))
      .def_property_readonly(
          "hulls", [](const FrameHandle& self) { return hullList(self.frame->hulls, self.frame); },
          docOf("Frame.hulls"))
      .def_property_readonly(
          "world_from_joint",
          [](const py::object& self) { return view(self.cast<const FrameHandle&>().frame->worldFromJoint, self); },
          docOf("Frame.world_from_joint"));
  py::class_<SelfContact>(module, "Contact", docOf("Contact"))
      .def_readonly("first", &SelfContact::first, docOf("Contact.first"))
      .def_readonly("second", &SelfContact::second, docOf("Contact.second"))
      .def_property_readonly("position", vectorOf(&SelfContact::position), docOf("Contact.position"))
      .def_property_readonly("direction", vectorOf(&SelfContact::direction), docOf("Contact.direction"))
      .def_readonly("depth", &SelfContact::depth, docOf("Contact.depth"));
  py::class_<ShapeContact>(module, "Touch", docOf("Touch"))
      .def_readonly("part", &ShapeContact::part, docOf("Touch.part"))
      .def_property_readonly("position", vectorOf(&ShapeContact::position), docOf("Touch.position"))
      .def_property_readonly("direction", vectorOf(&ShapeContact::direction), docOf("Touch.direction"))
      .def_readonly("depth", &ShapeContact::depth, docOf("Touch.depth"));
}

constexpr std::array<double, 3> kNoHalf = {0.0, 0.0, 0.0};

Live& liveOf(Live& self) {
  return self;
}
Live& liveOf(const Player& self) {
  return *self.live;
}

/// A method of the live body of an object. @param method  such as &Live::motion
template <typename Self, typename Answer, typename... Given>
auto ofLive(Answer (Live::*method)(Given...)) {
  return [method](Self& self, Given... given) { return (liveOf(self).*method)(given...); };
}

/// What a body in its last pose can be asked.
template <typename Self>
void addQueries(py::class_<Self, std::shared_ptr<Self>>& type, const char* contacts) {
  type.def("motion", ofLive<Self>(&Live::motion), "seconds"_a, docOf("_Posed.motion"))
      .def("swept", ofLive<Self>(&Live::swept), docOf("_Posed.swept"))
      .def("contacts", ofLive<Self>(&Live::contacts), contacts)
      .def("touches", ofLive<Self>(&Live::touches), "points"_a, "radius"_a = 0.0, docOf("_Posed.touches"))
      .def("cast", ofLive<Self>(&Live::cast), "origins"_a, "directions"_a, "reach"_a = kInfinity, "radius"_a = 0.0,
           py::arg_v("half", kNoHalf, "..."), docOf("_Posed.cast"))
      .def("cast_on_skin", ofLive<Self>(&Live::castOnSkin), "origins"_a, "directions"_a, "reach"_a = kInfinity,
           docOf("_Posed.cast_on_skin"));
}

}  // namespace

void addCharacters(py::module_& module) {
  addCharacter(module);
  addBody(module);
  addFrame(module);
  py::class_<Live, std::shared_ptr<Live>> live(module, "Live", docOf("Live"));
  live.def("pose", &Live::pose, "world_from_joint"_a, docOf("Live.pose"));
  addQueries(live, docOf("Live.contacts"));
  py::class_<Player, std::shared_ptr<Player>> player(module, "Player", docOf("Player"));
  player.def("__iter__", [](const std::shared_ptr<Player>& self) { return self; })
      .def("__next__", &Player::step)
      .def(
          "__len__", [](const Player& self) { return self.motion.frameCount(); }, docOf("Player.__len__"))
      .def("at", &Player::at, "time"_a, docOf("Player.at"))
      .def_property_readonly(
          "times", [](const Player& self) { return self.motion.times; }, docOf("Player.times"))
      .def_property_readonly(
          "first_guess", [](const Player& self) { return self.firstGuess; }, docOf("Player.first_guess"));
  addQueries(player, docOf("Player.contacts"));
  module.def("contacts", &contactsOf, "motion"_a, "character"_a = "", py::kw_only(), "scene"_a = "",
             "near"_a = ContactTable::kNear, "clip"_a = "", "mirror"_a = false, "decomposition"_a = "", "threads"_a = 0,
             "progress"_a = py::none(), docOf("contacts"));
  module.def("play", &play, "motion"_a, "body"_a, py::kw_only(), "clip"_a = "", "mirror"_a = false, docOf("play"));
}

}  // namespace lorica
