#include "libperception/core/system/ChildProcess.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "libperception/core/Error.h"
#include "libperception/core/system/MemoryLimit.h"

namespace perception {
namespace {

constexpr int kNoProgram = 127;  // as of a shell

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// In the child, between fork and exec: nothing that allocates.
[[noreturn]] void become(char* const* words, const char* folder, int output, std::uint64_t memory,
                         std::uint64_t processor_seconds) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  ::setpgid(0, 0);
  const int input = ::open("/dev/null", O_RDONLY);
  const bool placed = input >= 0 && ::dup2(input, STDIN_FILENO) >= 0 &&
                      ::dup2(output, STDOUT_FILENO) >= 0 && ::dup2(output, STDERR_FILENO) >= 0 &&
                      (folder[0] == '\0' || ::chdir(folder) == 0);
  constexpr rlim_t kToDie = 5;  // [s] for whoever does not mind SIGXCPU
  const rlimit space{memory, memory}, time{processor_seconds, processor_seconds + kToDie};
  const bool limited = (memory == 0 || ::setrlimit(RLIMIT_AS, &space) == 0) &&
                       (processor_seconds == 0 || ::setrlimit(RLIMIT_CPU, &time) == 0);
  if (!placed || !limited) ::_exit(kNoProgram);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execvp(words[0], words);
  ::_exit(kNoProgram);
}

}  // namespace

ChildProcess::ChildProcess(const ChildCommand& command) : limit_(command.seconds), started_(now()) {
  std::vector<char*> words;
  for (const auto& word : command.words) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int output =
      command.output.empty()
          ? ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)
          : ::open(command.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (output < 0) {
    throw OutputError(
        fmt::format("{}: cannot be created: {}", command.output, std::strerror(errno)));
  }
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ == 0) {
    if (::getppid() != parent) ::_exit(kNoProgram);
    become(words.data(), command.folder.c_str(), output,
           MemoryLimit::supported() ? command.memory : 0, command.processor_seconds);
  }
  const int reason = errno;
  ::close(output);
  if (process_ < 0) {
    throw Error(ExitCode::kUnavailable,
                fmt::format("{}: cannot be started: {}", command.words[0], std::strerror(reason)));
  }
  ::setpgid(process_, process_);  // here too: it may be stopped before it comes to that
}

ChildProcess::~ChildProcess() {
  if (ended_) return;
  stop();
  wait();
}

bool ChildProcess::running() {
  if (ended_) return false;
  int status = 0;
  const pid_t ended = ::waitpid(process_, &status, WNOHANG);
  const double at = now();
  if (ended == 0 || (ended < 0 && errno == EINTR)) {
    if (limit_ > 0 && stopped_ == 0 && at - started_ > limit_) {
      out_of_time_ = true;
      stop();
    }
    if (stopped_ > 0 && at - stopped_ > kGrace) ::kill(-process_, SIGKILL);
    return true;
  }
  ended_ = true;
  seconds_ = at - started_;
  if (ended == process_ && WIFEXITED(status)) code_ = WEXITSTATUS(status);
  if (ended == process_ && WIFSIGNALED(status)) signal_ = WTERMSIG(status);
  ::kill(-process_, SIGKILL);  // what it left behind in its group
  return false;
}

void ChildProcess::stop() {
  if (ended_ || stopped_ > 0) return;
  stopped_ = now();
  ::kill(process_, SIGTERM);
}

void ChildProcess::wait() {
  constexpr auto kLook = std::chrono::milliseconds(5);
  while (running()) std::this_thread::sleep_for(kLook);
}

}  // namespace perception
