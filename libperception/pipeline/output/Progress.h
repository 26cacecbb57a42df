#pragma once
#include <cstdint>
#include <string>

namespace perception {

/// Handles SIGINT and SIGTERM during its lifetime: the first signal requests the end of the run at
/// the next frame, another one after it (the same one only after a second) has the default action.
/// A file that gets too large and a pipe without a reader are failed writes.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
};

/// True once SIGINT or SIGTERM has arrived; long loops call stopIfAsked() between frames.
bool stopAsked();
/// Throws Error(kTryAgain) when stopAsked().
void stopIfAsked();

/// Erases the progress bar from the terminal, before a message.
void clearProgressBar();

/// A progress bar with rate and remaining time; no output unless standard error is a terminal.
class Progress {
 public:
  /// `total` in the unit of update() (bytes, frames); 0 = unknown.
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  void update(std::uint64_t done, std::uint64_t items);  ///< items: for the rate (frames)

 private:
  std::string what_;
  std::uint64_t total_;
  bool terminal_;
  double started_ = 0, drawn_ = 0;
};

}  // namespace perception
