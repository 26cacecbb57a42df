#include "libperception/scene/RunTiming.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "libperception/scene/OutputFile.h"

namespace perception {
namespace {

double processCpuSeconds() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double milli(double seconds) { return std::round(seconds * 1e3) / 1e3; }
double micro(double seconds) { return std::round(seconds * 1e6) / 1e6; }

}  // namespace

RunTiming::RunTiming()
    : start_(std::chrono::steady_clock::now()), cpu_start_(processCpuSeconds()) {}

void RunTiming::add(const std::string& name, double seconds) {
  const std::lock_guard<std::mutex> lock(mutex_);
  auto stage =
      std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == name; });
  if (stage == stages_.end()) stage = stages_.insert(stages_.end(), Stage{name});
  ++stage->calls;
  stage->seconds += seconds;
  stage->longest = std::max(stage->longest, seconds);
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
