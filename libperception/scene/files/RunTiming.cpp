#include "libperception/scene/files/RunTiming.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <nlohmann/json.hpp>

#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

double processCpuSeconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Bins of latencies.
constexpr double kLeastLatency = 1e-4, kLatencyStep = 1.02;  // [s]; factor

double milli(double seconds) { return std::round(seconds * 1e3) / 1e3; }
double micro(double seconds) { return std::round(seconds * 1e6) / 1e6; }

}  // namespace

RunTiming::RunTiming()
    : start_(std::chrono::steady_clock::now()), cpu_start_(processCpuSeconds()) {}

void RunTiming::add(const std::string& name, double seconds) {
  const std::lock_guard<std::mutex> lock(mutex_);
  addLocked(name, seconds);
}

void RunTiming::addLocked(const std::string& name, double seconds) {
  auto stage =
      std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == name; });
  if (stage == stages_.end()) stage = stages_.insert(stages_.end(), Stage{name});
  ++stage->calls;
  stage->seconds += seconds;
  stage->longest = std::max(stage->longest, seconds);
}

void RunTiming::begin(const char* name) {
  const std::lock_guard<std::mutex> lock(mutex_);
  active_.emplace_back(name);
  ++changes_;
}

void RunTiming::end(const char* name, double seconds) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto last = std::find(active_.rbegin(), active_.rend(), name);
  if (last != active_.rend()) active_.erase(std::next(last).base());
  ++changes_;
  addLocked(name, seconds);
}

std::string RunTiming::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return active_.empty() ? "" : active_.back();
}

void RunTiming::addLatency(double seconds) {
  const double step =
      std::log(std::max(seconds, kLeastLatency) / kLeastLatency) / std::log(kLatencyStep);
  const auto most = static_cast<double>(latencies_.size() - 1);
  const std::lock_guard<std::mutex> lock(mutex_);
  ++latencies_[static_cast<std::size_t>(std::min(step, most))];
  ++latency_count_;
  longest_latency_ = std::max(longest_latency_, seconds);
}

/// [s] The upper end of the bin, and never more than the longest latency, which also answers for
/// the last bin.
double RunTiming::latencyQuantile(double share) const {
  const double wanted = share * static_cast<double>(latency_count_);
  double below = 0, upper = kLeastLatency;
  for (std::size_t i = 0; i + 1 < latencies_.size(); ++i) {
    upper *= kLatencyStep;
    below += static_cast<double>(latencies_[i]);
    if (below >= wanted) return std::min(upper, longest_latency_);
  }
  return longest_latency_;
}

double RunTiming::cpuSeconds() const { return processCpuSeconds() - cpu_start_; }

std::uint64_t RunTiming::peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in kB
}

std::vector<RunTiming::Stage> RunTiming::stages() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stages_;
}

std::string RunTiming::toJson(double log_seconds, int threads) const {
  const double wall = wallSeconds();
  nlohmann::ordered_json j;
  j["wall_seconds"] = milli(wall);
  j["cpu_seconds"] = milli(cpuSeconds());
  j["log_seconds"] = milli(log_seconds);
  j["real_time_factor"] = wall > 0 ? milli(log_seconds / wall) : 0;
  j["threads"] = threads;
  j["peak_memory_bytes"] = peakMemoryBytes();
  if (latency_count_ > 0) {
    j["latency"] = {{"scenes", latency_count_},
                    {"p50_seconds", micro(latencyQuantile(0.5))},
                    {"p99_seconds", micro(latencyQuantile(0.99))},
                    {"longest_seconds", micro(longest_latency_)}};
  }
  j["stages"] = nlohmann::ordered_json::array();
  for (const Stage& stage : stages()) {
    j["stages"].push_back({{"name", stage.name},
                           {"calls", stage.calls},
                           {"seconds", micro(stage.seconds)},
                           {"longest_call_seconds", micro(stage.longest)}});
  }
  return j.dump(2) + '\n';
}

void RunTiming::write(const std::string& path, double log_seconds, int threads) const {
  writeFile(path, toJson(log_seconds, threads));
}

}  // namespace perception
