#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report.h"
#include "collision/hulls/part_hulls.h"
#include "export/collider_fit.h"
#include "export/engines.h"
#include "export/export_source.h"
#include "export/glb_colliders.h"
#include "export/mesh_export.h"
#include "export/rigid_model.h"
#include "export/robot_files.h"
#include "export/robots/robot_hulls.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/subject.h"
#include "viewer/player/parts_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace lorica {
namespace {

/// Rigid colliders of a character and how well they fit.
struct RigidExport {
  std::vector<RigidCollider> colliders;
  int trainingPoses = 0;
  int heldOutPoses = 0;  ///< 0: there are none, the fit was measured in the training poses
  ColliderFits fits;
};

std::string growthOf(const PartHulls& hulls) {
  if (hulls.totalGrowth == 1.0) return fmt::format("at most {}", hulls.maxVertices);
  return fmt::format("at most {}, before {}; volume +{}", hulls.maxVertices, hulls.maxVerticesBefore,
                     percent(hulls.totalGrowth - 1.0));
}

std::vector<std::string> row(const std::string& name, const ColliderFit& fit) {
  return {name,
          millimetres(fit.worstOut),
          millimetres(fit.meanWorstOut),
          percent(fit.shareOut),
          millimetres(fit.meanStandOff),
          millimetres(fit.worstStandOff),
          fmt::format("{:.1f}", 1e3 * fit.volume)};
}

Json jsonOf(const ColliderFit& fit) {
  return {{"worstOut", fit.worstOut},         {"meanWorstOut", fit.meanWorstOut},   {"shareOut", fit.shareOut},
          {"meanStandOff", fit.meanStandOff}, {"worstStandOff", fit.worstStandOff}, {"volume", fit.volume}};
}

/// "LeftHand_0", "LeftHand_1": the bone and the number of its hull, unique.
/// @return in the order of the colliders
std::vector<std::string> colliderNames(const Character& character, std::span<const RigidCollider> colliders) {
  std::map<JointIndex, int> count;
  std::vector<std::string> names;
  for (const RigidCollider& collider : colliders) {
    names.push_back(fmt::format("{}_{}", character.skeleton.joint(collider.joint).name, count[collider.joint]++));
  }
  return names;
}

/// The colliders in the bind pose.
std::vector<NamedMesh> namedHulls(const Character& character, std::span<const RigidCollider> colliders) {
  const std::vector<std::string> names = colliderNames(character, colliders);
  std::vector<NamedMesh> meshes;
  for (std::size_t i = 0; i < colliders.size(); ++i) meshes.push_back({names[i], colliders[i].hull});
  return meshes;
}

/// The report of `lorica export`.
struct ExportReport : Report {
  ExportReport(const std::string& input, const std::string& output) : Report(input) {
    add("input", input);
    add("output", "output", output);
  }
  using Report::add;

  void add(const PartHulls& hulls) {
    add("hulls", "hulls", hulls.objects.size(), std::to_string(hulls.objects.size()));
    add("maxVertices", "hull vertices", hulls.maxVertices, growthOf(hulls));
    add("growth", hulls.totalGrowth);
  }

  void add(const RigidExport& rigid, bool perBone) {
    std::set<JointIndex> bones;
    std::size_t most = 0;
    for (const RigidCollider& collider : rigid.colliders) {
      bones.insert(collider.joint);
      most = std::max(most, collider.hull.vertices.size());
    }
    const ColliderFit &hulls = rigid.fits.hulls, &capsules = rigid.fits.capsules;
    constexpr double kFarOff = 0.3;  // [m]
    note("Capsules: one around the surface of each hull, for comparison.");
    if (hulls.worstStandOff > kFarOff) {
      notes(
          {fmt::format("A hull stands off by {:.2f} m: its part holds what moves apart, such as a cape and a leg. "
                       "{}--hide NAME for what physics need not touch{} makes tighter ones.",
                       hulls.worstStandOff, perBone ? "" : "--per-bone, or ", perBone ? ", a weapon or a hat," : ",")});
    }
    add("hulls", "hulls", rigid.colliders.size(),
        fmt::format("{} on {}, each rigid on one", rigid.colliders.size(), counted(bones.size(), "bone")));
    add("bones", bones.size());
    add("maxVertices", "hull vertices", most, fmt::format("at most {}", most));
    add("trainingPoses", rigid.trainingPoses);
    add("heldOutPoses", rigid.heldOutPoses);
    add("fit", "fit", {{"hulls", jsonOf(hulls)}, {"capsules", jsonOf(capsules)}},
        rigid.heldOutPoses > 0
            ? fmt::format("measured in {}; made from {}", counted(rigid.heldOutPoses, "pose"),
                          counted(rigid.trainingPoses, "other"))
            : fmt::format("measured in the {} that they were made from", counted(rigid.trainingPoses, "pose")));
    table({{"", "skin out, worst", "mean of poses", "skin out > 1 mm", "stands off, mean", "worst", "litres"},
           {row("hulls", hulls), row("capsules", capsules)}});
  }

  void add(const RigidModel& model) {
    double mass = 0.0;
    std::size_t hinges = 0;
    for (const RigidBody& body : model.bodies) {
      mass += body.mass;
      hinges += body.hinges.size();
    }
    notes(model.notes);
    add("bodies", "bodies", model.bodies.size(),
        fmt::format("{}, {:.4g} kg, {} between them", model.bodies.size(), mass, counted(hinges, "hinge")));
    add("mass", mass);
    add("hinges", hinges);
  }

  void add(const RobotReport& robot) {
    line("written",
         fmt::format("{} with shapes for {}", counted(robot.files, "file"), counted(robot.meshes, "mesh", "meshes")));
    Table cells{{kRobotHeadings.begin(), kRobotHeadings.end()}, {}};
    Json links;
    for (const RobotLinkReport& link : robot.links) {
      cells.rows.push_back(link.cells());
      links.push_back({{"name", link.name},
                       {"shapes", link.shapes},
                       {"volumes", link.volumes},
                       {"covered", link.covered},
                       {"standOff", link.standOff}});
    }
    table(std::move(cells));
    if (!links.empty()) add("links", std::move(links));
    add("newContacts", robot.newContacts);
    notes(robot.notes);
  }

  void addSprings(int shapes, int springs) {
    add("springColliders", "colliders", shapes, fmt::format("{} for {}", shapes, counted(springs, "spring")));
  }

  /// Notes that are in the JSON, too.
  void notes(const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) {
      note(sentence);
      noted_.push_back(sentence);
      add("notes", noted_);
    }
  }

 private:
  Json noted_;
};

namespace fs = std::filesystem;

struct ExportOptions {
  ExportSourceOptions source;
  std::string preset;
  std::string body = "auto";
  std::string output;
  std::string motion;
  MotionOptions reading;
  std::optional<double> at;  // [s]
  std::string engine;
  std::string up = "y";   // of a mesh
  int hullVertices = -1;  // -1 = the engine's
  int hullPlanes = 0;
  bool perBone = false;
  std::vector<std::string> packages;  // NAME=DIR
  bool capsules = false;
  bool mocap = false;
  bool khr = false;
  bool showColliders = false;
};

constexpr const char* kFormats = ".obj, .stl or .ply (meshes of hulls), .xml (MuJoCo's MJCF), .urdf, .glb or .vrm";

enum class Format { kMeshes, kMjcf, kUrdf, kGlb, kVrm };

std::optional<Format> formatOf(const std::string& file) {
  const std::string extension = lowerCase(fs::path(file).extension().string());
  if (extension == ".obj" || extension == ".stl" || extension == ".ply") return Format::kMeshes;
  if (extension == ".xml") return Format::kMjcf;
  if (extension == ".urdf") return Format::kUrdf;
  if (extension == ".glb") return Format::kGlb;
  if (extension == ".vrm") return Format::kVrm;
  return std::nullopt;
}

/// What was asked for; of vertices, else the engine's limit, else what every engine is fine with.
HullBudget budgetOf(const ExportOptions& options) {
  if (options.hullVertices >= 0) return {options.hullVertices, options.hullPlanes};
  const std::optional<Engine> engine = engineNamed(options.engine);
  return {engine && engine->maxVertices > 0 ? engine->maxVertices : kUsualVertices, options.hullPlanes};
}

/// Rejects, before any work, outputs that cannot be written and options that contradict each other.
Result<void> checkExport(const ExportOptions& options, const CommonOptions& common) {
  const std::optional<Format> format = formatOf(options.output);
  if (!format) {
    return invalidArgument("{}: found the extension `{}`, expected {}", options.output,
                           fs::path(options.output).extension().string(), kFormats);
  }
  if (options.at && format != Format::kMeshes) {
    return invalidArgument("{}: holds hulls for all poses, not those of --at; expected .obj, .stl or .ply",
                           options.output);
  }
  if (options.mocap && format != Format::kMjcf) {
    return invalidArgument("{}: --mocap is for MuJoCo, expected OUT.xml", options.output);
  }
  if (options.at.has_value() != !options.motion.empty()) {
    return invalidArgument(options.at ? "--at is a moment of a motion, expected --motion NAME too"
                                      : "--motion needs the moment to export, expected --at SECONDS too");
  }
  if (options.at && *options.at < 0.0) return invalidArgument("--at {:g}: expected 0 or more", *options.at);
  if (options.at && options.perBone) {
    return invalidArgument("--per-bone makes hulls for all poses, but --at exports one: expected one of the two");
  }
  if (options.hullVertices > 0 && options.hullVertices < 4) {
    return invalidArgument("--hull-vertices {}: expected 4 or more, or 0 for no limit", options.hullVertices);
  }
  if ((options.khr || options.showColliders) && format != Format::kGlb) {
    return invalidArgument("{}: {}, expected OUT.glb", options.output,
                           options.khr ? "--khr is an extension of glTF" : "--show-colliders is for glTF");
  }
  LORICA_TRY_DO(
      checkNotTaken("OUT", options.output, {options.source.input, options.source.decomposition, options.motion}));
  LORICA_TRY_DO(checkOutput(common, "OUT", options.output));
  if (format == Format::kUrdf) {
    LORICA_TRY_DO(checkOutputFolder(common, "OUT", urdfFolder(options.output),
                                    [](const std::string& name) { return name.ends_with(".stl"); }));
  }
  return checkJsonOutput(common, {options.source.input, options.source.decomposition, options.motion, options.output});
}

Result<void> checkSubject(const ExportOptions& options, const Subject& subject) {
  const std::optional<Format> format = formatOf(options.output);
  if (format == Format::kVrm && !(subject.file && subject.file->format.starts_with("VRM"))) {
    return invalidArgument(
        "{}: a .vrm gets colliders for the springs of a VRM character, but {} is none; expected .glb, .xml, .urdf, "
        ".obj, .stl or .ply",
        options.output, subject.name);
  }
  if (options.up == "z" && (subject.character || (format != Format::kMjcf && format != Format::kUrdf))) {
    return invalidArgument("--up z is for meshes in .xml and .urdf, found {}",
                           subject.character ? "the character " + subject.name : options.output);
  }
  const bool rigid = format == Format::kGlb || format == Format::kMjcf || format == Format::kUrdf;
  if (subject.file && subject.file->format == kSequence && rigid) {
    return unsupported(
        "{} is a mesh in several poses, whose hulls bend: `lorica decompose {} --export-frames OUT.glb` writes those "
        "of all; expected .obj, .stl or .ply, which get those of the first",
        subject.name, options.source.input);
  }
  if (subject.character) return {};
  for (const auto& [given, option] :
       {std::pair(options.perBone, "--per-bone"), std::pair(options.at.has_value(), "--at")}) {
    if (given) return invalidArgument("{} is for characters, but {} is a static mesh", option, subject.name);
  }
  return {};
}

/// Hulls that are rigid on bones, and how well they do in poses that were not used to make them.
Result<RigidExport> makeRigid(const ExportOptions& options, const ExportSource& source, Host& host) {
  const Character& character = *source.subject.character;
  LORICA_TRY(const CoverPoses poses, exportPoses(source.subject));
  RigidExport rigid;
  {
    Task task(host, "Making hulls", "hulls");
    LORICA_TRY(rigid.colliders,
               makeRigidColliders(character, source.content.decomposition, poses.sampledView(),
                                  {budgetOf(options), options.perBone, host.threads, task.progress()}));
  }
  rigid.trainingPoses = poses.sampledView().poseCount();
  rigid.heldOutPoses = poses.heldOutView().poseCount();
  const BonePoseView measured = rigid.heldOutPoses > 0 ? poses.heldOutView() : poses.sampledView();
  Task task(host, "Measuring", "poses");
  LORICA_TRY(rigid.fits, measureFit(character, rigid.colliders, measured, host.threads, task.progress()));
  return rigid;
}

/// The hulls of a mesh, or of a character in one pose.
Result<PartHulls> hullsInOnePose(const ExportOptions& options, const ExportSource& source, Host& host) {
  const HullBudget limit = budgetOf(options);
  return options.at ? hullsAt(source, options.motion, options.reading, *options.at, limit, host)
                    : restHulls(source, limit, host);
}

GlbColliderSettings glbSettings(const ExportOptions& options) {
  GlbColliderSettings settings;
  if (const std::optional<Engine> engine = engineNamed(options.engine)) {
    settings.prefix = engine->prefix;
    settings.postfix = engine->postfix;
  }
  settings.khr = options.khr;
  settings.shown = options.showColliders;
  return settings;
}

/// Writes bodies for a robotics engine.
Result<void> writeModel(const ExportOptions& options, const RigidModel& model) {
  if (formatOf(options.output) == Format::kUrdf) return writeUrdf(options.output, model);
  return writeMjcf(options.output, model, options.mocap ? MjcfMotion::kMocap : MjcfMotion::kJoints);
}

/// The character with hulls below its bones, or a VRM with colliders for its springs.
Result<void> writeCharacter(const ExportOptions& options, const ExportSource& source,
                            std::span<const RigidCollider> colliders, const Host& host, ExportReport& report) {
  const Character& character = *source.subject.character;
  const std::optional<CharacterFile>& file = source.subject.file;
  LORICA_TRY(CharacterDocument document, file ? characterDocument({source.input, &*file, host.paths})
                                              : Result<CharacterDocument>(characterDocument(character)));
  if (formatOf(options.output) == Format::kVrm) {
    LORICA_TRY(const int added,
               addSpringColliders(document, colliders, character.skeleton, file->springs, source.subject.name));
    report.addSprings(added, countOf(file->springs.chains));
  } else {
    addColliders(document, colliders, plainNames(colliderNames(character, colliders)), glbSettings(options));
  }
  report.notes(document.notes);
  return writeDocument(options.output, document);
}

Result<void> exportRigid(const ExportOptions& options, const ExportSource& source, Host& host, ExportReport& report) {
  LORICA_TRY(const RigidExport rigid, makeRigid(options, source, host));
  const Character& character = *source.subject.character;
  const std::optional<Format> format = formatOf(options.output);
  Result<void> written;
  if (format == Format::kGlb || format == Format::kVrm) {
    written = writeCharacter(options, source, rigid.colliders, host, report);
  } else if (format == Format::kMeshes) {
    written = writeMeshes(options.output, namedHulls(character, rigid.colliders));
  } else {
    const RigidModel model = rigidModelOf(character, rigid.colliders);
    written = writeModel(options, model);
    report.add(model);
  }
  report.add(rigid, options.perBone);
  return written;
}

/// Turns what is Z up to Lorica's Y up: the reverse of zUp().
void yUp(std::vector<Vec3>& points) {
  for (Vec3& p : points) p = Vec3(p.y(), p.z(), p.x());
}

Result<void> exportOnePose(const ExportOptions& options, const ExportSource& source, Host& host, ExportReport& report) {
  LORICA_TRY(PartHulls hulls, hullsInOnePose(options, source, host));
  report.add(hulls);
  if (formatOf(options.output) == Format::kMeshes) return writeMeshes(options.output, hulls.objects);
  if (formatOf(options.output) == Format::kGlb) {
    return writeGlbHulls(options.output, hulls.objects, glbSettings(options));
  }
  const std::string name = fs::path(source.subject.name).stem().string();
  TriMesh mesh = source.subject.mesh;
  const Aabb box = boundsOf(mesh.vertices);
  const Vec3 size = box.max - box.min;
  if (options.up == "z") {  // what is written turns it back
    yUp(mesh.vertices);
    for (NamedMesh& hull : hulls.objects) yUp(hull.mesh.vertices);
  }
  const bool lies = options.up == "y" && likelyUp(hulls.objects) == UpAxis::kZ;
  report.notes({fmt::format("{:.3g} x {:.3g} x {:.3g} of the file, taken as metres, {} up{}", size.x(), size.y(),
                            size.z(), options.up == "z" ? "Z" : "Y",
                            options.up == "z" ? "" : ": (x, y, z) is written as (z, x, y); --up z keeps the axes")});
  if (lies) host.warn(name + " stands broader with Z up: if it lies on its side in what is written, give --up z");
  const RigidModel model = rigidModelOf(name, mesh, std::move(hulls.objects));
  report.add(model);
  return writeModel(options, model);
}

Result<void> runExport(const ExportOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkExport(options, common));
  ExportSourceOptions reading = options.source;
  reading.reading.body = bodyChoice(options.body);
  reading.divided = !options.perBone;
  if (!options.preset.empty()) reading.preset = presetNamed(options.preset);
  const bool robot = isRobotFile(reading.input);
  if (robot ? options.perBone || options.mocap || options.up == "z" || !reading.decomposition.empty()
            : options.capsules || !options.packages.empty() || reading.maxConcavity > 0.0) {
    return invalidArgument(reading.input +
                           (robot ? ": is a robot, expected no --per-bone, --mocap, --up z and --decomposition"
                                  : ": is no robot, expected no --capsules, --max-concavity and --package"));
  }
  if (robot) {
    const HullBudget limit = budgetOf(options);
    LORICA_TRY(const RobotReport made,
               exportRobot({reading, options.output, options.packages, limit, options.capsules, common.force}, host));
    ExportReport report(fs::path(reading.input).filename().string(), options.output);
    report.add(made);
    return publish(common, report);
  }
  LORICA_TRY(const ExportSource source, readExportSource(reading, host));
  LORICA_TRY_DO(checkSubject(options, source.subject));
  const bool rigid = source.subject.character && (options.perBone || formatOf(options.output) != Format::kMeshes);
  ExportReport report(source.subject.name, options.output);
  LORICA_TRY_DO(rigid ? exportRigid(options, source, host, report) : exportOnePose(options, source, host, report));
  return publish(common, report);
}

}  // namespace

Command addExport(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "export",
      "Write colliders for an engine: convex hulls of a mesh, of a character's bones, or in a robot's own file.",
      "  lorica export bunny.off hulls.obj --engine unreal\n"
      "      the parts' hulls with at most 32 vertices each\n"
      "  lorica export mannequin hulls.ply --motion walk --at 1.5\n"
      "      the live hulls of one frame, to check from outside that they hold the body\n"
      "  lorica export hero.glb colliders.obj --per-bone\n"
      "      a rigid hull for each bone, and how far the skin sticks out of them in other poses\n"
      "  lorica export hero.lorica hulls.stl\n"
      "      of a decomposition that lies beside the file that it was made from\n"
      "  lorica export hero.glb hero.xml --per-bone\n"
      "      a ragdoll for MuJoCo; with --mocap, bodies that are placed from outside\n"
      "  lorica export hero.fbx hero.glb --engine godot\n"
      "      the character with hulls below its bones, as kinematic bodies\n"
      "  lorica export hero.vrm with_colliders.vrm\n"
      "      the same file with colliders that keep hair out of the body\n"
      "  lorica export bunny.off bunny.urdf\n"
      "      for ROS, with its meshes in bunny_meshes/\n"
      "  lorica export robot.urdf robot_hulls.urdf --package arm_description=arm_description\n"
      "      the robot with hulls instead of the meshes that it collides with; all else stays\n"
      "\nCoordinates: of a mesh, those of its file; of a character, metres, Y up, facing +Z; in .xml and\n"
      ".urdf Z up, facing +X, of a mesh too (--up). Bodies have the density of water.");
  app->add_option("IN", options->source.input,
                  "Mesh (.off, .obj, .ply, .stl), mesh or character (.glb, .gltf, .vrm, .fbx, .dae), `mannequin`, a "
                  "decomposition (.lorica), or a robot (.xml of MuJoCo, .urdf)")
      ->required();
  app->add_option("OUT", options->output, std::string("Output file: ") + kFormats)->required();
  addOption(*app, "--decomposition", options->source.decomposition, "FILE.lorica",
            "Decomposition of IN, written by `lorica decompose -o`");
  addCount(*app, "--parts", options->source.parts, 1,
           "Number of parts that a mesh is divided into; a character's are those of its decomposition [default: 16]");
  addShare(*app, "--max-concavity", options->source.maxConcavity,
           "Of a robot's meshes: the fewest parts of at most this concavity, see `decompose` [default: 0.05]");
  app->add_flag("--capsules", options->capsules, "Of a robot: a capsule around each hull instead of it");
  addRepeated(*app, "--package", options->packages, "NAME=FOLDER",
              "Folder of a ROS package that a robot names; may be repeated");
  addPresetOption(*app, options->preset);
  addOption(*app, "--engine", options->engine, "NAME",
            "Limit the vertices of hulls to what an engine takes, and use its names: unity 255, unreal 32, physx 60, "
            "jolt 256; mujoco and godot take any, and get 64")
      ->transform(anEngine());
  addCount(*app, "--hull-vertices", options->hullVertices, 0,
           "Limit each hull to N vertices, at least 4; it is enlarged to contain the same; 0 = no limit [default: the "
           "engine's, else 64]");
  addHullPlanes(*app, options->hullPlanes);
  app->add_flag("--per-bone", options->perBone,
                "One rigid hull for each bone of a character: the skin is cut along weights");
  app->add_flag("--mocap", options->mocap, "In .xml: bodies without joints, for poses from outside (mocap_pos)");
  app->add_flag(
      "--khr", options->khr,
      std::string("In .glb: also KHR_physics_rigid_bodies, as drafted on ") + kKhrDraft + ", not yet ratified");
  app->add_flag("--show-colliders", options->showColliders, "In .glb: draw the hulls, translucent, over the character");
  addOption(*app, "--up", options->up, "AXIS",
            "The axis of a mesh that points up; of z, .xml and .urdf keep the mesh's axes [default: y]")
      ->transform(oneOf({"y", "z"}));
  addOption(*app, "--motion", options->motion, "FILE",
            "With --at: recorded joints, .bvh, a character file with clips, or a shipped recording");
  addOption(*app, "--at", options->at, "SECONDS", "Export the live hulls of this moment of --motion [s]")
      ->check(numberError<double>);
  addReadingOptions(*app, options->reading);
  addCharacterOptions(*app, options->source.reading);
  addBodyOption(*app, options->body);
  return {app, [options](const CommonOptions& given, Host& host) { return runExport(*options, given, host); }};
}

}  // namespace lorica
