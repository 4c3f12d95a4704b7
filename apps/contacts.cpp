#include "apps/option_groups.h"
#include "apps/options.h"
#include "export/contact_export.h"
#include "geometry/errors.h"

#include <nlohmann/json.hpp>

namespace lorica {

Command addContacts(CommandLine& parent, CommonOptions& common) {
  const auto request = std::make_shared<ContactRequest>();
  const auto output = std::make_shared<std::string>();
  CommandLine* app = addSubcommand(parent, common, "contacts", "Write a table of all contacts in a motion.",
                                   "  lorica contacts walk.bvh -o walk.npz\n"
                                   "      floor and self-contacts, which foot stands; for numpy.load()\n"
                                   "  lorica contacts a.bvh,b.bvh --character hero.glb --scene boxes -o both.csv\n"
                                   "      two people among boxes\n"
                                   "\nA row a contact and frame: docs/CONTACTS.md has the columns.");
  addMotionOptions(*app, request->cast);
  app->addOption("-o,--out", *output, "Output file: .npz, .csv or .jsonl", "FILE");
  addLength(*app, "--near", request->near, "Also pairs that are apart by at most this [default: 0.05]");
  addBodyOptions(*app, request->cast.body);
  app->addOption("--scene", request->cast.scene, "Scene, as of `lorica play` [default: a floor]", "SCENE");
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
            Report report(labels.inWords());
            report.line("output", *output);
            for (const std::string& note : labels.notes) report.note(note);
            return publish(given, report, labels.summary());
          }};
}

}  // namespace lorica
