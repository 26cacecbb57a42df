#include "libperception/app/Supervisor.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "libperception/app/App.h"
#include "libperception/core/Error.h"
#include "libperception/core/system/SupervisedChild.h"
#include "libperception/core/system/Supervision.h"

namespace perception {
namespace {

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
  return superviseChild(process, *record, app.name(), limits);
}

}  // namespace perception
