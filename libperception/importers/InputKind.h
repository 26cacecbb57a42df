#pragma once
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// A recording that was recognized: its format, its content, and how to import it.
struct InputKind {
  std::string what;                ///< "a recording of ROS", in words
  std::vector<std::string> holds;  ///< a line each
  std::vector<std::string>
      commands;  ///< perception-import ... to copy; what is missing in capitals
};

/// Told by names and first bytes. A folder that holds one recording below it is that recording.
/// Empty: a rawlog, which needs no import. Throws DataError: missing (kNoInput), or nothing that is
/// known, with what is.
std::optional<InputKind> inputKind(const std::string& path);

/// Lines for the terminal.
std::string textOf(const InputKind& kind, const std::string& path);

}  // namespace perception
