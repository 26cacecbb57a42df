#include "libperception/python/Programs.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>

#include "libperception/app/App.h"
#include "libperception/app/Programs.h"
#include "libperception/core/Error.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/python/extensions/Callback.h"

namespace perception::python {
namespace {

std::unique_ptr<App> programOf(const std::string& name) {
  static const std::map<std::string, std::unique_ptr<App> (*)()> programs = {
      {"track", &trackApp}, {"evaluate", &evaluateApp}, {"simulate", &simulateApp}};
  const auto program = programs.find(name);
  if (program == programs.end())
    throw Error(ExitCode::kUsage, "perception-" + name + " does not run within Python");
  return program->second();
}

}  // namespace

int runProgram(const std::string& name, std::vector<std::string> arguments) {
  // Handlers of signals are of the process. Its memory is not limited, as the programs limit
  // theirs: it belongs to whatever else runs in it.
  CallbackScope::refuse();
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const std::shared_lock reading(variantsMutex());
  const auto app = programOf(name);
  CLI::App cli(app->description(), app->name());
  app->declare(cli);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    cli.parse(arguments);
  } catch (const CLI::Success&) {
    throw Error(ExitCode::kUsage, app->name() + ": an option that ends it before it has run");
  } catch (const CLI::ParseError& error) {
    throw Error(ExitCode::kUsage, app->name() + ": " + error.what());
  }
  const StopSignals listening;
  app->run();
  std::fflush(stdout);
  return app->warnings();
}

}  // namespace perception::python
