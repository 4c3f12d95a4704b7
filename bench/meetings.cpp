// Two people who shake hands, box, hug and change places before the virtual camera, as two avatars: who is who in each
// frame, and contacts compared with the true meshes. CSV on standard output.

#include "bench/measure.h"
#include "bench/meeting_run.h"
#include "bench/walker.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>

namespace lorica::bench {
namespace {

int run(int parts, int seeds, const MeetingSettings& settings) {
  const Result<Decomposition> body = decomposeMannequin(makeMannequin(), parts);
  if (!body) return fail(body.error());
  fmt::print(
      "action,seed,frames,both_since,lost,exchanged,mean_mm,compared,touching,contacts,missed,missed_2cm,false,"
      "false_2cm,farthest_false_mm,points,points_off_2cm,people_touch_2cm,of_it_without_contact\n");
  for (const Meeting& meeting : meetings()) {
    for (int seed = 1; seed <= seeds; ++seed) {
      MeetingSettings seeded = settings;
      seeded.noise.seed = static_cast<std::uint64_t>(seed);
      const Result<MeetingResult> done = runMeeting(meeting, *body, seeded);
      if (!done) return fail(done.error());
      fmt::print("{},{},{},{},{},{},{:.0f},{},{},{},{},{},{},{},{:.1f},{},{},{},{}\n", meeting.name, seed, done->frames,
                 done->bothSince.value_or(-1), done->lost, done->exchanged, done->errorMm, done->compared,
                 done->touching, done->contacts, done->missed, done->missed2cm, done->wrong, done->wrong2cm,
                 done->farthestWrongMm, done->points, done->pointsOff2cm, done->peopleTouch, done->peopleTouchMissed);
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::MeetingSettings settings;
  int parts = 16, seeds = 1;
  CLI::App app("Two people who touch before the virtual camera, as two avatars.");
  app.add_option("--parts", parts, "Parts of the mannequin")->check(CLI::PositiveNumber);
  app.add_option("--seeds", seeds, "Noisy runs of each action")->check(CLI::PositiveNumber);
  app.add_option("--every", settings.every, "Compare every n-th frame with the meshes")->check(CLI::PositiveNumber);
  app.add_option("--rate", settings.framesPerSecond, "Depth images a second")->check(CLI::Range(5.0, 60.0));
  app.add_option("--width", settings.camera.width, "Columns of the depth image; the rows are three quarters of them")
      ->check(CLI::Range(80, 1280));
  CLI11_PARSE(app, argc, argv);
  settings.camera.height = settings.camera.width * 3 / 4;
  return lorica::bench::run(parts, seeds, settings);
}
