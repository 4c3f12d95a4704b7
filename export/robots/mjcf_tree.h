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
#include <vector>

namespace lorica {

/// An element and the file that it is in.
struct MjcfElement {
  std::size_t file = 0;
  pugi::xml_node node;

  [[nodiscard]] bool is(std::string_view name) const { return node.name() == name; }
  /// The text of an attribute; empty if it has none.
  [[nodiscard]] std::string text(const char* attribute = "name") const { return node.attribute(attribute).value(); }
};

class MjcfTree {
 public:
  explicit MjcfTree(const RobotReading& reading) : reading_(reading) {}

  /// Reads a model, the files that it includes, and its defaults.
  [[nodiscard]] Result<void> read(const std::filesystem::path& file);

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
  /// A file that an element names.
  [[nodiscard]] Result<std::filesystem::path> find(const std::string& name) const {
    return NamedFiles{folder_, reading_.trust}.find(name);
  }

  /// The text that an element is in, to be changed.
  [[nodiscard]] XmlText& xml(const MjcfElement& element) { return files_[element.file].xml; }
  [[nodiscard]] const XmlText& xml(const MjcfElement& element) const { return files_[element.file].xml; }
  [[nodiscard]] MjcfElement root() const { return {0, files_.front().xml.root()}; }
  /// Files that changed; included ones get names beside the robot's. To be called once. @param out  of the first file
  [[nodiscard]] std::vector<RobotOutput> outputs(const std::filesystem::path& out);

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
  std::filesystem::path folder_;
  std::vector<File> files_;
  std::size_t bytes_ = 0;                    ///< of all files
  int elements_ = 0;                         ///< the same
  std::vector<std::filesystem::path> open_;  ///< those that include the one that is read
  std::map<pugi::xml_node_struct*, std::size_t> includes_;
  std::map<std::string, std::string> compiler_;
  std::string root_;  ///< the class of all without one
  std::map<std::string, DefaultClass> defaults_;
  std::map<std::string, std::vector<MjcfElement>> sections_;  ///< by name
};

}  // namespace lorica
