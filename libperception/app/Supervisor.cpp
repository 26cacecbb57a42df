#include "libperception/app/Supervisor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "libperception/app/App.h"
#include "libperception/core/Error.h"
#include "libperception/core/system/Supervision.h"

namespace perception {
namespace {

sigset_t supervisedSignals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGTERM, SIGINT, SIGCHLD}) sigaddset(&set, number);
  return set;
}

/// An exception of the supervising process, or before it is one: its memory is at an end.
[[noreturn]] void endSupervisor() {
  constexpr char kText[] = "perception: error: internal: the program cannot be watched\n";
  [[maybe_unused]] const auto heard = ::write(STDERR_FILENO, kText, sizeof kText - 1);
  std::_Exit(static_cast<int>(ExitCode::kInternal));
}

std::terminate_handler of_libraries = nullptr;

/// Before any library of the process is initialized: signals stay pending until they are handled.
void holdSignals(int, char** argv, char**) {
  const char* name = argv != nullptr && argv[0] != nullptr ? std::strrchr(argv[0], '/') : nullptr;
  name = name != nullptr ? name + 1 : (argv != nullptr ? argv[0] : nullptr);
  if (name == nullptr || std::strncmp(name, "perception-", 11) != 0) return;  // a test
  sigset_t stops = supervisedSignals();
  sigdelset(&stops, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &stops, nullptr);
  of_libraries = std::set_terminate(&endSupervisor);
}
__attribute__((section(".preinit_array"), used)) void (*hold_signals)(int, char**,
                                                                      char**) = &holdSignals;

/// Without these a file that the program opens would get their numbers, and messages.
void openStandardFiles() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // Standard output that cannot be written remains an error.
    if (::fcntl(file, F_GETFD) == -1 && errno == EBADF)
      ::open("/dev/null", file == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
}

double seconds(clockid_t clock) {
  timespec t{};
  return ::clock_gettime(clock, &t) == 0
             ? static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec)
             : 0;
}

/// The child and what is known of it.
class Child {
 public:
  Child(pid_t process, SupervisionRecord& record, std::string name, SupervisorLimits limits)
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
    if (stop_ == 0) stopped_at_ = seconds(CLOCK_MONOTONIC);
    stop_ = number;
  }

  void watch() {
    const std::uint64_t reading = record_.reading;
    const double used = seconds(clock_);
    if (reading % 2 == 0 || reading != last_reading_) {
      last_reading_ = reading;
      reading_since_ = used;
    } else if (used - reading_since_ > limits_.reading) {
      hangs_ = true;
    }
    const bool ignores = stop_ != 0 && seconds(CLOCK_MONOTONIC) - stopped_at_ > limits_.stop;
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

int runSupervised(App& app, int argc, const char* const* argv, SupervisorLimits limits) {
  openStandardFiles();
  void* const memory = ::mmap(nullptr, sizeof(SupervisionRecord), PROT_READ | PROT_WRITE,
                              MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return runApp(app, argc, argv);
  auto* const record = new (memory) SupervisionRecord;
  const sigset_t set = supervisedSignals();
  sigset_t before;
  ::sigprocmask(SIG_BLOCK, &set, &before);
  const pid_t parent = ::getpid(), process = ::fork();
  if (process <= 0) ::sigprocmask(SIG_SETMASK, &before, nullptr);
  if (process < 0) return runApp(app, argc, argv);  // no second process: unwatched
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) return static_cast<int>(ExitCode::kTryAgain);
    SupervisionRecord::set(record);
    if (of_libraries != nullptr) std::set_terminate(of_libraries);  // the supervisor tells of it
    return runApp(app, argc, argv);
  }
  return Child(process, *record, app.name(), limits).wait();
}

}  // namespace perception
