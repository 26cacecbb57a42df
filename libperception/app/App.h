#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"

namespace CLI {
class App;
}

namespace perception {

/// A program as a class, so that tests can run it in-process: public options, run(), public out_*
/// members. `main` is: `int main(int argc, char** argv) { perception::TrackRawlogApp app; return
/// perception::runApp(app, argc, argv); }`
class App {
 public:
  App(std::string name, std::string description)
      : name_(std::move(name)), description_(std::move(description)) {}
  virtual ~App() = default;

  // Common options; an app declares only those it uses.
  std::string config_file;            ///< -c/--config
  std::vector<std::string> inputs;    ///< -i/--input
  std::string output;                 ///< -o/--output
  std::vector<std::string> settings;  ///< --set section.key=value
  int threads = 0;                    ///< --threads; 0 = number of cores
  bool strict = false;                ///< --strict: damaged input is an error instead of a warning
  bool print_config =
      false;          ///< --print-config: write the effective INI to standard output and stop
  int verbosity = 0;  ///< -v

  const std::string& name() const { return name_; }
  const std::string& description() const { return description_; }
  /// Declares the program's options; use the add...() helpers for the common ones.
  virtual void declare(CLI::App& cli) = 0;
  virtual void run() = 0;

  /// Data warnings so far; a run that had some ends with exit code 3.
  int warnings() const { return warnings_; }

 protected:
  void addConfigOptions(CLI::App& cli, bool required);  ///< -c, --set, --print-config
  void addInputOption(CLI::App& cli, bool required);
  void addOutputOption(CLI::App& cli, bool required);
  void addRunOptions(CLI::App& cli);  ///< --threads, --strict

  /// The INI of -c with --set applied; Config::finish() throws faults.
  Config loadConfig() const;
  /// Call after all sections were read: throws on faults. With --print-config, prints and returns
  /// true; then return from run().
  bool configDone(const Config& config) const;
  /// Prints a message to standard error if verbosity >= level.
  void say(int level, const std::string& message) const;
  /// Prints a data warning to standard error and counts it.
  void warn(const std::string& message);

 private:
  friend int runApp(App& app, int argc, const char* const* argv);
  std::string name_, description_;
  int warnings_ = 0;
};

/// Parses the command line, runs the app and converts exceptions to messages ("perception-track:
/// error: ...") and exit codes.
int runApp(App& app, int argc, const char* const* argv);

}  // namespace perception
