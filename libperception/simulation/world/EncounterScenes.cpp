#include "libperception/simulation/world/EncounterScenes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace perception {
namespace {

constexpr double kStep = 0.1;  // [s]

/// A drive along one axis.
std::vector<Vector2> drive(const Vector2& from, const Vector2& direction, double speed,
                           double duration) {
  std::vector<Vector2> path;
  double s = 0;
  for (int i = 0; i <= static_cast<int>(duration / kStep + 0.5); ++i) {
    s += speed * kStep;
    path.push_back(from + s * direction);
  }
  return path;
}

PositionModel::Params sensorParams(const EncounterConditions& conditions, double clutter,
                                   double births, const std::array<double, 2>& detection,
                                   const std::array<Matrix2, 2>& noise,
                                   const std::array<std::vector<double>, 2>& labels) {
  PositionModel::Params p;
  for (std::size_t c = 0; c < 2; ++c) {
    PositionModel::ClassRow row;
    row.detection = detection[c] * conditions.detection_factor;
    row.labels = labels[c];
    row.noise = conditions.noise_factor * noise[c];
    p.classes.push_back(std::move(row));
  }
  p.clutter_labels = {0.5, 0.5};
  p.clutter_per_scan = clutter * conditions.clutter_factor;
  p.births_per_scan = births;
  p.range = 20;
  p.fov = kPi;
  return p;
}

int drawLabel(const std::vector<double>& probabilities, Rng& rng) {
  return rng.uniform() < probabilities[0] ? 0 : 1;
}

Measurement measurementAt(const Vector2& z, int label) {
  Measurement m;
  m.z = z;
  m.R = Matrix2::Zero();  // the classes' own noise is the model's
  m.seen = 3;
  m.label = label;
  m.position = z;
  m.position_sigma = 0.5;
  return m;
}

MeasurementScan oneScan(const EncounterScene& scene, std::size_t instant,
                        const std::shared_ptr<const PositionModel>& model, Modality modality,
                        const EncounterConditions& conditions, Rng& rng) {
  MeasurementScan scan;
  scan.modality = modality;
  scan.sensor = modality == Modality::kLidar ? "LIDAR" : "CAMERA";
  scan.frame = static_cast<std::int64_t>(instant);
  scan.model = model;
  scan.state.stamp = scan.state.ego.stamp =
      Stamp::fromSeconds(1000 + kStep * static_cast<double>(instant));
  const auto& params = model->params();
  std::vector<char> merged(scene.objects.size(), 0);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto& o = scene.objects[i];
    const auto& row = params.classes[o.car ? 1 : 0];
    if (merged[i] || !encounterInView(o.path[instant]) || rng.uniform() > row.detection) continue;
    Vector2 z = o.path[instant];
    for (std::size_t j = i + 1; j < scene.objects.size() && conditions.merge_distance > 0; ++j) {
      const auto& other = scene.objects[j];
      const bool near = (other.path[instant] - z).norm() < conditions.merge_distance;
      if (merged[j] || other.car != o.car || !near || !encounterInView(other.path[instant]) ||
          rng.uniform() >= 0.8)
        continue;
      merged[j] = 1;
      z = 0.5 * (z + other.path[instant]);
      break;
    }
    z += Vector2(std::sqrt(row.noise(0, 0)) * rng.normal(),
                 std::sqrt(row.noise(1, 1)) * rng.normal());
    scan.measurements.push_back(measurementAt(z, drawLabel(row.labels, rng)));
  }
  for (int n = rng.poisson(params.clutter_per_scan); n > 0; --n) {
    Vector2 z;
    do z = {rng.uniform(0, 20), rng.uniform(-20, 20)};
    while (!encounterInView(z));
    scan.measurements.push_back(measurementAt(z, drawLabel(params.clutter_labels, rng)));
  }
  for (std::size_t i = scan.measurements.size(); i > 1; --i) {  // random order
    std::swap(scan.measurements[i - 1],
              scan.measurements[rng.below(static_cast<std::uint32_t>(i))]);
  }
  return scan;
}

}  // namespace

std::vector<Vector2> encounterWalk(const Vector2& from, const Vector2& to, double speed,
                                   double duration, double jitter, Rng& rng) {
  std::vector<Vector2> path;
  const double length = (to - from).norm();
  Vector2 wander = Vector2::Zero();
  for (int i = 0; i <= static_cast<int>(duration / kStep + 0.5); ++i) {
    wander += jitter * std::sqrt(kStep) * Vector2(rng.normal(), rng.normal());
    path.push_back(from + (to - from) * std::min(1.0, i * kStep * speed / length) + wander);
  }
  return path;
}

EncounterScene busyStreet(Rng& rng) {
  constexpr double kDuration = 8;  // [s]
  const auto instants = static_cast<std::size_t>(kDuration / kStep);
  EncounterScene scene;
  for (int i = 0; i < 8; ++i) {
    const double x = rng.uniform(3, 19), y = rng.uniform(-18, 18);
    scene.objects.push_back({true, std::vector<Vector2>(instants, Vector2(x, y))});
  }
  for (int i = 0; i < 6; ++i) {
    const double x = rng.uniform(4, 18), side = rng.uniform() < 0.5 ? 1 : -1;
    const Vector2 to(x + rng.normal(0, 3), 18 * side);
    auto path = encounterWalk({x, -18 * side}, to, rng.uniform(1, 1.7), kDuration, 0.05, rng);
    path.resize(instants);
    scene.objects.push_back({false, std::move(path)});
  }
  for (int i = 0; i < 3; ++i) {
    const double y = rng.uniform(-8, 8), speed = rng.uniform(3, 7);
    auto path = drive({40, y}, {-1, 0}, speed, kDuration);
    path.resize(instants);
    for (auto& p : path) p.x() = std::max(p.x(), -5.0);
    scene.objects.push_back({true, std::move(path)});
  }
  return scene;
}

ClassTable encounterClasses(double pedestrian_psd) {
  ObjectClass pedestrian;
  pedestrian.name = "pedestrian";
  pedestrian.motion = findMotionModel("constant-velocity");
  pedestrian.accel_psd = pedestrian_psd;
  pedestrian.position_psd = 0;
  pedestrian.prior = 0.5;
  pedestrian.max_speed = 3;  // newborns: sigma 1.5 m/s
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.accel_psd = 0.6;
  car.yaw_rate_psd = radians(15) * radians(15);
  car.position_psd = 1e-4;
  car.prior = 0.5;
  car.max_speed = 30;
  return {{pedestrian, car}};
}

std::shared_ptr<const PositionModel> encounterLidar(const EncounterConditions& conditions) {
  const auto isotropic = [](double sigma) { return Matrix2(sigma * sigma * Matrix2::Identity()); };
  return std::make_shared<const PositionModel>(sensorParams(conditions, 0.6, 0.03, {0.88, 0.91},
                                                            {isotropic(0.18), isotropic(0.45)},
                                                            {{{0.55, 0.45}, {0.49, 0.51}}}));
}

std::shared_ptr<const PositionModel> encounterCamera(const EncounterConditions& conditions) {
  const auto diagonal = [](double x, double y) {
    return Matrix2(Vector2(x * x, y * y).asDiagonal());
  };
  return std::make_shared<const PositionModel>(
      sensorParams(conditions, 0.15, 0.01, {0.70, 0.85}, {diagonal(0.7, 0.25), diagonal(0.9, 0.5)},
                   {{{0.90, 0.10}, {0.05, 0.95}}}));
}

std::vector<MeasurementScan> simulateEncounter(const EncounterScene& scene,
                                               const EncounterConditions& conditions, Rng& rng) {
  const auto lidar = encounterLidar(conditions);
  const auto camera = encounterCamera(conditions);
  std::vector<MeasurementScan> scans;
  for (std::size_t i = 0; i < scene.instants(); ++i) {
    scans.push_back(oneScan(scene, i, lidar, Modality::kLidar, conditions, rng));
    if (i % 2 == 0) scans.push_back(oneScan(scene, i, camera, Modality::kCamera, conditions, rng));
  }
  return scans;
}

}  // namespace perception
