// After how long does a run name a sensor that goes blind or is fouled? Each sensor of a log in
// turn, from several instants on:
//   blind_sensor_study LOG INI KEY=VALUE,... FROM...    FROM [s] after the first stamp; "-": no
//   keys
// Blind: nothing comes of it. Fouled: of a camera or radar a third of what it reports is left, by
// chance; of a lidar a third of its returns is left, or a fifth of its window's patches of 2 deg
// ("dirt"). A line each: sensor, fault, instant, targets or boxes that it would have had in the
// next two seconds, [s] until it was named, its events and those of others.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/CObservationRadarScan.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

constexpr double kWatched = 8;  // [s] after the fault
constexpr double kLeft = 1.0 / 3, kDirt = 0.2, kPatch = 2;

enum class Fault { kBlind, kThird, kDirt };
const char* nameOf(Fault f) {
  return f == Fault::kBlind ? "blind" : f == Fault::kThird ? "a third left" : "dirt";
}

template <class T>
void keep(std::vector<T>& values, const std::vector<char>& kept) {
  if (values.empty()) return;
  std::vector<T> left;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (kept[k]) left.push_back(std::move(values[k]));
  values = std::move(left);
}

std::vector<char> third(std::size_t size, std::uint64_t frame) {
  Rng rng({7, frame, 0, 0});
  std::vector<char> kept(size);
  for (char& k : kept) k = rng.uniform() < kLeft;
  return kept;
}

std::vector<char> outsideDirt(const LidarCloud& cloud) {
  std::vector<char> kept(cloud.size());
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto x = static_cast<double>(cloud.x[k]), y = static_cast<double>(cloud.y[k]),
               z = static_cast<double>(cloud.z[k]);
    const double azimuth = degrees(std::atan2(y, x)) + 180,
                 elevation = degrees(std::atan2(z, std::hypot(x, y))) + 90;
    Rng patch({11, static_cast<std::uint64_t>(azimuth / kPatch),
               static_cast<std::uint32_t>(elevation / kPatch), 0});
    kept[k] = patch.uniform() >= kDirt;
  }
  return kept;
}

/// What is left of an observation. Returns what it had.
std::size_t spoil(mrpt::obs::CObservation& observation, Fault fault, std::uint64_t frame) {
  const auto keptOf = [&](std::size_t size) {
    return fault == Fault::kBlind ? std::vector<char>(size, 0) : third(size, frame);
  };
  if (auto* radar = dynamic_cast<CObservationRadarScan*>(&observation)) {
    const std::size_t had = radar->scan.returns.size();
    keep(radar->scan.returns, keptOf(had));
    return had;
  }
  if (auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation)) {
    const std::size_t had = boxes->detections.objects.size();
    keep(boxes->detections.objects, keptOf(had));
    return had;
  }
  auto* lidar = dynamic_cast<CObservationLidarScan*>(&observation);
  if (lidar == nullptr) return 0;
  LidarCloud& c = lidar->cloud;
  const std::size_t had = c.size();
  const auto kept = fault == Fault::kDirt ? outsideDirt(c) : keptOf(had);
  keep(c.x, kept), keep(c.y, kept), keep(c.z, kept), keep(c.intensity, kept), keep(c.ring, kept);
  keep(c.time_offset, kept), keep(c.echo, kept), keep(c.pulse_width, kept), keep(c.label, kept);
  keep(c.trust, kept);
  return had;
}

/// Labels of the log's sensors that the configuration uses, and whether they are lidars.
std::map<std::string, bool> sensorsOf(const std::string& log, const PipelineSetup& setup) {
  std::map<std::string, bool> sensors;
  RawlogReader reader(log);
  std::optional<Stamp> first;
  while (const auto observation = reader.next()) {
    const auto stamp = toStamp(observation->timestamp);
    if (!stamp) continue;
    if (!first) first = stamp;
    if (*stamp - *first > 1) break;
    const auto k = setup.sensorOf(observation->sensorLabel);
    if (!k || !setup.sensors[*k].active) continue;
    sensors[observation->sensorLabel] =
        dynamic_cast<const CObservationLidarScan*>(observation.get()) != nullptr;
  }
  return sensors;
}

void tryOut(const std::string& log, const PipelineSetup& setup, const std::string& label,
            Fault fault, double from) {
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  RawlogReader reader(log);
  std::uint64_t frame = 0;
  std::size_t lost = 0;
  const auto since = [&] { return pipeline.lastStamp() - *pipeline.firstStamp() - from; };
  while (const auto observation = reader.next()) {
    if (pipeline.firstStamp() && since() > kWatched) break;
    const auto stamp = toStamp(observation->timestamp);
    const double t = stamp && pipeline.firstStamp() ? *stamp - *pipeline.firstStamp() - from : -1;
    if (t >= 0 && observation->sensorLabel == label) {
      const std::size_t had = spoil(*observation, fault, ++frame);
      if (t < 2) lost += had;
    }
    pipeline.add(*observation);
    while (pipeline.next()) continue;
    pipeline.takeWeather(), pipeline.takeLedger();
  }
  double named = -1;
  std::string what;
  std::istringstream lines(events.text(*pipeline.firstStamp()));
  for (std::string line; std::getline(lines, line);) {
    const auto event = nlohmann::json::parse(line);
    const std::string kind = event["kind"];
    if (kind != event_kind::kSensorBlind && kind != event_kind::kSensorFouled &&
        kind != event_kind::kSensorMisaligned && kind != event_kind::kSensorBack)
      continue;
    const double t = event["t"].get<double>() - from;
    if (named < 0 && t >= 0 && event["fields"]["sensor"] == label &&
        kind != event_kind::kSensorBack)
      named = t;
    char text[160];
    std::snprintf(text, sizeof(text), "; %.2f %s %s", t, kind.c_str(),
                  event["fields"]["sensor"].get<std::string>().c_str());
    what += text;
  }
  std::printf("%s, %s, %.1f, %zu, %.2f%s\n", label.c_str(), nameOf(fault), from, lost, named,
              what.c_str());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  registerPerceptionClasses();
  std::vector<std::string> keys;
  std::istringstream list(std::string(argv[3]) == "-" ? "" : argv[3]);
  for (std::string key; std::getline(list, key, ',');) keys.push_back(key);
  const PipelineSetup setup = PipelineSetup::fromFile(argv[2], keys);
  for (const auto& [label, lidar] : sensorsOf(argv[1], setup)) {
    for (const Fault fault : {Fault::kBlind, Fault::kThird, Fault::kDirt}) {
      if (fault == Fault::kDirt && !lidar) continue;
      for (int k = 4; k < argc; ++k) tryOut(argv[1], setup, label, fault, std::atof(argv[k]));
    }
  }
  return 0;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: blind_sensor_study LOG INI KEY=VALUE,...|- FROM...\n");
    return 64;
  }
  try {
    return perception::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
