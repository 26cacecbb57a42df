#include "libperception/pipeline/watches/InnovationWatch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// The innovations of twelve poles, seen for 30 s at 10 Hz with errors of `sigma` [m] each axis
/// (the filter takes .3), of which `kept` repeats from scan to scan.
InnovationSums polesWith(double sigma, double kept) {
  FilterModel model = test::exactModel(test::linearClasses());
  model.proposal = Proposal::kRanked;
  model.params.existence_max = 0.999, model.params.existence_min = 0.002;
  CRbpfTracker tracker(model, ParticleFilterParams{}.toMrpt(), 1);
  PositionModel::Params params = test::linearSensor();
  params.clutter_per_scan = 0.01, params.births_per_scan = 0.1;
  const auto sensor = std::make_shared<const PositionModel>(params);
  InnovationWatch watch;
  Rng rng({7, 0, 0, 0});
  std::array<Vector2, 12> errors;
  for (Vector2& e : errors) e = Vector2(rng.normal(0, sigma), rng.normal(0, sigma));
  for (int k = 0; k < 300; ++k) {
    std::vector<test::LabeledPoint> points;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double fresh = sigma * std::sqrt(1 - kept * kept);
      errors[i] = kept * errors[i] + Vector2(rng.normal(0, fresh), rng.normal(0, fresh));
      points.push_back({5.0 * static_cast<double>(i) - 28 + errors[i].x(), 6 + errors[i].y(), 1});
    }
    MeasurementScan scan = test::positionScan(sensor, 0.1 * k, points);
    const auto index = tracker.scans();
    watch.before(tracker);
    EXPECT_TRUE(tracker.process(scan));
    watch.after(tracker, scan, index);
  }
  InnovationSums poles;
  for (const auto& [key, sums] : watch.sums())
    if (key == std::make_pair(std::string("POSITION"), ClassId{1})) poles += sums;
  return poles;
}

TEST(InnovationWatch, RightNoiseGivesOneAnAxisAndNoCorrelation) {
  const InnovationSums sums = polesWith(0.3, 0);
  EXPECT_GT(sums.updates, 3000U);
  EXPECT_EQ(sums.axes, 2 * sums.updates);
  EXPECT_NEAR(sums.nis(), 1, 0.1);
  EXPECT_NEAR(sums.lag1(), 0, 0.05);
}

TEST(InnovationWatch, NoiseTwiceAsLargeAsSaidRaisesTheSquares) {
  // Below 4: of the largest errors the walker is the likelier class.
  EXPECT_GT(polesWith(0.6, 0).nis(), 2.5);
}

TEST(InnovationWatch, ErrorsThatRepeatAreCorrelated) {
  EXPECT_GT(polesWith(0.3, 0.95).lag1(), 0.5);
}

TEST(InnovationWatch, WritesALineASensorAndClass) {
  InnovationWatch::Sums sums;
  sums[{"LIDAR", 1}].updates = 3;
  sums[{"LIDAR", 1}].axes = 6;
  sums[{"LIDAR", 1}].squares = 12;
  EXPECT_EQ(innovationsCsv(sums, test::linearClasses()),
            "sensor,class,updates,axes,nis,pair_axes,lag1\nLIDAR,static-other,3,6,2.0000,0,\n");
}

}  // namespace
}  // namespace perception
