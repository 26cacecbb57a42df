#include "libperception/app/App.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/core/system/KeptHeap.h"
#include "libperception/core/system/MemoryLimit.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {
namespace {

void printLine(const std::string& line) {
  clearProgressBar();
  std::fputs((line + "\n").c_str(), stderr);  // whoever does not hear it still gets the result
}

/// Of an option that takes one value and may be repeated, CLI11 says "...".
class Formatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string many = " ...";
    if (const auto at = text.find(many); at != std::string::npos && !takesMany(*option))
      text.replace(at, many.size(), option->get_delimiter() == '\0' ? " (repeatable)" : "");
    return text;
  }

 private:
  static bool takesMany(const CLI::Option& option) {
    return option.get_allow_extra_args() && option.get_delimiter() == '\0';
  }
};

// A single line unchanged; several faults as an indented list.
void printError(const App& app, const std::string& message) {
  if (message.find('\n') == std::string::npos) {
    return printLine(fmt::format("{}: error: {}", app.name(), message));
  }
  std::string lines = fmt::format("{}: error: several faults:", app.name());
  std::size_t begin = 0;
  while (begin <= message.size()) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    lines += "\n  " + message.substr(begin, end - begin);
    begin = end + 1;
  }
  printLine(lines);
}

// Parses the command line into the app; returns an exit code if the program ends here.
int parse(App& app, CLI::App& cli, int argc, const char* const* argv) {
  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help, --version
    return cli.exit(asked);
  } catch (const CLI::ParseError& error) {
    printError(app, error.what());
    printLine("Run with --help for the options.");
    return static_cast<int>(ExitCode::kUsage);
  }
  return -1;
}

bool isOfTheDisk(const std::error_code& code) {
  return code == std::errc::no_space_on_device || code == std::errc::io_error ||
         code == std::errc::read_only_file_system || code == std::errc::file_too_large ||
         code == std::errc::broken_pipe || code == std::errc::bad_file_descriptor;
}

ExitCode runGuarded(App& app) {
  try {
    app.run();
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
      throw OutputError("standard output: cannot be written", ExitCode::kIoError);
    }
    return app.warnings() > 0 ? ExitCode::kDataWarnings : ExitCode::kOk;
  } catch (const Error& error) {
    printError(app, error.what());
    return error.code();
  } catch (const std::system_error& error) {  // of fmt::print and std::filesystem
    if (isOfTheDisk(error.code())) {
      printError(app, error.what());
      return ExitCode::kIoError;
    }
    printError(app, fmt::format("internal: {}", error.what()));
  } catch (const std::bad_alloc&) {
    printError(app, "internal: out of memory");
  } catch (const std::exception& error) {
    printError(app, fmt::format("internal: {}", error.what()));
  } catch (...) {
    printError(app, "internal: an exception of unknown type");
  }
  return ExitCode::kInternal;
}

}  // namespace

void App::addConfigOptions(CLI::App& cli, bool required) {
  cli.add_option("-c,--config", config_file, "Configuration file (INI)")->required(required);
  cli.add_option("--set", settings, "Change one value of the configuration: section.key=value")
      ->allow_extra_args(false);
  cli.add_flag("--print-config", print_config,
               "Print every key of the effective configuration, with unit and range, and exit");
}

void App::addInputOption(CLI::App& cli, bool required) {
  cli.add_option("-i,--input", inputs, "Input: one file or several")->required(required);
}

void App::addOutputOption(CLI::App& cli, bool required) {
  cli.add_option("-o,--output", output, "Where the results go: a folder or a file")
      ->required(required);
}

void App::addRunOptions(CLI::App& cli) {
  constexpr int kMostThreads = 4096;
  cli.add_option("--threads", threads, "Number of threads; 0 = as many as the machine has")
      ->check(CLI::Range(0, kMostThreads));
  cli.add_flag("--strict", strict, "Treat damaged input as an error instead of a warning");
}

Config App::loadConfig() const {
  Config config = config_file.empty() ? Config::fromText("", "(no configuration file)")
                                      : Config::fromFile(config_file);
  for (const auto& assignment : settings) config.set(assignment);
  return config;
}

bool App::configDone(const Config& config) const {
  config.finish();
  if (print_config) fmt::print("{}", config.effectiveText());
  return print_config;
}

void App::say(int level, const std::string& message) const {
  if (verbosity >= level) printLine(message);
}

void App::warn(const std::string& message) {
  ++warnings_;
  printLine(fmt::format("{}: warning: {}", name(), message));
}

int runApp(App& app, int argc, const char* const* argv) {
  app.warnings_ = 0;
  keepFreedMemory();
  CLI::App cli(app.description(), app.name());
  cli.formatter(std::make_shared<Formatter>());
  cli.set_version_flag("--version", fmt::format("{} {}", app.name(), PERCEPTION_VERSION));
  cli.add_flag("-v,--verbose", app.verbosity, "Print more; may be repeated");
  cli.footer(
      "Exit codes: 0 done; 3 done, but part of the data was missing or bad; 64 wrong command "
      "line;\n"
      "65 input cannot be used; 66 no such input; 69 the machine lacks something; 70 internal "
      "error;\n"
      "73 output cannot be created; 74 reading or writing failed; 75 stopped, try again; 78 wrong "
      "configuration");
  try {
    app.declare(cli);
  } catch (const CLI::Error& error) {  // an option declared twice: an internal error
    printError(app, fmt::format("internal: {}", error.what()));
    return static_cast<int>(ExitCode::kInternal);
  }
  const int ended = parse(app, cli, argc, argv);
  if (ended >= 0) return ended;
  const StopSignals listening;
  const MemoryLimit limit;  // a corrupt size in a log must not exhaust the machine's memory
  return static_cast<int>(runGuarded(app));
}

}  // namespace perception
