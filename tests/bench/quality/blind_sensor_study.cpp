// After how long does a run name a sensor that goes blind or is fouled? Each sensor of a log in
// turn, from several instants on:
//   blind_sensor_study LOG INI KEY=VALUE,... FROM... [FAULT...]    FROM [s] after the first stamp;
//   "-": no keys; without FAULT ("blind", "frozen", "misaligned", "a third left", "dirt") all
// Blind: nothing comes of it. Frozen: it repeats the last observation that held something.
// Misaligned: a radar or camera with bearings turned by 5 deg. Fouled: of a camera or radar a third
// of what it reports is left, by chance; of a lidar a third of its returns is left, or a fifth of
// its window's patches of 2 deg ("dirt"). A line each: sensor, fault, instant, targets or boxes
// that it would have had in the next two seconds, [s] until it was named, limit of information, its
// events and those of others. The limit is the log probability that a healthy sensor which reports
// something in as many scans as this one would have, scans independent, is silent for two seconds:
// a test that knows this rate cannot be surer that the sensor is blind.
#include <algorithm>
#include <cmath>
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
constexpr double kTurned = radians(5);

enum class Fault { kBlind, kFrozen, kMisaligned, kThird, kDirt };
const char* nameOf(Fault f) {
  switch (f) {
    case Fault::kBlind:
      return "blind";
    case Fault::kFrozen:
      return "frozen";
    case Fault::kMisaligned:
      return "misaligned";
    case Fault::kThird:
      return "a third left";
    default:
      return "dirt";
  }
}

/// Targets, boxes or returns of an observation.
std::size_t sizeOf(const mrpt::obs::CObservation& observation) {
  if (const auto* radar = dynamic_cast<const CObservationRadarScan*>(&observation))
    return radar->scan.returns.size();
  if (const auto* boxes = dynamic_cast<const CObservationObjectDetections*>(&observation))
    return boxes->detections.objects.size();
  const auto* lidar = dynamic_cast<const CObservationLidarScan*>(&observation);
  return lidar != nullptr ? lidar->cloud.size() : 0;
}

/// What an observation holds becomes that of another.
void repeat(const mrpt::obs::CObservation& last, mrpt::obs::CObservation& observation) {
  if (auto* radar = dynamic_cast<CObservationRadarScan*>(&observation))
    radar->scan = dynamic_cast<const CObservationRadarScan&>(last).scan;
  if (auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation))
    boxes->detections = dynamic_cast<const CObservationObjectDetections&>(last).detections;
  if (auto* lidar = dynamic_cast<CObservationLidarScan*>(&observation))
    lidar->cloud = dynamic_cast<const CObservationLidarScan&>(last).cloud;
}

/// All bearings to the left.
void turn(mrpt::obs::CObservation& observation) {
  if (auto* radar = dynamic_cast<CObservationRadarScan*>(&observation)) {
    for (RadarReturn& r : radar->scan.returns) r.bearing += kTurned;
  } else if (auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation)) {
    const double pixels = boxes->detections.camera.fx * kTurned;
    for (ObjectDetection& o : boxes->detections.objects)
      if (o.image_box) o.image_box->x1 -= pixels, o.image_box->x2 -= pixels;
  }
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

/// The fault's work on an observation; `last`: the last one that held something.
void spoil(mrpt::obs::CObservation& observation, Fault fault, std::uint64_t frame,
           const mrpt::obs::CObservation* last) {
  if (fault == Fault::kMisaligned) return turn(observation);
  if (fault == Fault::kFrozen) {
    if (last != nullptr) repeat(*last, observation);
    return;
  }
  const auto keptOf = [&](std::size_t size) {
    return fault == Fault::kBlind ? std::vector<char>(size, 0) : third(size, frame);
  };
  if (auto* radar = dynamic_cast<CObservationRadarScan*>(&observation)) {
    return keep(radar->scan.returns, keptOf(radar->scan.returns.size()));
  }
  if (auto* boxes = dynamic_cast<CObservationObjectDetections*>(&observation)) {
    return keep(boxes->detections.objects, keptOf(boxes->detections.objects.size()));
  }
  auto* lidar = dynamic_cast<CObservationLidarScan*>(&observation);
  if (lidar == nullptr) return;
  LidarCloud& c = lidar->cloud;
  const std::size_t had = c.size();
  const auto kept = fault == Fault::kDirt ? outsideDirt(c) : keptOf(had);
  keep(c.x, kept), keep(c.y, kept), keep(c.z, kept), keep(c.intensity, kept), keep(c.ring, kept);
  keep(c.time_offset, kept), keep(c.echo, kept), keep(c.pulse_width, kept), keep(c.label, kept);
  keep(c.trust, kept);
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
  double scans = 0, filled = 0;
  mrpt::obs::CObservation::ConstPtr last;
  const auto since = [&] { return pipeline.lastStamp() - *pipeline.firstStamp() - from; };
  while (const auto observation = reader.next()) {
    if (pipeline.firstStamp() && since() > kWatched) break;
    const auto stamp = toStamp(observation->timestamp);
    const double t = stamp && pipeline.firstStamp() ? *stamp - *pipeline.firstStamp() - from : -1;
    if (observation->sensorLabel == label) {
      const std::size_t had = sizeOf(*observation);
      if (t >= 0 && t < 2) lost += had, ++scans, filled += had > 0;
      if (t < 0 && had > 0) last = observation;
      if (t >= 0) spoil(*observation, fault, ++frame, last.get());
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
  const double limit = scans * std::log(std::max(1e-3, 1 - filled / std::max(1.0, scans)));
  std::printf("%s, %s, %.1f, %zu, %.2f, %.1f%s\n", label.c_str(), nameOf(fault), from, lost, named,
              limit, what.c_str());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  registerPerceptionClasses();
  std::vector<std::string> keys;
  std::istringstream list(std::string(argv[3]) == "-" ? "" : argv[3]);
  for (std::string key; std::getline(list, key, ',');) keys.push_back(key);
  const PipelineSetup setup = PipelineSetup::fromFile(argv[2], keys);
  std::vector<double> instants;
  std::set<std::string> faults;
  for (int k = 4; k < argc; ++k) {
    char* end = nullptr;
    const double from = std::strtod(argv[k], &end);
    if (end == argv[k]) {
      faults.insert(argv[k]);
    } else {
      instants.push_back(from);
    }
  }
  for (const auto& [label, lidar] : sensorsOf(argv[1], setup)) {
    for (const Fault fault :
         {Fault::kBlind, Fault::kFrozen, Fault::kMisaligned, Fault::kThird, Fault::kDirt}) {
      if ((fault == Fault::kDirt && !lidar) || (fault == Fault::kMisaligned && lidar)) continue;
      if (!faults.empty() && faults.count(nameOf(fault)) == 0) continue;
      for (const double from : instants) tryOut(argv[1], setup, label, fault, from);
    }
  }
  return 0;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: blind_sensor_study LOG INI KEY=VALUE,...|- FROM... [FAULT...]\n");
    return 64;
  }
  try {
    return perception::run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
