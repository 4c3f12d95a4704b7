#pragma once

#include <string>
#include <vector>

namespace lorica {

/// `lorica FILE` opens whatever it is: motions, characters, recordings and scenes are played, in a window if there is a
/// display; sessions are replayed; meshes are props in a window, else described; so is anything else. What ships is
/// named without a folder. `lorica replay FILE` plays what is no session.
/// @param words     of the command line, after the program's name
/// @param commands  the subcommands, which win over files of their names
/// @return the words with the subcommand in front; unchanged if the first names no file
[[nodiscard]] std::vector<std::string> withCommand(std::vector<std::string> words,
                                                   const std::vector<std::string>& commands);

}  // namespace lorica
