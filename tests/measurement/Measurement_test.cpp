#include "libperception/measurement/Measurement.h"

#include <gtest/gtest.h>

#include "libperception/measurement/frames/FrontEnd.h"

namespace perception {
namespace {

/// A front end that measures one object.
class OneObject : public FrontEnd {
 protected:
  Modality modality() const override { return Modality::kLidar; }
  std::shared_ptr<const MeasurementModel> model() const override { return nullptr; }
  void fill(const SensorFrame&, MeasurementScan& scan) const override {
    Measurement m;
    m.z = Vector2(3, 4);
    m.R = Matrix2::Identity();
    m.position_sigma = 1;
    m.base_z = ScalarEstimate{0.5, 0.25};
    m.height = ScalarEstimate{1.5, 0.01};
    m.sides = PartialBox{};
    m.sides->length_sigma = 0.3;
    m.heading = MeasuredHeading{};
    m.heading->sigma = 0.1;
    scan.measurements.push_back(m);
  }
};

TEST(Measurement, NoiseScaleIsOfAllStandardDeviationsAndOfNothingElse) {
  OneObject front_end;
  const Measurement before = front_end.extract({}).measurements.at(0);
  front_end.scaleNoiseBy(3);
  const Measurement m = front_end.extract({}).measurements.at(0);
  EXPECT_EQ(m.z, before.z);
  EXPECT_TRUE(m.R.isApprox(9 * before.R));
  EXPECT_NEAR(m.position_sigma, 3, 1e-12);
  EXPECT_NEAR(m.base_z->variance, 9 * 0.25, 1e-12);
  EXPECT_NEAR(m.base_z->mean, 0.5, 1e-12);
  EXPECT_NEAR(m.height->variance, 9 * 0.01, 1e-12);
  EXPECT_NEAR(m.sides->length_sigma, 0.9, 1e-12);
  EXPECT_NEAR(m.heading->sigma, 0.3, 1e-12);
  EXPECT_NEAR(m.heading->flip_probability, before.heading->flip_probability, 1e-12);
}

}  // namespace
}  // namespace perception
