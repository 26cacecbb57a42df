#include "libperception/app/App.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>
#include <utility>

#include "libperception/sensors/MemoryLimit.h"

namespace perception {
namespace {

volatile std::sig_atomic_t signal_seen = 0;  // number of the first SIGINT or SIGTERM
bool bar_shown = false;  // a progress bar stands in the last line of the terminal

// The first signal asks the run to end at the next frame; the second one kills as if nobody
// listened.
extern "C" void onStopSignal(int number) {
  signal_seen = number;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

/// Listens to SIGINT and SIGTERM while it lives.
class StopSignals {
 public:
  StopSignals() {
    signal_seen = 0;
    struct sigaction action = {};
    action.sa_handler = &onStopSignal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &before_int_);
    sigaction(SIGTERM, &action, &before_term_);
  }
  ~StopSignals() {
    sigaction(SIGINT, &before_int_, nullptr);
    sigaction(SIGTERM, &before_term_, nullptr);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  struct sigaction before_int_ = {}, before_term_ = {};
};

void printLine(const std::string& line) {
  fmt::print(stderr, "{}{}\n", std::exchange(bar_shown, false) ? "\r\x1b[K" : "", line);
}

// One line as it is; a list of faults below a line that counts them.
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

// Fills the app from the command line; the exit code when the program ends here.
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
         code == std::errc::read_only_file_system || code == std::errc::file_too_large;
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

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string clockText(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds + 0.5);
  return whole >= 3600 ? fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
                       : fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

void App::addConfigOptions(CLI::App& cli, bool required) {
  cli.add_option("-c,--config", config_file, "Configuration file (INI)")->required(required);
  cli.add_option("--set", settings, "Change one value: section.key=value (may be repeated)")
      ->allow_extra_args(false);
  cli.add_flag("--print-config", print_config, "Write the effective configuration and stop");
}

void App::addInputOption(CLI::App& cli, bool required) {
  cli.add_option("-i,--input", inputs, "Input file(s)")->required(required);
}

void App::addOutputOption(CLI::App& cli, bool required) {
  cli.add_option("-o,--output", output, "Output")->required(required);
}

void App::addRunOptions(CLI::App& cli) {
  constexpr int kMostThreads = 4096;
  cli.add_option("--threads", threads, "Threads; 0 = as many as the machine has")
      ->check(CLI::Range(0, kMostThreads));
  cli.add_flag("--strict", strict, "Damaged input is an error instead of a warning");
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
  CLI::App cli(app.description(), app.name());
  cli.set_version_flag("--version", fmt::format("{} {}", app.name(), PERCEPTION_VERSION));
  cli.add_flag("-v,--verbose", app.verbosity, "Say more; may be repeated");
  try {
    app.declare(cli);
  } catch (const CLI::Error& error) {  // an option declared twice: a fault of ours
    printError(app, fmt::format("internal: {}", error.what()));
    return static_cast<int>(ExitCode::kInternal);
  }
  const int ended = parse(app, cli, argc, argv);
  if (ended >= 0) return ended;
  const StopSignals listening;
  const MemoryLimit limit;  // logs are not believed: a forged size must not take the machine
  return static_cast<int>(runGuarded(app));
}

bool stopAsked() { return signal_seen != 0; }

void stopIfAsked() {
  if (!stopAsked()) return;
  throw Error(ExitCode::kTryAgain,
              fmt::format("stopped by {}", signal_seen == SIGINT ? "SIGINT" : "SIGTERM"));
}

Progress::Progress(std::string what, std::uint64_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) == 1),
      started_(now()),
      drawn_(started_) {}

Progress::~Progress() {
  if (terminal_ && std::exchange(bar_shown, false)) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(std::uint64_t done, std::uint64_t items) {
  constexpr double kRedraw = 0.1;  // [s]
  if (!terminal_ || now() - drawn_ < kRedraw) return;
  drawn_ = now();
  const double elapsed = drawn_ - started_;
  std::string line = what_ + " ";
  if (total_ > 0) {
    constexpr std::size_t kWidth = 30;
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const auto filled = static_cast<std::size_t>(share * kWidth);
    line += fmt::format("[{}{}] {:3.0f} %", std::string(filled, '='),
                        std::string(kWidth - filled, ' '), 100 * share);
    if (share > 0) line += fmt::format(", {} left", clockText(elapsed * (1 - share) / share));
  }
  line += fmt::format(", {} ({:.1f}/s)", items, static_cast<double>(items) / elapsed);
  fmt::print(stderr, "\r{}\x1b[K", line);
  std::fflush(stderr);
  bar_shown = true;
}

}  // namespace perception
