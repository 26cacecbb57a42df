#include "libperception/pipeline/ScanMaker.h"

#include <cmath>
#include <utility>

namespace perception {
namespace {

/// [s] for which an occlusion map is used for other sensors; assumed: two scans of a lidar.
constexpr double kOcclusionMapAge = 0.2;
/// P(the air is not clear) that changes no decision (assumed).
constexpr double kNegligible = 0.02;

}  // namespace

ScanMaker::ScanMaker(const PipelineSetup& setup, RunTiming& timing, WeatherWatch& weather,
                     PhantomLedger& ledger)
    : setup_(setup), timing_(timing), weather_(weather), ledger_(ledger) {
  for (const auto& sensor : setup.sensors) {
    Stages stages;
    if (sensor.gives_ground) {
      stages.ground = std::make_unique<GroundEstimator>(setup.ground, setup.run.seed);
      if (sensor.active) stages.weather = makePointFilter(setup.weather);
    }
    if (sensor.active) stages.preparation = sensor.front_end->preparation();
    stages_.push_back(std::move(stages));
  }
}

void ScanMaker::addGround(std::size_t sensor, SensorFrame& frame) {
  const auto& estimator = stages_[sensor].ground;
  if (estimator && std::holds_alternative<LidarCloud>(frame.data)) {
    const auto scope = timing_.stage("ground");
    ground_ = estimator->update(frame);
  }
  frame.ground = ground_;
}

std::optional<TrustStats> ScanMaker::weighReturns(std::size_t sensor, SensorFrame& frame) {
  const auto& filter = stages_[sensor].weather;
  if (!filter || !std::holds_alternative<LidarCloud>(frame.data)) return std::nullopt;
  TrustStats trust;
  {
    const auto scope = timing_.stage("weather");
    trust = filter->apply(frame);
  }
  const auto scope = timing_.stage("weather_state");
  weather_.add(frame.sensor, frame.stamp, filter->census(frame), trust);
  return trust;
}

void ScanMaker::addToLedger(std::size_t sensor, const SensorFrame& frame, const TrustStats& trust,
                            const MeasurementScan& scan) {
  const auto scope = timing_.stage("ledger");
  LedgerRow row{frame.stamp, frame.sensor, trust, std::nullopt};
  if (scan.verdicts) {
    row.clusters = ClusterLedger::of(
        *scan.verdicts, [&](std::uint32_t i) { return stages_[sensor].weather->doubtAbout(i); });
  }
  ledger_.add(std::move(row));
}

MeasurementScan ScanMaker::measure(std::size_t sensor, SensorFrame& frame) {
  const auto trust = weighReturns(sensor, frame);
  const double not_clear = trust ? weather_.notClear(frame.sensor) : 0;
  frame.causes.weather = not_clear > kNegligible ? not_clear : 0;
  if (trust) frame.causes.clouds = weather_.clouds(frame.sensor, frame.T_world_sensor());
  MeasurementScan scan;
  {
    const auto scope = timing_.stage(setup_.sensors[sensor].params.kind.c_str());
    if (const auto& preparation = stages_[sensor].preparation) preparation->apply(frame);
    frame.before = stages_[sensor].before;
    scan = setup_.sensors[sensor].front_end->extract(frame);
  }
  if (scan.returns) {
    stages_[sensor].before = std::make_shared<const EarlierScan>(
        EarlierScan{frame.stamp, frame.ego.T_world_ego, scan.returns});
  }
  if (trust) addToLedger(sensor, frame, *trust, scan);
  if (scan.occlusion) {
    occlusion_ = scan.occlusion;
    occlusion_stamp_ = frame.stamp;
  } else if (occlusion_ && std::abs(frame.stamp - occlusion_stamp_) <= kOcclusionMapAge) {
    scan.occlusion = occlusion_;
  }
  return scan;
}

void ScanMaker::restart() {
  occlusion_.reset();
  for (Stages& stages : stages_) {
    if (stages.preparation) stages.preparation->restart();
    stages.before.reset();
  }
}

std::vector<std::string> ScanMaker::learned() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    if (!stages_[i].preparation) continue;
    const auto learned = stages_[i].preparation->learned();
    if (learned.empty()) continue;
    lines.push_back("[sensor." + setup_.sensors[i].label + ".positions]");
    lines.insert(lines.end(), learned.begin(), learned.end());
  }
  return lines;
}

}  // namespace perception
