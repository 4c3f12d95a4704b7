#pragma once

namespace lorica {

/// From now on, losing the connection to the display ends the program: the tasks of AtHardStop run, a sentence goes to
/// standard error, the exit status is 2. X11 would end it too, without them. Call it after glfwInit().
void endWithDisplay();

}  // namespace lorica
