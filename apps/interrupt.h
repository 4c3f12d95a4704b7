#pragma once

namespace lorica {

/// After this call SIGINT (Ctrl-C), SIGTERM and SIGHUP request a clean stop, and writing to a closed pipe or beyond
/// the limit of file sizes is an error instead of a signal. A signal that was ignored when the program started stays
/// ignored (nohup).
///
/// A program that has not ended 0.4 s after the signal, because a step takes long, is ended: recordings are finished,
/// temporary files and folders removed (geometry/hard_stop.h), the status is that of the signal. A second signal does
/// the same at once, a third ends the program without all that.
void watchInterrupt();

/// Whether one of these signals came since watchInterrupt().
[[nodiscard]] bool interrupted();

/// The program is ending by itself and needs no help: only a second signal ends it early.
void answerInterrupt();

/// Prints that the command was cancelled, once.
void sayCancelled();

/// Exit status of a program ended by a signal, as shells report it: 128 and the number of the signal; 130 for Ctrl-C.
[[nodiscard]] int interruptedStatus();

}  // namespace lorica
