#pragma once

/// XML from strangers, and changes of it that leave all other bytes as they are. Internal: not installed.

#include "geometry/files.h"
#include "geometry/result.h"

#include <pugixml.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

inline constexpr std::uint64_t kMaxXmlBytes = std::uint64_t{16} << 20;
inline constexpr int kMaxXmlDepth = 200;         ///< of elements in elements, included ones too
inline constexpr int kMaxXmlElements = 200'000;  ///< of a robot, in all its files

/// New values of attributes, each with its name; without a value the attribute is removed.
using XmlEdits = std::vector<std::pair<std::string, std::optional<std::string>>>;

/// The text of an element with other values of some attributes. Those that it has keep their place, others come first.
/// @param element  well-formed, from its "<" on
[[nodiscard]] std::string editedElement(std::string_view element, const XmlEdits& edits);

/// "<", "&" and quotes as entities.
[[nodiscard]] std::string escapedXml(std::string_view text);

/// A file of XML: UTF-8, without a DTD, so that no entity grows and no other file is read; bounded in size and depth.
class XmlText {
 public:
  /// @param shown  the file's name in errors
  [[nodiscard]] static Result<XmlText> read(const std::filesystem::path& file, std::string shown, NamedBy by);

  [[nodiscard]] const std::string& shown() const { return shown_; }
  /// Levels of elements in elements.
  [[nodiscard]] int deepest() const { return deepest_; }
  [[nodiscard]] int elements() const { return elements_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_.size(); }
  [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
  /// "robot.xml:12", for errors.
  [[nodiscard]] std::string where(pugi::xml_node node) const;

  /// An element's bytes in the file.
  [[nodiscard]] std::string_view textOf(pugi::xml_node element) const;
  /// Replaces an element by texts, each on a line of its own. Elements that are replaced do not contain each other.
  void replace(pugi::xml_node element, const std::vector<std::string>& texts);
  /// Adds text as an element's last content. @param element  has an end tag
  void append(pugi::xml_node element, std::string text);
  [[nodiscard]] bool changed() const { return !splices_.empty(); }
  /// The file with all replacements.
  [[nodiscard]] std::string changedText() const;

 private:
  /// White space before an element in its line.
  [[nodiscard]] std::string_view indentOf(pugi::xml_node element) const;
  [[nodiscard]] std::size_t lineAt(std::size_t offset) const;

  struct Splice {
    std::size_t begin = 0, end = 0;
    std::string text;
  };
  std::string shown_;
  int deepest_ = 0, elements_ = 0;
  std::string mark_;                ///< byte order mark, or nothing
  std::string bytes_;               ///< behind it
  std::vector<std::size_t> lines_;  ///< where they begin
  std::unique_ptr<pugi::xml_document> document_;
  std::vector<Splice> splices_;
};

/// Numbers of an attribute, separated by white space.
/// @param where  of the element, for errors
/// @return from `least` to `most` finite numbers
[[nodiscard]] Result<std::vector<double>> numbersOf(const std::string& where, std::string_view attribute,
                                                    std::string_view text, std::size_t least, std::size_t most);

}  // namespace lorica
