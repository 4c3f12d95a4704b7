#include "apps/report_parts.h"

#include "collision/hulls/mesh_walls.h"
#include "geometry/text.h"
#include "viewer/player/run_statistics.h"

#include <fmt/format.h>

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

Facts coverFacts(const std::optional<HullCover>& cover, const std::optional<double>& volumeGrowth) {
  Facts facts;
  Json figures = {{"exact", true}};
  if (!cover || isExact(*cover)) {
    facts.line("cover", "exact: the surface is inside the hulls in every pose");
  } else {
    figures = {{"exact", false},
               {"tolerance", cover->tolerance},
               {"hullVertices", cover->maxHullVertices},
               {"sampledPoses", cover->sampledPoses},
               {"heldOutPoses", cover->heldOutPoses},
               {"growth", cover->growth},
               {"sampledShortfall", cover->sampledShortfall},
               {"heldOutShortfall", cover->heldOutShortfall}};
    for (const std::vector<CoverPoint>& points : cover->points) figures["pointsPerPart"].push_back(points.size());
    const auto [fewest, max] =
        std::ranges::minmax_element(cover->points, {}, [](const auto& part) { return part.size(); });
    const std::string range = fewest->size() == max->size() ? fmt::format("{}", max->size())
                                                            : fmt::format("{} to {}", fewest->size(), max->size());
    std::string chosen = fmt::format("{} points per part, chosen in {}", range, counted(cover->sampledPoses, "pose"));
    if (cover->tolerance > 0.0) chosen += fmt::format(", tolerance {}", millimetres(cover->tolerance));
    if (cover->maxHullVertices > 0) chosen += fmt::format(", at most {} per part", grouped(cover->maxHullVertices));
    facts.line("cover", chosen);
    facts.line("hulls enlarged", fmt::format("by up to {}; the surface protruded {} before", millimetres(cover->growth),
                                             millimetres(cover->sampledShortfall)));
    if (cover->heldOutPoses > 0) {
      facts.line("held-out poses",
                 fmt::format("the surface protrudes by at most {} in {}", millimetres(cover->heldOutShortfall),
                             counted(cover->heldOutPoses, "other pose")));
    }
  }
  if (volumeGrowth) figures["volumeGrowth"] = *volumeGrowth;
  if (volumeGrowth) facts.line("cover volume", percent(*volumeGrowth) + " more than exact hulls");
  facts.add("cover", std::move(figures));
  return facts;
}

Facts meshFacts(const Subject& subject) {
  Facts facts;
  if (!subject.repaired.empty()) facts.add("repaired", "repaired", subject.repaired);
  if (subject.body && !subject.body->walls.empty()) facts.add("walls", "walls", subject.body->walls);
  if (!subject.rebuilt) return facts;
  const RebuiltMesh& body = *subject.rebuilt;
  const BodyDistances& distances = body.distances;
  if (body.shells > 0) facts.line("walls", wallsInWords(body));
  std::string words;
  if (body.resolution > 0.0) {
    words = fmt::format(
        "built with voxels of {:.4g}, {}; from its surface to the original {:.4g} on average, {:.4g} at most; the "
        "original's vertices are up to {:.4g} outside, and in the hulls",
        body.resolution, body.problem.empty() ? "for --body always was given" : "because " + body.problem,
        distances.meanToOriginal, distances.farthestToOriginal, distances.farthestOutside);
  }
  facts.add("body", "closed body",
            {{"problem", orNull(body.problem)},
             {"voxel", body.resolution},
             {"vertices", body.firstOriginal},
             {"meanDistance", distances.meanToOriginal},
             {"farthestDistance", distances.farthestToOriginal},
             {"farthestOutside", distances.farthestOutside},
             {"shells", body.shells},
             {"solids", body.solids},
             {"shellShare", body.shellShare},
             {"thickness", body.thickness}},
            words);
  return facts;
}

Facts contactFacts(const RunStatistics& statistics) {
  Facts facts;
  facts.add("frames", statistics.frames());
  facts.add("contacts", statistics.contacts());
  facts.add("touches", statistics.touches());
  facts.add("propsTouched", statistics.propsTouched());
  facts.add("avatarTouches", statistics.avatarTouches());
  facts.add("selfContacts", selfContactsOf(statistics, 0));
  const std::vector<RunStatistics::SelfContacts>& all = statistics.selfContacts();
  for (std::size_t a = 0; a < all.size(); ++a) {
    const std::string what =
        all[a].frames == 0 ? "none, except between neighbours"
                           : fmt::format("{} of parts in {}; deepest overlap {:.1f} cm, parts {} and {} at {:.2f} s",
                                         counted(std::ssize(all[a].pairs), "pair"), counted(all[a].frames, "frame"),
                                         100.0 * all[a].deepest.depth, all[a].deepest.first, all[a].deepest.second,
                                         all[a].deepestTime);
    facts.line("self-contacts", all.size() == 1 ? what : fmt::format("avatar {}: {}", a + 1, what));
  }
  return facts;
}

Json selfContactsOf(const RunStatistics& statistics, std::size_t avatar) {
  if (avatar >= statistics.selfContacts().size()) return nullptr;
  const RunStatistics::SelfContacts& its = statistics.selfContacts()[avatar];
  Json json{{"frames", its.frames}, {"pairs", its.pairs}, {"deepest", nullptr}};
  if (its.frames > 0) {
    json["deepest"] = {
        {"parts", {its.deepest.first, its.deepest.second}}, {"depth", its.deepest.depth}, {"time", its.deepestTime}};
  }
  return json;
}

Facts trainingFacts(const RunStatistics& statistics) {
  Facts facts;
  const std::optional<RunStatistics::Training>& training = statistics.training();
  if (!training) {
    facts.add("training", "training", {}, "unknown: the decomposition does not store its training range");
    return facts;
  }
  Json json = {{"knownDistance", training->knownDistance},
               {"largestDistance", training->largest},
               {"framesOutside", training->framesOutside},
               {"firstOutside", nullptr}};
  const std::string far =
      fmt::format("at most {:.2f} m away; hulls fit up to {:.2f} m", training->largest, training->knownDistance);
  if (training->framesOutside == 0) {
    facts.add("training", "training", std::move(json),
              fmt::format("every pose is like one that the parts were made from ({})", far));
    return facts;
  }
  json["firstOutside"] = {{"frame", training->firstOutside}, {"time", training->firstTime}};
  facts.add("training", "training", std::move(json),
            fmt::format("{} of {} unlike those that the parts were made from, first at {:.2f} s (frame {})",
                        grouped(training->framesOutside), counted(statistics.frames(), "frame"), training->firstTime,
                        training->firstOutside));
  facts.line("", far);
  return facts;
}

Facts stageFacts(const RunStatistics& statistics, const std::string& heading) {
  Facts facts;
  Json stages;
  facts.gap();
  facts.line("frame time", heading);
  for (const StageRow& stage : kStages) {
    const std::string name = stage.name;
    const Percentiles spread = spreadOfStage(statistics.times(), stage);
    stages[name] = {{"median", spread.median}, {"p95", spread.p95}};
    if ((name == "springs" || name == "particles") && spread.p95 == 0.0) continue;  // there are none
    facts.line(name,
               fmt::format("{:>8}  (95 % below {:>8})  {}", duration(spread.median), duration(spread.p95), stage.what));
  }
  facts.add("stages", std::move(stages));
  return facts;
}

Facts hitFacts(const TargetHits& targets) {
  Facts facts;
  Json json = Json::array();
  for (std::size_t i = 0; i < targets.counter().targets().size(); ++i) {
    const HitCounter::Hits& hits = targets.counter().hitsOf(i);
    const std::string& name = targets.counter().targets()[i].name;
    Json target = {{"name", name}, {"hits", targets.scores()[i].hits}};
    std::string who;
    for (std::size_t limb = 0; limb < kHittingLimbs; ++limb) {
      target[kLimbs[limb].key] = hits[limb];
      if (hits[limb] > 0) who += fmt::format("{}{} {}", who.empty() ? ": " : ", ", kLimbs[limb].words, hits[limb]);
    }
    json.push_back(std::move(target));
    facts.line(i == 0 ? "targets" : "", fmt::format("{}, {}{}", name, counted(targets.scores()[i].hits, "hit"), who));
  }
  facts.add("targets", std::move(json));
  return facts;
}

Facts liveFacts(const LiveLog& log) {
  Facts facts;
  const LiveLog::Figures& figures = log.figures();
  const Percentiles track = percentilesOf(figures.track), latency = percentilesOf(figures.latency);
  facts.add("depthFrames", figures.frames);
  facts.add(
      "framesWithPerson", "person", figures.followed,
      figures.followed == 0
          ? fmt::format("{} in {}; stand where the camera sees all of you, or give it more --seconds",
                        figures.maxPeople > 0 ? "requested person not found" : "not found",
                        counted(figures.frames, "depth frame"))
          : fmt::format("tracked in {} of {}, first after {:.2f} s; at most {} at once", grouped(figures.followed),
                        counted(figures.frames, "depth frame"), *figures.firstPose, figures.maxPeople));
  facts.add("maxPeople", figures.maxPeople);
  facts.add("unplugged", "sensor", figures.unplugs,
            figures.unplugs > 0 ? "unplugged " + counted(figures.unplugs, "time") : "");
  facts.add("firstPose", orNull(figures.firstPose));
  const bool tracked = !figures.track.empty();
  facts.add("tracking", "tracking", {{"median", track.median}, {"p95", track.p95}},
            tracked ? fmt::format("{} per frame (95 % below {})", duration(track.median), duration(track.p95)) : "");
  facts.add("latency", "latency", {{"median", latency.median}, {"p95", latency.p95}},
            tracked ? fmt::format("{} from a depth frame to posed hulls (95 % below {})", duration(latency.median),
                                  duration(latency.p95))
                    : "");
  return facts;
}

Facts depthStreamFacts(const DepthStream& stream) {
  const DepthStream::Counts counts = stream.counts();
  std::string words = counted(counts.images, "image");
  if (counts.dropped > 0) words += fmt::format(", {} came too fast and were left out", grouped(counts.dropped));
  if (counts.broken > 0) words += fmt::format(", {} broke off", grouped(counts.broken));
  if (counts.senders != 1) words += "; " + counted(counts.senders, "sender");
  if (counts.refused > 0) words += fmt::format(", {} of them refused", counts.refused);
  Facts facts;
  facts.add("depthStream", "depth stream",
            {{"images", counts.images},
             {"dropped", counts.dropped},
             {"broken", counts.broken},
             {"senders", counts.senders},
             {"refused", counts.refused}},
            words);
  return facts;
}

Facts streamFacts(const VmcInput& stream) {
  Facts facts;
  const VmcStream::Counts counts = stream.counts();
  const Percentiles latency = percentilesOf(stream.latency());
  std::string packets = counted(counts.packets, "packet");
  if (counts.refused > 0) packets += fmt::format(", {} not understood", counts.refused);
  if (counts.others > 0) packets += fmt::format("; {} of other senders ignored", counts.others);
  facts.add("stream", "stream",
            {{"packets", counts.packets},
             {"refusedPackets", counts.refused},
             {"packetsOfOthers", counts.others},
             {"frames", counts.frames},
             {"jitter", 1e6 * counts.jitter},
             {"delay", stream.delayMs()},
             {"lateFrames", counts.late}},
            counts.packets + counts.others > 0 ? fmt::format("{} in {}", counted(counts.frames, "frame"), packets)
                                               : fmt::format("nothing came: no program sent {}", stream.name()));
  if (counts.frames > 1) facts.line("jitter", fmt::format("{:.1f} ms", 1e3 * counts.jitter));
  if (stream.delayMs() > 0.0) {
    facts.line("delay", fmt::format("{} ms, which the latency includes; {} came later", stream.delayMs(),
                                    counted(counts.late, "frame")));
  }
  facts.add("latency", "latency", {{"median", latency.median}, {"p95", latency.p95}},
            stream.latency().empty() ? ""
                                     : fmt::format("{:.2f} ms from a packet to its hulls; 95 % within {:.2f} ms",
                                                   1e-3 * latency.median, 1e-3 * latency.p95));
  return facts;
}

Facts drawnFacts(const DrawnFiles& drawn) {
  Facts facts;
  facts.add("snapshots", "pictures", drawn.snapshots,
            drawn.folder.empty() ? "" : fmt::format("{} in {}", counted(drawn.snapshots, "PNG file"), drawn.folder));
  facts.add("video", "video", orNull(drawn.video),
            drawn.video.empty() ? "" : fmt::format("{}, {}", drawn.video, counted(drawn.videoFrames, "frame")));
  facts.add("videoFrames", drawn.videoFrames);
  return facts;
}

Result<void> finishRecorder(Run& run, const std::string& file, Report& report) {
  if (!run.recorder) return {};
  LORICA_TRY(const int steps, run.recorder->finish());
  report.add("recorded", "recorded", steps,
             steps == 0 ? "no steps" : fmt::format("{} in {}", counted(steps, "step"), file));
  if (run.recorder->cutShort()) {
    report.note("The recording ends at the restart of the session, or at the change of its scene or number of parts.");
  }
  if (run.recorder->full()) {
    report.note(fmt::format("The recording ends where its file reached {} MiB, the most that is read.",
                            kMaxSessionBytes >> 20));
  }
  return {};
}

}  // namespace lorica
