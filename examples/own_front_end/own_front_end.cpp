// own_front_end INI LOG: a front end that the library does not have. It cuts a slice out of each
// lidar scan, .8 to 1.2 m above ground, and splits it where neighbors by bearing are more than .7 m
// apart; the centers of the parts are measurements of positions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

#include "libperception/measurement/models/PositionModel.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

using namespace perception;

/// Centers [m, world] of the parts of a frame's slice.
std::vector<Vector2> partsOf(const SensorFrame& frame, const LidarCloud& cloud) {
  std::vector<Vector2> slice, centers;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 p = frame.T_ego_sensor * Vector3(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (std::abs(p.z() - frame.ground.heightAt(p.x(), p.y()) - 1) < 0.2)
      slice.push_back(p.head<2>());
  }
  std::sort(slice.begin(), slice.end(), [](const Vector2& a, const Vector2& b) {
    return std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x());
  });
  for (std::size_t begin = 0, end = 0; begin < slice.size(); begin = end) {
    Vector2 sum = Vector2::Zero();
    do sum += slice[end++];
    while (end < slice.size() && (slice[end] - slice[end - 1]).norm() < 0.7);
    const Vector2 center = sum / static_cast<double>(end - begin);
    if (end - begin >= 3)
      centers.push_back((frame.ego.T_world_ego * Vector3(center.x(), center.y(), 0)).head<2>());
  }
  return centers;
}

/// Frames in, measurements out; has no state.
class SliceFrontEnd final : public FrontEnd {
 public:
  explicit SliceFrontEnd(PositionModel::Params params)
      : model_(std::make_shared<const PositionModel>(std::move(params))) {}
  std::vector<std::string> labelNames() const override { return {"part"}; }

 private:
  Modality modality() const override { return Modality::kLidar; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override {
    const auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (cloud == nullptr) return;
    for (const Vector2& center : partsOf(frame, *cloud)) {
      if (!model_->inView(center, scan.state)) continue;
      constexpr double kSigma = 0.5;  // [m] of a part about the object's center, assumed
      Measurement m;
      m.z = m.position = center;
      m.seen = 3;  // both axes
      m.R = kSigma * kSigma * Matrix2::Identity();
      m.position_sigma = kSigma;
      scan.measurements.push_back(m);
    }
  }
  std::shared_ptr<const PositionModel> model_;
};

/// Made by the INI's [sensor.LABEL] kind = slice, with the keys that every sensor has.
std::unique_ptr<FrontEnd> makeSliceFrontEnd(Config& config, const std::string& label,
                                            const ClassTable& classes) {
  const auto table = DetectionModel::read(config, "sensor." + label, classes, {"part"}, {});
  PositionModel::Params params;
  for (ClassId c = 0; c < classes.size(); ++c)
    params.classes.push_back({table.row(c).detection,
                              1e9,
                              2e9,
                              {1},
                              Matrix2::Zero(),
                              {classes[c].length, classes[c].width, 0.01, 0.01}});
  params.clutter_labels = {1};
  params.clutter_per_scan = table.params().clutter_per_scan;
  params.births_per_scan = table.params().births_per_scan;
  params.range = table.params().range_max;
  params.fov = table.params().fov;
  return std::make_unique<SliceFrontEnd>(std::move(params));
}

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: own_front_end INI LOG\n", stderr), 64;
  registerPerceptionClasses();
  frontEnds().push_back({"slice", &makeSliceFrontEnd});
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(PipelineSetup::fromFile(argv[1], {}), events, timing);
  const auto take = [&](bool end) {
    while (const auto scene = pipeline.next(end))
      std::printf("%.3f s: %zu objects\n", scene->stamp.seconds(), scene->objects.size());
  };
  RawlogReader log(argv[2]);
  while (const auto observation = log.next()) pipeline.add(*observation), take(false);
  take(true);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "own_front_end: error: %s\n", error.what()), 65;
}
