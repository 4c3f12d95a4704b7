#include "apps/report_parts.h"

#include "geometry/text.h"
#include "prepare/mesh_walls.h"

#include "player/run_statistics.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string_view>

namespace lorica {
namespace {

bool isExact(const HullCover& cover) {
  return cover.tolerance == 0.0 && cover.maxHullVertices == 0;
}

struct StageRow {
  const char* name;
  const char* what;
  double (*of)(const StageTimes&);
};

constexpr StageRow kStages[] = {
    {"retarget", "joints to pose", [](const StageTimes& t) { return t.retarget; }},
    {"springs", "hair and clothes", [](const StageTimes& t) { return t.springs; }},
    {"motion", "pose to rigid motions of the parts", [](const StageTimes& t) { return t.motion; }},
    {"points", "pose to hull candidates", [](const StageTimes& t) { return t.points; }},
    {"hulls", "candidates to hulls", [](const StageTimes& t) { return t.hulls; }},
    {"physics", "props", [](const StageTimes& t) { return t.physics; }},
    {"particles", "sand or water", [](const StageTimes& t) { return t.particles; }},
    {"total", "everything except drawing", [](const StageTimes& t) { return t.total(); }},
};

Percentiles spreadOfStage(const std::vector<StageTimes>& frames, const StageRow& stage) {
  std::vector<double> times;
  times.reserve(frames.size());
  for (const StageTimes& frame : frames) times.push_back(stage.of(frame));
  return percentilesOf(std::move(times));
}

struct LimbName {
  const char* key;
  const char* words;
};

/// In the order of HitLimb.
constexpr std::array<LimbName, kHittingLimbs> kLimbs = {{{"leftHand", "left hand"},
                                                         {"rightHand", "right hand"},
                                                         {"leftFoot", "left foot"},
                                                         {"rightFoot", "right foot"},
                                                         {"rest", "the rest"}}};

}  // namespace

void addCoverTo(Report& report, const std::optional<HullCover>& cover) {
  if (!cover || isExact(*cover)) {
    report.line("cover", "exact: the surface is inside the hulls in every pose");
    return;
  }
  const auto [fewest, max] = std::minmax_element(cover->points.begin(), cover->points.end(),
                                                 [](const auto& a, const auto& b) { return a.size() < b.size(); });
  const std::string range = fewest->size() == max->size() ? fmt::format("{}", max->size())
                                                          : fmt::format("{} to {}", fewest->size(), max->size());
  std::string chosen = fmt::format("{} points per part, chosen in {}", range, counted(cover->sampledPoses, "pose"));
  if (cover->tolerance > 0.0) chosen += fmt::format(", tolerance {}", millimetres(cover->tolerance));
  if (cover->maxHullVertices > 0) chosen += fmt::format(", at most {} per part", grouped(cover->maxHullVertices));
  report.line("cover", chosen);
  report.line("hulls enlarged", fmt::format("by up to {}; the surface protruded {} before", millimetres(cover->growth),
                                            millimetres(cover->sampledShortfall)));
  if (cover->heldOutPoses > 0) {
    report.line("held-out poses",
                fmt::format("the surface protrudes by at most {} in {}", millimetres(cover->heldOutShortfall),
                            counted(cover->heldOutPoses, "other pose")));
  }
}

void addCoverTo(nlohmann::ordered_json& json, const std::optional<HullCover>& cover) {
  nlohmann::ordered_json& figures = json["cover"];
  const bool exact = !cover || isExact(*cover);
  figures["exact"] = exact;
  if (exact) return;
  figures["tolerance"] = cover->tolerance;
  figures["hullVertices"] = cover->maxHullVertices;
  figures["sampledPoses"] = cover->sampledPoses;
  figures["heldOutPoses"] = cover->heldOutPoses;
  figures["growth"] = cover->growth;
  figures["sampledShortfall"] = cover->sampledShortfall;
  figures["heldOutShortfall"] = cover->heldOutShortfall;
  for (const std::vector<CoverPoint>& points : cover->points) figures["pointsPerPart"].push_back(points.size());
}

void describeSprings(const SpringBones& springs, Report& report, nlohmann::ordered_json& json) {
  json["springs"] = {{"chains", springs.chains.size()},
                     {"joints", springs.springCount()},
                     {"colliders", springs.colliders.size()},
                     {"constraints", springs.constraints.size()}};
  if (!springs.chains.empty()) {
    report.line("springs", fmt::format("{} with {}, {}", counted(std::ssize(springs.chains), "strand"),
                                       counted(springs.springCount(), "joint"),
                                       counted(std::ssize(springs.colliders), "collider")));
  }
  if (!springs.constraints.empty()) {
    report.line("constraints",
                counted(std::ssize(springs.constraints), "joint follows another", "joints follow others"));
  }
}

void addMeshTo(Report& report, const Subject& subject) {
  if (!subject.repaired.empty()) report.line("repaired", subject.repaired);
  if (subject.body && !subject.body->walls.empty()) report.line("walls", subject.body->walls);
  if (!subject.rebuilt) return;
  const RebuiltMesh& body = *subject.rebuilt;
  if (body.shells > 0) report.line("walls", wallsInWords(body));
  if (body.resolution <= 0.0) return;
  report.line(
      "closed body",
      fmt::format("built with voxels of {:.4g}, {}; from its surface to the original {:.4g} on average, {:.4g} "
                  "at most; the original's vertices are up to {:.4g} outside, and in the hulls",
                  body.resolution, body.problem.empty() ? "for --body always was given" : "because " + body.problem,
                  body.distances.meanToOriginal, body.distances.farthestToOriginal, body.distances.farthestOutside));
}

void addMeshTo(nlohmann::ordered_json& json, const Subject& subject) {
  if (!subject.repaired.empty()) json["repaired"] = subject.repaired;
  if (subject.body && !subject.body->walls.empty()) json["walls"] = subject.body->walls;
  if (!subject.rebuilt) return;
  const RebuiltMesh& body = *subject.rebuilt;
  json["body"] = {{"problem", body.problem.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(body.problem)},
                  {"voxel", body.resolution},
                  {"vertices", body.firstOriginal},
                  {"meanDistance", body.distances.meanToOriginal},
                  {"farthestDistance", body.distances.farthestToOriginal},
                  {"farthestOutside", body.distances.farthestOutside},
                  {"shells", body.shells},
                  {"solids", body.solids},
                  {"shellShare", body.shellShare},
                  {"thickness", body.thickness}};
}

nlohmann::ordered_json selfContactsOf(const RunStatistics& statistics, std::size_t avatar) {
  if (avatar >= statistics.selfContacts().size()) return nullptr;
  const RunStatistics::SelfContacts& its = statistics.selfContacts()[avatar];
  nlohmann::ordered_json json{{"frames", its.frames}, {"pairs", its.pairs}, {"deepest", nullptr}};
  if (its.frames > 0) {
    json["deepest"] = {
        {"parts", {its.deepest.first, its.deepest.second}}, {"depth", its.deepest.depth}, {"time", its.deepestTime}};
  }
  return json;
}

void addStatisticsTo(nlohmann::ordered_json& json, const RunStatistics& statistics) {
  const std::optional<RunStatistics::Training>& training = statistics.training();
  json["frames"] = statistics.frames();
  json["contacts"] = statistics.contacts();
  json["touches"] = statistics.touches();
  json["propsTouched"] = statistics.propsTouched();
  json["avatarTouches"] = statistics.avatarTouches();
  json["selfContacts"] = selfContactsOf(statistics, 0);
  json["training"] = nullptr;
  if (training) {
    json["training"] = {{"knownDistance", training->knownDistance},
                        {"largestDistance", training->largest},
                        {"framesOutside", training->framesOutside},
                        {"firstOutside", nullptr}};
    if (training->framesOutside > 0) {
      json["training"]["firstOutside"] = {{"frame", training->firstOutside}, {"time", training->firstTime}};
    }
  }
  for (const StageRow& stage : kStages) {
    const Percentiles spread = spreadOfStage(statistics.times(), stage);
    json["stages"][stage.name] = {{"median", spread.median}, {"p95", spread.p95}};
  }
}

void addStatisticsTo(Report& report, const RunStatistics& statistics) {
  for (const StageRow& stage : kStages) {
    const Percentiles spread = spreadOfStage(statistics.times(), stage);
    const std::string_view name = stage.name;
    if ((name == "springs" || name == "particles") && spread.p95 == 0.0) continue;  // there are none
    report.line(stage.name, fmt::format("{:>8}  (95 % below {:>8})  {}", duration(spread.median), duration(spread.p95),
                                        stage.what));
  }
}

void addSelfContactsTo(Report& report, const RunStatistics& statistics) {
  for (std::size_t a = 0; a < statistics.selfContacts().size(); ++a) {
    const RunStatistics::SelfContacts& its = statistics.selfContacts()[a];
    const std::string what =
        its.frames == 0
            ? "none, except between neighbours"
            : fmt::format("{} of parts in {}; deepest overlap {:.1f} cm, parts {} and {} at {:.2f} s",
                          counted(std::ssize(its.pairs), "pair"), counted(its.frames, "frame"),
                          100.0 * its.deepest.depth, its.deepest.first, its.deepest.second, its.deepestTime);
    report.line("self-contacts",
                statistics.selfContacts().size() == 1 ? what : fmt::format("avatar {}: {}", a + 1, what));
  }
}

void addTrainingTo(Report& report, const RunStatistics& statistics) {
  const std::optional<RunStatistics::Training>& training = statistics.training();
  if (!training) {
    report.line("training", "unknown: the decomposition does not store its training range");
    return;
  }
  const std::string far =
      fmt::format("at most {:.2f} m away; hulls fit up to {:.2f} m", training->largest, training->knownDistance);
  if (training->framesOutside == 0) {
    report.line("training", fmt::format("every pose is like one that the parts were made from ({})", far));
    return;
  }
  report.line("training",
              fmt::format("{} of {} unlike those that the parts were made from, first at {:.2f} s (frame {})",
                          grouped(training->framesOutside), counted(statistics.frames(), "frame"), training->firstTime,
                          training->firstOutside));
  report.line("", far);
}

void addHitsTo(nlohmann::ordered_json& json, const TargetHits& targets) {
  json["targets"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < targets.counter().targets().size(); ++i) {
    const HitCounter::Hits& hits = targets.counter().hitsOf(i);
    nlohmann::ordered_json target;
    target["name"] = targets.counter().targets()[i].name;
    target["hits"] = targets.scores()[i].hits;
    for (std::size_t limb = 0; limb < kHittingLimbs; ++limb) target[kLimbs[limb].key] = hits[limb];
    json["targets"].push_back(std::move(target));
  }
}

void addHitsTo(Report& report, const TargetHits& targets) {
  for (std::size_t i = 0; i < targets.counter().targets().size(); ++i) {
    const HitCounter::Hits& hits = targets.counter().hitsOf(i);
    std::string who;
    for (std::size_t limb = 0; limb < kHittingLimbs; ++limb) {
      if (hits[limb] > 0) who += fmt::format("{}{} {}", who.empty() ? ": " : ", ", kLimbs[limb].words, hits[limb]);
    }
    report.line(i == 0 ? "targets" : "", fmt::format("{}, {}{}", targets.counter().targets()[i].name,
                                                     counted(targets.scores()[i].hits, "hit"), who));
  }
}

void addLiveTo(nlohmann::ordered_json& json, const LiveLog& log) {
  const LiveLog::Figures& figures = log.figures();
  json["depthFrames"] = figures.frames;
  json["framesWithPerson"] = figures.followed;
  json["maxPeople"] = figures.maxPeople;
  json["unplugged"] = figures.unplugs;
  json["firstPose"] = figures.firstPose ? nlohmann::ordered_json(*figures.firstPose) : nlohmann::ordered_json();
  const Percentiles track = percentilesOf(figures.track);
  const Percentiles latency = percentilesOf(figures.latency);
  json["tracking"] = {{"median", track.median}, {"p95", track.p95}};
  json["latency"] = {{"median", latency.median}, {"p95", latency.p95}};
}

void addLiveTo(Report& report, const LiveLog& log) {
  const LiveLog::Figures& figures = log.figures();
  if (figures.followed == 0) {
    report.line("person", fmt::format("{} in {}; stand where the camera sees all of you, or give it more --seconds",
                                      figures.maxPeople > 0 ? "requested person not found" : "not found",
                                      counted(figures.frames, "depth frame")));
  } else {
    report.line("person",
                fmt::format("tracked in {} of {}, first after {:.2f} s; at most {} at once", grouped(figures.followed),
                            counted(figures.frames, "depth frame"), *figures.firstPose, figures.maxPeople));
  }
  if (figures.unplugs > 0) report.line("sensor", "unplugged " + counted(figures.unplugs, "time"));
  if (figures.track.empty()) return;
  const Percentiles track = percentilesOf(figures.track);
  const Percentiles latency = percentilesOf(figures.latency);
  report.line("tracking", fmt::format("{} per frame (95 % below {})", duration(track.median), duration(track.p95)));
  report.line("latency", fmt::format("{} from a depth frame to posed hulls (95 % below {})", duration(latency.median),
                                     duration(latency.p95)));
}

void addStreamTo(nlohmann::ordered_json& json, const VmcInput& stream) {
  const VmcStream::Counts counts = stream.counts();
  const Percentiles latency = percentilesOf(stream.latency());
  json["stream"] = {{"packets", counts.packets}, {"refusedPackets", counts.refused}, {"packetsOfOthers", counts.others},
                    {"frames", counts.frames},   {"jitter", 1e6 * counts.jitter},    {"delay", stream.delayMs()},
                    {"lateFrames", counts.late}};
  json["latency"] = {{"median", latency.median}, {"p95", latency.p95}};
}

void addStreamTo(Report& report, const VmcInput& stream) {
  const VmcStream::Counts counts = stream.counts();
  std::string packets = counted(counts.packets, "packet");
  if (counts.refused > 0) packets += fmt::format(", {} not understood", counts.refused);
  if (counts.others > 0) packets += fmt::format("; {} of other senders ignored", counts.others);
  report.line("stream", counts.packets + counts.others > 0
                            ? fmt::format("{} in {}", counted(counts.frames, "frame"), packets)
                            : fmt::format("nothing came: no program sent {}", stream.name()));
  if (counts.frames > 1) report.line("jitter", fmt::format("{:.1f} ms", 1e3 * counts.jitter));
  if (stream.delayMs() > 0.0) {
    report.line("delay", fmt::format("{} ms, which the latency includes; {} came later", stream.delayMs(),
                                     counted(counts.late, "frame")));
  }
  if (stream.latency().empty()) return;
  const Percentiles latency = percentilesOf(stream.latency());
  report.line("latency", fmt::format("{:.2f} ms from a packet to its hulls; 95 % within {:.2f} ms",
                                     1e-3 * latency.median, 1e-3 * latency.p95));
}

void addDrawnTo(nlohmann::ordered_json& json, const DrawnFiles& drawn) {
  json["snapshots"] = drawn.snapshots;
  json["video"] = drawn.video.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(drawn.video);
  json["videoFrames"] = drawn.videoFrames;
}

void addDrawnTo(Report& report, const DrawnFiles& drawn) {
  if (!drawn.folder.empty()) {
    report.line("pictures", fmt::format("{} in {}", counted(drawn.snapshots, "PNG file"), drawn.folder));
  }
  if (!drawn.video.empty()) {
    report.line("video", fmt::format("{}, {}", drawn.video, counted(drawn.videoFrames, "frame")));
  }
}

Result<void> finishRecorder(Run& run, const std::string& file, Report& report, nlohmann::ordered_json& json) {
  if (!run.recorder) return {};
  LORICA_TRY(const int steps, run.recorder->finish());
  report.line("recorded", steps == 0 ? "no steps" : fmt::format("{} in {}", counted(steps, "step"), file));
  if (run.recorder->cutShort()) {
    report.note("The recording ends at the restart of the session, or at the change of its scene or number of parts.");
  }
  if (run.recorder->full()) {
    report.note(fmt::format("The recording ends where its file reached {} MiB, the most that is read.",
                            kMaxSessionBytes >> 20));
  }
  json["recorded"] = steps;
  return {};
}

}  // namespace lorica
