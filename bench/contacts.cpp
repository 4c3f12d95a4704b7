// Tables of contacts against the skin by brute force, and the time that a frame of one takes. CSV on standard output.

#include "bench/measure.h"
#include "bench/skin_contacts.h"
#include "prepare/cast.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

namespace lorica::bench {
namespace {

double millimetre(double metres) {
  return 1e3 * metres;
}

/// @return whether the motion could be played
bool measure(const std::string& motion, const std::string& character, int frames) {
  Host host;
  CastRequest request;
  request.motion = motion;
  request.character = character;
  Result<Cast> cast = prepareCast(request, host);
  if (!cast) {
    fmt::print(stderr, "{}\n", cast.error().message);
    return false;
  }
  cast->world = fixedBalls();
  Session session = startSession(*cast).value();
  ContactTable table(session);
  SkinComparison sum;
  std::vector<double> times;
  while ((frames == 0 || session.frameCount() < frames) && session.step().value()) {
    const auto begin = std::chrono::steady_clock::now();
    const std::span<const ContactRow> rows = table.update(session);
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    compareWithSkin(session, rows, sum);
  }
  std::vector<double> apart = sum.apart;
  std::ranges::sort(apart);
  const auto share = [&](double part) {
    return apart.empty() ? 0.0 : apart[static_cast<std::size_t>(part * static_cast<double>(apart.size() - 1))];
  };
  const auto touching = std::ranges::count(apart, 0.0);
  const double standOff = sum.standOff.empty() ? 0.0 : *std::ranges::max_element(sum.standOff);
  fmt::print("{},{},{},{},{},{},{},{},{:.4f},{:.4f},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f},{:.0f}\n", cast->name,
             sum.frames, sum.rows, sum.floors, sum.props, sum.pairs, sum.deep, sum.missed, millimetre(sum.floorError),
             millimetre(sum.gapError), touching, millimetre(share(0.5)), millimetre(share(0.95)),
             millimetre(share(1.0)), millimetre(standOff), millimetre(sum.beyond), medianOf(times));
  std::fflush(stdout);
  return true;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  CLI::App app("Contact tables against the skin.");
  std::vector<std::string> motions = {"walk",           "wave",        "jumping_jacks", "squat_and_reach",
                                      "punch_and_kick", "turn_around", "walk_noisy",    "punch_and_kick_noisy"};
  std::string character;
  int frames = 0;
  app.add_option("MOTION", motions, "Motions [default: those that ship]");
  app.add_option("--character", character, "Character [default: mannequin]");
  app.add_option("--frames", frames, "Of each motion at most; 0 = all");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "motion,frames,rows,in_floor,in_balls,in_itself,skins_deeper_than_5_mm,missed,floor_error_mm,gap_error_mm,"
      "skins_overlap,apart_median_mm,apart_95_mm,apart_most_mm,stand_off_mm,beyond_stand_off_mm,frame_us\n");
  bool fine = true;
  for (const std::string& motion : motions) fine = lorica::bench::measure(motion, character, frames) && fine;
  return fine ? 0 : 1;
}
