#pragma once
#include <cstdint>
#include <string>

namespace perception {

/// Listens to SIGINT and SIGTERM while it lives: the first one asks the run to end at the next
/// frame, the second one kills as without this.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
};

/// True once SIGINT or SIGTERM has arrived; long loops look at it between frames and call
/// stopIfAsked().
bool stopAsked();
/// Throws Error(kTryAgain) when stopAsked().
void stopIfAsked();

/// Wipes the progress bar off the last line of the terminal, where there is one: before a message.
void clearProgressBar();

/// A progress bar with rate and time left on a terminal; silent elsewhere.
class Progress {
 public:
  /// `total` in the unit of update() (bytes, frames); 0 = unknown.
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  void update(std::uint64_t done, std::uint64_t items);  ///< items: counted for the rate (frames)

 private:
  std::string what_;
  std::uint64_t total_;
  bool terminal_;
  double started_ = 0, drawn_ = 0;
};

}  // namespace perception
