#include "libperception/core/system/SupervisedChild.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

double secondsOf(clockid_t clock) {
  timespec t{};
  return ::clock_gettime(clock, &t) == 0
             ? static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec)
             : 0;
}

/// The child and what is known of it.
class SupervisedChild {
 public:
  SupervisedChild(pid_t process, SupervisionRecord& record, std::string name,
                  SupervisorLimits limits)
      : process_(process), record_(record), name_(std::move(name)), limits_(limits) {
    ::clock_getcpuclockid(process, &clock_);
  }

  /// Waits for its end; the exit code of the program.
  int wait() {
    int status = 0;
    while (!hasEnded(status)) {
      const timespec poll{0, 200'000'000};
      const sigset_t set = supervisedSignals();
      const int number = ::sigtimedwait(&set, nullptr, &poll);
      if (number == SIGTERM || number == SIGINT) passOn(number);
      watch();
    }
    removeTemporaries();
    if (WIFEXITED(status) && isExitCode(WEXITSTATUS(status))) return WEXITSTATUS(status);
    return tellOf(status);
  }

 private:
  bool hasEnded(int& status) const {
    const pid_t ended = ::waitpid(process_, &status, WNOHANG);
    return ended == process_ || (ended < 0 && errno != EINTR);
  }

  void passOn(int number) {
    ::kill(process_, number);
    if (stop_ == 0) stopped_at_ = secondsOf(CLOCK_MONOTONIC);
    stop_ = number;
  }

  void watch() {
    const std::uint64_t reading = record_.reading;
    const double used = secondsOf(clock_);
    if (reading % 2 == 0 || reading != last_reading_) {
      last_reading_ = reading;
      reading_since_ = used;
    } else if (used - reading_since_ > limits_.reading) {
      hangs_ = true;
    }
    const bool ignores = stop_ != 0 && secondsOf(CLOCK_MONOTONIC) - stopped_at_ > limits_.stop;
    if (hangs_ || ignores) ::kill(process_, SIGKILL);
  }

  void removeTemporaries() const {
    for (const auto& path : record_.temporaries) {
      std::error_code ignored;
      if (path[0] != '\0') std::filesystem::remove_all(path.data(), ignored);
    }
  }

  int tellOf(int status) const {
    const auto say = [&](const std::string& text, ExitCode code) {
      std::fputs(fmt::format("{}: error: {}\n", name_, text).c_str(), stderr);
      return static_cast<int>(code);
    };
    const char* signal = stop_ == SIGINT ? "SIGINT" : "SIGTERM";
    if (stop_ != 0) return say(fmt::format("stopped by {}", signal), ExitCode::kTryAgain);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL && !hangs_) {
      return say("killed from outside (SIGKILL): is the machine out of memory?",
                 ExitCode::kTryAgain);
    }
    std::string how = WIFSIGNALED(status)
                          ? fmt::format("ended the program ({})", ::strsignal(WTERMSIG(status)))
                          : fmt::format("ended the program with code {}", WEXITSTATUS(status));
    if (hangs_) how = fmt::format("does not end ({:g} s of processor time)", limits_.reading);
    if (record_.reading % 2 == 0) return say("internal: something " + how, ExitCode::kInternal);
    return say(fmt::format("{}: damaged: reading what begins at byte {} {}",
                           record_.read_from.data(), record_.position.load(), how),
               ExitCode::kBadInput);
  }

  pid_t process_;
  SupervisionRecord& record_;
  std::string name_;
  SupervisorLimits limits_;
  clockid_t clock_{};
  int stop_ = 0;
  double stopped_at_ = 0, reading_since_ = 0;  // [s]
  std::uint64_t last_reading_ = 0;
  bool hangs_ = false;
};

}  // namespace

sigset_t supervisedSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGTERM, SIGINT, SIGCHLD}) sigaddset(&set, number);
  return set;
}

int superviseChild(pid_t process, SupervisionRecord& record, const std::string& program,
                   SupervisorLimits limits) {
  return SupervisedChild(process, record, program, limits).wait();
}

}  // namespace perception
