#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace perception {

/// Run times by stage: timing.json. Not part of the reproducible results.
class RunTiming {
 public:
  /// Time of one stage of the pipeline, summed over calls and threads.
  struct Stage {
    std::string name;
    std::uint64_t calls = 0;
    double seconds = 0;  ///< [s] wall
    double longest = 0;  ///< [s] of one call
  };
  /// Measures its own lifetime.
  class Scope {
   public:
    Scope(RunTiming& timing, const char* name) : timing_(timing), name_(name) {
      timing_.begin(name);
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { timing_.end(name_, secondsSince(start_)); }

   private:
    RunTiming& timing_;
    const char* name_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  /// Starts the clocks of the run.
  RunTiming();
  /// `const auto scope = timing.stage("lidar");` Any thread.
  Scope stage(const char* name) { return Scope(*this, name); }
  void add(const std::string& name, double seconds);

  /// From the arrival of a scene's observation to the scene, of sensors at work [s].
  void addLatency(double seconds);
  /// The stage that began last of those that have not ended; "" between stages. Any thread.
  std::string current() const;
  std::uint64_t changes() const { return changes_; }  ///< stages begun and ended so far. Any thread

  double wallSeconds() const { return secondsSince(start_); }
  double cpuSeconds() const;               ///< [s] of all threads, since the construction
  static std::uint64_t peakMemoryBytes();  ///< largest resident size of the process so far
  std::vector<Stage> stages() const;       ///< in order of first use

  /// The text of timing.json; `log_seconds` [s] of log were processed with `threads`.
  std::string toJson(double log_seconds, int threads) const;
  /// Throws OutputError.
  void write(const std::string& path, double log_seconds, int threads) const;

 private:
  void begin(const char* name);
  void end(const char* name, double seconds);
  void addLocked(const std::string& name, double seconds);  ///< mutex_ is held
  double latencyQuantile(double share) const;
  static double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  std::chrono::steady_clock::time_point start_;
  double cpu_start_;
  mutable std::mutex mutex_;
  std::vector<Stage> stages_;
  std::vector<std::string> active_;  ///< stages that have begun and not ended, in that order
  std::atomic<std::uint64_t> changes_{0};
  std::array<std::uint64_t, 700> latencies_{};  ///< number by latency, 2 % a step from 0.1 ms to
                                                ///< 100 s; the last holds what is longer
  std::uint64_t latency_count_ = 0;
  double longest_latency_ = 0;  ///< [s]
};

}  // namespace perception
