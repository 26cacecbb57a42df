#pragma once
#include <stdexcept>
#include <string>

namespace perception {

/// Exit codes of the programs: those of BSD sysexits.h, and 3. Only kTryAgain is worth a retry.
enum class ExitCode : int {
  kOk = 0,
  kDataWarnings = 3,   ///< finished; part of the data was missing or bad, as the result reports
  kUsage = 64,         ///< wrong command line
  kBadInput = 65,      ///< an input file cannot be used
  kNoInput = 66,       ///< an input file does not exist
  kUnavailable = 69,   ///< a resource of the machine is missing (no OpenGL, no device)
  kInternal = 70,      ///< internal error: a bug in the program
  kCannotCreate = 73,  ///< the output cannot be created
  kIoError = 74,       ///< reading or writing failed midway (disk full)
  kTryAgain = 75,      ///< stopped by a signal or busy
  kBadConfig = 78      ///< a configuration file or value is wrong
};

/// Whether a program may end with this code.
constexpr bool isExitCode(int code) {
  switch (static_cast<ExitCode>(code)) {
    case ExitCode::kOk:
    case ExitCode::kDataWarnings:
    case ExitCode::kUsage:
    case ExitCode::kBadInput:
    case ExitCode::kNoInput:
    case ExitCode::kUnavailable:
    case ExitCode::kInternal:
    case ExitCode::kCannotCreate:
    case ExitCode::kIoError:
    case ExitCode::kTryAgain:
    case ExitCode::kBadConfig:
      return true;
  }
  return false;
}

/// Base of all errors that end a run with a message and an exit code; only app/runApp catches them.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// A wrong configuration. The message has one line per fault, each with file and line.
class ConfigError : public Error {
 public:
  explicit ConfigError(const std::string& message) : Error(ExitCode::kBadConfig, message) {}
};

/// An input that is missing (kNoInput) or cannot be used (kBadInput); the message names path and
/// position.
class DataError : public Error {
 public:
  explicit DataError(const std::string& message, ExitCode code = ExitCode::kBadInput)
      : Error(code, message) {}
};

/// An output that cannot be created (kCannotCreate) or written (kIoError); the message names the
/// path.
class OutputError : public Error {
 public:
  explicit OutputError(const std::string& message, ExitCode code = ExitCode::kCannotCreate)
      : Error(code, message) {}
};

}  // namespace perception
