#include "libperception/evaluation/plots/Gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

namespace perception {
namespace {

// Environment of the child process: working folder, no input, messages to a file.
class FileActions {
 public:
  explicit FileActions(const std::string& dir) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, dir.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "gnuplot.log",
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

// The environment with the C locale: a decimal comma would break script and data.
std::vector<char*> environmentInCLocale(std::string& locale) {
  locale = "LC_ALL=C.UTF-8";
  std::vector<char*> variables = {locale.data()};
  for (char** variable = environ; *variable; ++variable) {
    if (std::string_view(*variable).substr(0, 7) != "LC_ALL=") variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

}  // namespace

std::string runGnuplot(const std::string& dir, const std::string& script) {
  std::string program = "gnuplot", argument = script, locale;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  const std::vector<char*> environment = environmentInCLocale(locale);
  const FileActions actions(dir);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, program.c_str(), actions.get(), nullptr, arguments, environment.data());
  if (failed == ENOENT) return "gnuplot is not installed (Debian package gnuplot-nox): no plots";
  if (failed) return fmt::format("gnuplot cannot be started: {}: no plots", std::strerror(failed));
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return "gnuplot was lost: no plots";
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return fmt::format("gnuplot failed, see {}/gnuplot.log", dir);
}

std::string gnuplotString(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + "'";
}

}  // namespace perception
