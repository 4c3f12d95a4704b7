#pragma once

/// The elements of an MJCF model, from all its files, and what holds for them. Internal: not installed.

#include "export/robots/robot.h"
#include "export/robots/xml_text.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

/// A path of a file that is written, which no other one has: those get "_" at their ends.
[[nodiscard]] std::filesystem::path freePath(std::filesystem::path path, std::set<std::filesystem::path>& taken);

/// An element and the file that it is in.
struct MjcfElement {
  std::size_t file = 0;
  pugi::xml_node node;

  [[nodiscard]] bool is(std::string_view name) const { return node.name() == name; }
  /// The text of an attribute; empty if it has none.
  [[nodiscard]] std::string text(const char* attribute = "name") const { return node.attribute(attribute).value(); }
};

/// What has been read of a robot, with all that its file includes and attaches.
struct MjcfBudget {
  std::size_t files = 0, bytes = 0;
  int elements = 0;
};

/// One model: what MuJoCo compiles with one compiler's settings, defaults and assets.
class MjcfTree {
 public:
  /// @param home    the folder of the robot's file: what is named is there or below
  /// @param inside  the folder of the model's own file in it
  MjcfTree(const RobotReading& reading, MjcfBudget& budget, std::filesystem::path home, std::filesystem::path inside)
      : reading_(reading), budget_(budget), home_(std::move(home)), inside_(std::move(inside)) {}

  /// Reads a model, the files that it includes, and its defaults.
  [[nodiscard]] Result<void> read(const std::filesystem::path& file, const std::string& shown, NamedBy by);

  /// Calls visit(MjcfElement) -> Result<void> for the children of an element, those of included files in their place.
  template <typename Visit>
  Result<void> forEachChild(const MjcfElement& parent, const Visit& visit) const {
    for (const pugi::xml_node& child : parent.node.children()) {
      if (child.type() != pugi::node_element) continue;
      const auto included = includes_.find(child.internal_object());
      if (included == includes_.end()) {
        LORICA_TRY_DO(visit(MjcfElement{parent.file, child}));
      } else {
        LORICA_TRY_DO(forEachChild({included->second, files_[included->second].xml.root()}, visit));
      }
    }
    return {};
  }
  /// The same for all sections of a name: "asset".
  template <typename Visit>
  Result<void> forEachIn(const std::string& section, const Visit& visit) const {
    for (const MjcfElement& each : sections(section)) LORICA_TRY_DO(forEachChild(each, visit));
    return {};
  }
  [[nodiscard]] const std::vector<MjcfElement>& sections(const std::string& name) const;

  /// "robot.xml:12", for errors.
  [[nodiscard]] std::string where(const MjcfElement& element) const { return xml(element).where(element.node); }
  /// An attribute as it holds: the element's own, else that of its class, else that of the class around.
  [[nodiscard]] std::optional<std::string> value(const MjcfElement& element, const std::string& name,
                                                 const std::string& classOf) const;
  /// The class of an element. @param childclass  that holds around it
  [[nodiscard]] Result<std::string> classOf(const MjcfElement& element, const std::string& childclass) const;
  /// A setting of the compiler.
  [[nodiscard]] std::string setting(const char* name, const char* usual) const;
  /// Where an element is in its parent.
  [[nodiscard]] Result<Isometry3> poseOf(const MjcfElement& element, const std::string& classOfIt = "") const;
  /// A file that an element names, from the folder of the model's file.
  [[nodiscard]] Result<std::filesystem::path> find(const std::string& name) const;
  /// The folder of the model's file, from that of the robot's; empty: the same.
  [[nodiscard]] const std::filesystem::path& inside() const { return inside_; }

  /// The text that an element is in, to be changed.
  [[nodiscard]] XmlText& xml(const MjcfElement& element) { return files_[element.file].xml; }
  [[nodiscard]] const XmlText& xml(const MjcfElement& element) const { return files_[element.file].xml; }
  [[nodiscard]] MjcfElement root() const { return {0, files_.front().xml.root()}; }
  /// Whether one of its files changed.
  [[nodiscard]] bool changed() const;
  /// Files that changed, and the first; included ones get names beside that. To be called once.
  /// @param out    of the first file
  /// @param taken  files that are written already; those of the model are added
  [[nodiscard]] std::vector<RobotOutput> outputs(const std::filesystem::path& out,
                                                 std::set<std::filesystem::path>& taken);

  std::vector<std::filesystem::path> sources;  ///< the files
  std::set<std::string> meshNames, geomNames;  ///< that other elements may not get
  std::set<std::string> usedNames;             ///< of geoms that something else than a pair refers to

 private:
  struct File {
    XmlText xml;
    std::filesystem::path path;
    int level = 0;  ///< of its root in the whole
  };
  struct DefaultClass {
    std::string parent;
    std::map<std::string, std::string> values;  ///< "geom contype"
  };
  [[nodiscard]] Result<void> load(const std::filesystem::path& path, const std::string& shown, NamedBy by, int level);
  [[nodiscard]] Result<void> include(std::size_t from, pugi::xml_node node);
  void noteNames(const MjcfElement& element);
  [[nodiscard]] Result<void> readSection(const MjcfElement& element);
  [[nodiscard]] Result<void> readDefault(const MjcfElement& element, const std::string& parent);

  const RobotReading& reading_;
  MjcfBudget& budget_;
  std::filesystem::path home_, inside_;
  std::vector<File> files_;
  std::vector<std::filesystem::path> open_;  ///< those that include the one that is read
  std::map<pugi::xml_node_struct*, std::size_t> includes_;
  std::map<std::string, std::string> compiler_;
  std::string root_;  ///< the class of all without one
  std::map<std::string, DefaultClass> defaults_;
  std::map<std::string, std::vector<MjcfElement>> sections_;  ///< by name
};

}  // namespace lorica
