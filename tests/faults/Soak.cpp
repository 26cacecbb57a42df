// A log that does not end: perception_soak LOG INI HOURS [section.key=value ...] repeats a log with
// its stamps moved on until it is HOURS long, tracks it at full speed and prints the memory of the
// process by time of the log. Ends with 1 if it grows by more than 2 MB after the first ten
// minutes.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/pipeline/LogRun.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception {
namespace {

constexpr double kWarm = 600;      // [s] of log: buffers have their size
constexpr double kShown = 600;     // [s] of log between two lines
constexpr double kGap = 0.1;       // [s] between the end of the log and its next beginning
constexpr double kMostGrowth = 2;  // [MB]
constexpr double kMegabyte = 1e6;

/// [MB] resident.
double memory() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / kMegabyte;
}

void repeatLog(const std::string& log, double seconds, const std::string& path) {
  RawlogReader reader(log);
  std::vector<std::shared_ptr<mrpt::obs::CObservation>> entries;
  std::optional<Stamp> first, last;
  while (auto entry = reader.next()) {
    if (const auto stamp = toStamp(entry->timestamp)) {
      if (!first) first = stamp;
      last = last ? std::max(*last, *stamp) : *stamp;
      entries.push_back(std::move(entry));
    }
  }
  if (!first) throw DataError(log + ": nothing with a stamp");
  const double length = *last - *first + kGap;
  const auto ticks =
      std::chrono::duration_cast<mrpt::Clock::duration>(std::chrono::duration<double>(length));
  RawlogWriter writer(path);
  for (double t = 0; t < seconds; t += length) {
    for (const auto& entry : entries) {
      writer.write(*entry);
      entry->timestamp += ticks;
    }
  }
  writer.close();
}

/// [MB] that the memory grew by after the first ten minutes.
double trackLong(const std::string& log, const std::string& ini,
                 const std::vector<std::string>& settings, const std::string& dir) {
  Config config = Config::fromFile(ini);
  for (const auto& setting : settings) config.set(setting);
  const PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  LogRun run(setup, {log, dir, ""}, std::make_unique<RawlogReader>(log));
  std::optional<Stamp> first;
  double shown = 0, warm = 0, most = 0;
  std::uint64_t objects = 0;
  run.read([&](const Scene& scene) {
    if (!first) first = scene.stamp;
    for (const auto& object : scene.objects) objects = std::max(objects, object.id);
    const double t = scene.stamp - *first;
    if (t < shown) return;
    const double now = memory();
    std::printf("%7.0f s %8.2f MB %8llu ids\n", shown, now,
                static_cast<unsigned long long>(objects));
    std::fflush(stdout);
    if (t >= kWarm && warm == 0) warm = now;
    if (warm > 0) most = std::max(most, now);
    shown += kShown;
  });
  run.finish(false);
  if (warm == 0)
    throw DataError(fmt::format("the log ended before {} s: nothing to compare with", kWarm));
  return most - warm;
}

int soak(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: perception_soak LOG INI HOURS [section.key=value ...]\n");
    return static_cast<int>(ExitCode::kUsage);
  }
  registerPerceptionClasses();
  const double hours = std::atof(argv[3]);
  std::string dir = (std::filesystem::temp_directory_path() / "perception_soak_XXXXXX").string();
  if (::mkdtemp(dir.data()) == nullptr) return static_cast<int>(ExitCode::kCannotCreate);
  int code = static_cast<int>(ExitCode::kOk);
  try {
    repeatLog(argv[1], hours * 3600, dir + "/long.rawlog");
    const double growth =
        trackLong(dir + "/long.rawlog", argv[2], {argv + 4, argv + argc}, dir + "/run");
    std::printf("%g h of log: %.2f MB more than after %g s\n", hours, growth, kWarm);
    if (growth > kMostGrowth) code = 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "perception_soak: error: %s\n", error.what());
    code = static_cast<int>(ExitCode::kInternal);
  }
  std::filesystem::remove_all(dir);
  return code;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) { return perception::soak(argc, argv); }
