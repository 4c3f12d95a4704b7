#include "apps/option_groups.h"
#include "apps/options.h"
#include "export/contact_export.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <array>

namespace lorica {
namespace {

Report contactReport(const ContactLabels& labels, const std::string& output) {
  Report report(fmt::format("{}: {}, {}, {}", labels.name, counted(countOf(labels.times), "frame"),
                            counted(std::int64_t(labels.rowCount), "row"),
                            counted(std::int64_t(labels.overlaps), "of them an overlap", "of them overlaps")));
  report.add("motion", labels.name);
  report.add("frames", labels.times.size());
  report.add("rows", labels.rowCount);
  report.add("overlaps", labels.overlaps);
  Json avatars = Json::array();
  for (std::size_t a = 0; a < labels.avatars; ++a) {
    std::array<std::size_t, 2> stands{};  // frames
    for (std::size_t i = 0; i < labels.standing.size(); ++i) {
      if (i / 2 % labels.avatars == a) stands[i % 2] += labels.standing[i];
    }
    avatars.push_back({{"leftFootStands", stands[0]}, {"rightFootStands", stands[1]}});
  }
  report.add("avatars", std::move(avatars));
  report.add("notes", labels.notes);
  report.line("output", output);
  for (const std::string& note : labels.notes) report.note(note);
  return report;
}

}  // namespace

Command addContacts(CLI::App& parent, CommonOptions& common) {
  const auto request = std::make_shared<ContactRequest>();
  const auto output = std::make_shared<std::string>();
  CLI::App* app =
      addSubcommand(parent, common, "contacts",
                    "Write a table of all contacts in a motion: feet on the floor, parts of the body, objects.",
                    "  lorica contacts walk.bvh -o walk.npz\n"
                    "      floor and self-contacts, which foot stands; for numpy.load()\n"
                    "  lorica contacts a.bvh,b.bvh --character hero.glb --scene boxes -o both.csv\n"
                    "      two people among boxes\n"
                    "\nA row a contact and frame: docs/CONTACTS.md has the columns.");
  addMotionOptions(*app, request->cast);
  addOption(*app, "-o,--out", *output, "FILE", "Output file: .npz, .csv or .jsonl");
  addLength(*app, "--near", request->near, "Also pairs that are apart by at most this [default: 0.05]");
  addBodyOptions(*app, request->cast.body);
  addOption(*app, "--scene", request->cast.scene, "SCENE", "Scene, as of `lorica play` [default: a floor]");
  return {app, [request, output](const CommonOptions& given, Host& host) -> Result<void> {
            const CastRequest& cast = request->cast;
            const bool nothing = cast.motion.empty() && cast.character.empty() && cast.scene.empty();
            if (nothing || output->empty()) {
              return invalidArgument("{} is missing, as in `lorica contacts walk.bvh -o walk.npz`",
                                     nothing ? "the motion" : "-o FILE");
            }
            LORICA_TRY_DO(checkJsonOutput(given, {*output}));
            LORICA_TRY_DO(checkNotTaken("-o", *output, request->cast.files()));
            LORICA_TRY_DO(checkOutput(given, "-o", *output));
            LORICA_TRY(const ContactLabels labels, writeContacts(*request, *output, host));
            return publish(given, contactReport(labels, *output));
          }};
}

}  // namespace lorica
