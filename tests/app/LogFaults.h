#pragma once
#include <gtest/gtest.h>
#include <mrpt/obs/CObservation.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libperception/app/track/TrackApp.h"
#include "libperception/core/Csv.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "tests/app/DemoLog.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

using Observation = std::shared_ptr<mrpt::obs::CObservation>;

inline const std::string kDemoIni = PERCEPTION_SOURCE_DIR "/ini/demo.ini";

/// The first `seconds` of the simulated demo log.
inline std::vector<Observation> demoStart(double seconds) {
  RawlogReader reader(kDemoLog);
  std::vector<Observation> out;
  while (auto o = reader.next()) {
    if (!out.empty() && *toStamp(o->timestamp) - *toStamp(out.front()->timestamp) > seconds) break;
    out.push_back(std::move(o));
  }
  return out;
}

/// [s] since the first one.
inline double timeIn(const std::vector<Observation>& log, const Observation& o) {
  return *toStamp(o->timestamp) - *toStamp(log.front()->timestamp);
}

inline void writeLog(const std::vector<Observation>& log, const std::string& path) {
  RawlogWriter writer(path);
  for (const auto& o : log) writer.write(*o);
  writer.close();
}

inline std::string contentOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// How a program ended and what it said.
struct Ended {
  int code = 0;
  std::string err;
};

inline Ended runProgram(App& app, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), app.name());
  std::vector<const char*> argv;
  for (const auto& a : arguments) argv.push_back(a.c_str());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Ended ended;
  ended.code = runApp(app, static_cast<int>(argv.size()), argv.data());
  std::fflush(stdout);
  testing::internal::GetCapturedStdout();
  ended.err = testing::internal::GetCapturedStderr();
  return ended;
}

/// perception-track with ini/demo.ini into a folder of its own.
struct Tracking {
  TemporaryFolder folder;
  std::string dir = folder / "run";
  Ended ended;

  Ended track(const std::string& log, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"-c", kDemoIni, "-i", log, "-o", dir});
    TrackApp app;
    return ended = runProgram(app, options);
  }
  Ended track(const std::vector<Observation>& log, std::vector<std::string> options = {}) {
    writeLog(log, folder / "log.rawlog");
    return track(folder / "log.rawlog", std::move(options));
  }
  std::size_t scenes() const { return CsvTable::fromFile(dir + "/scenes.csv").rows(); }
  nlohmann::json done() const { return nlohmann::json::parse(contentOf(dir + "/done.json")); }
  std::size_t events(const std::string& kind) const {
    const auto all = done().at("events");
    return all.contains(kind) ? all.at(kind).get<std::size_t>() : 0;
  }
};

}  // namespace perception::test
