#include "libperception/pipeline/output/Progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

volatile std::sig_atomic_t signal_seen = 0;  // number of the first SIGINT or SIGTERM
timespec signal_at{};                        // its time
bool bar_shown = false;  // a progress bar stands in the last line of the terminal
struct sigaction before_int = {}, before_term = {};
using Handler = void (*)(int);
Handler before_file_size = SIG_DFL, before_pipe = SIG_DFL;

// One stop may come as several signals: of the terminal or of `timeout` to all processes of the
// group, and of the supervisor.
extern "C" void onStopSignal(int number) {
  constexpr time_t kAgain = 1;  // [s]
  timespec at{};
  ::clock_gettime(CLOCK_MONOTONIC, &at);
  if (signal_seen == 0) {
    signal_seen = number;
    signal_at = at;
  } else if (signal_seen != number || at.tv_sec > signal_at.tv_sec + kAgain) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
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

StopSignals::StopSignals() {
  signal_seen = 0;
  struct sigaction action = {};
  action.sa_handler = &onStopSignal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before_int);
  sigaction(SIGTERM, &action, &before_term);
  // These are errors of the write that causes them.
  before_file_size = std::signal(SIGXFSZ, SIG_IGN);
  before_pipe = std::signal(SIGPIPE, SIG_IGN);
  sigset_t held;
  sigemptyset(&held);
  sigaddset(&held, SIGINT);
  sigaddset(&held, SIGTERM);
  ::pthread_sigmask(SIG_UNBLOCK, &held, nullptr);
}

StopSignals::~StopSignals() {
  sigaction(SIGINT, &before_int, nullptr);
  sigaction(SIGTERM, &before_term, nullptr);
  std::signal(SIGXFSZ, before_file_size);
  std::signal(SIGPIPE, before_pipe);
}

void clearProgressBar() {
  if (std::exchange(bar_shown, false)) std::fputs("\r\x1b[K", stderr);
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
  if (terminal_) clearProgressBar();
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
  std::fputs(("\r" + line + "\x1b[K").c_str(), stderr);
  std::fflush(stderr);
  bar_shown = true;
}

}  // namespace perception
