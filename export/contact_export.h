#pragma once

#include "geometry/arrays/array_file.h"
#include "geometry/result.h"
#include "geometry/work_budgets.h"
#include "session/prepare/cast.h"
#include "session/scenes/contact_table.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// Whose contacts are wanted.
struct ContactRequest {
  CastRequest cast;
  double near = ContactTable::kNear;  ///< greatest distance that is reported [m]
  std::size_t mostRows = kMaxContactRows;
};

/// The contacts of a motion, see ContactTable.
struct ContactLabels {
  std::string name;  ///< of the motion: "walk"
  std::size_t avatars = 0;
  std::size_t rowCount = 0;
  std::size_t overlaps = 0;            ///< rows whose depth is above 0
  std::vector<double> times;           ///< of the frames [s]
  std::vector<std::uint8_t> standing;  ///< for each frame and avatar whether the left and the right foot stands
  std::vector<std::string> bones;      ///< names; ContactRow::bone and otherBone are indices of it here
  std::vector<std::string> notes;      ///< one sentence each, such as that a motion is nowhere near the floor
  std::deque<ContactRow> rows;         ///< if they were not taken
};

/// Plays motions as `lorica play` does and finds all contacts. Without a scene the world has a floor only.
/// @param take  gets each row, with the names of bones so far; null = they are kept
/// @return the labels, or an error: what prepareCast() refuses, or more rows than asked for
[[nodiscard]] Result<ContactLabels> findContacts(
    const ContactRequest& request, Host& host,
    const std::function<Result<void>(const ContactRow& row, std::span<const std::string> bones)>& take = nullptr);

/// The labels as arrays, one at a time: a column of the rows each, then frame_time, frame_standing, bones, and the
/// words of kind, foot and phase.
[[nodiscard]] Result<void> forEachArray(const ContactLabels& labels,
                                        const std::function<Result<void>(const NamedArray& array)>& visit);

/// findContacts() into a file, which is written completely or not at all: .csv and .jsonl row by row, .npz (an
/// uncompressed archive of arrays for numpy) at the end. The same input gives the same bytes.
/// @return the labels without rows
[[nodiscard]] Result<ContactLabels> writeContacts(const ContactRequest& request, const std::string& file, Host& host);

}  // namespace lorica
