#include "libperception/lidar/two_spacings/PersonPeaks.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/lidar/two_spacings/PersonResponse.h"

namespace perception {
namespace {

struct PersonReturns {
  std::vector<float> x, y, height;
  void add(double px, double py, double h) {
    x.push_back(static_cast<float>(px)), y.push_back(static_cast<float>(py)),
        height.push_back(static_cast<float>(h));
  }
  /// PersonReturns on the near side of a person of 1.7 m.
  void person(double px, double py, int count, std::uint64_t seed) {
    Rng rng(RngKey{seed, 0, 0, 11});
    for (int i = 0; i < count; ++i) {
      const double around = rng.uniform(kPi / 2, 3 * kPi / 2);
      add(px + 0.2 * std::cos(around), py + 0.2 * std::sin(around), 0.35 + 1.3 * i / (count - 1));
    }
  }
  std::vector<PersonPeak> find(PersonParams params = {}) const {
    return findPersons(x, y, height, params);
  }
};

/// Integral of the kernel over the plane or, with `line`, along a line through its center.
double integral(const PersonParams& params, bool line) {
  double sum = 0;
  for (double r = 5e-5; r < 10; r += 1e-4)
    sum += 1e-4 * personKernel(r, params) * (line ? 2 : kTwoPi * r);
  return sum;
}

TEST(PersonKernel, HasTheFiguresOfBothReadings) {  // method.md 8.3
  PersonParams consistent, printed;
  printed.kernel = PersonParams::Kernel::kPrinted;
  EXPECT_NEAR(personKernel(0, consistent), 1.808, 5e-4);
  EXPECT_NEAR(personKernel(0, printed), 1.808, 5e-4);
  EXPECT_NEAR(personKernel(0.606, consistent), 0, 3e-3);
  EXPECT_NEAR(personKernel(0.661, printed), 0, 3e-3);
  EXPECT_NEAR(personKernel(0.92, consistent), -0.438, 1e-3);
  EXPECT_NEAR(personKernel(0.93, printed), -0.235, 1e-3);
  EXPECT_LT(std::abs(personKernel(2.25, consistent)), 4e-4);
}

TEST(PersonKernel, IsNegativeToAUniformFieldInTheConsistentReadingAlone) {
  PersonParams params;
  EXPECT_NEAR(integral(params, false), -0.90, 1e-3);
  EXPECT_NEAR(integral(params, true), 0.75, 5e-3);
  params.kernel = PersonParams::Kernel::kPrinted;
  EXPECT_NEAR(integral(params, false), 0.057, 1e-3);
  EXPECT_NEAR(integral(params, true), 1.07, 5e-3);
}

TEST(PersonPeaks, ALonePersonIsFoundWhereItStands) {
  PersonReturns returns;
  returns.person(12.1, -3.2, 30, 1);
  const auto peaks = returns.find();
  ASSERT_EQ(peaks.size(), 1u);
  EXPECT_NEAR(peaks[0].center.x(), 12.1 - 0.13, 0.1);  // the mean of a half circle's returns
  EXPECT_NEAR(peaks[0].center.y(), -3.2, 0.1);
  EXPECT_GT(peaks[0].normalized, 1.3);
  EXPECT_EQ(peaks[0].points.size(), 30u);
}

TEST(PersonPeaks, ResponseIsTheSumOfTheKernelOverTheReturnsCells) {
  PersonReturns returns;
  returns.person(5.1, 5.2, 25, 3);
  Rng rng(RngKey{4, 0, 0, 11});
  for (int i = 0; i < 200; ++i) returns.add(rng.uniform(2, 9), rng.uniform(2, 9), 1);
  PersonParams params;
  params.threshold = 0, params.min_span = 0;
  const auto peaks = returns.find(params);
  ASSERT_FALSE(peaks.empty());
  for (const PersonPeak& peak : peaks) {
    // The peak's cell center is the one whose literal sum is the response.
    double best = 1e9;
    for (int column = -4; column <= 4; ++column)
      for (int row = -4; row <= 4; ++row) {
        const double cx = (std::floor(peak.center.x() / 0.25) + column + 0.5) * 0.25;
        const double cy = (std::floor(peak.center.y() / 0.25) + row + 0.5) * 0.25;
        double sum = 0;
        for (std::size_t i = 0; i < returns.x.size(); ++i) {
          const double px = (std::floor(static_cast<double>(returns.x[i]) / 0.25) + 0.5) * 0.25;
          const double py = (std::floor(static_cast<double>(returns.y[i]) / 0.25) + 0.5) * 0.25;
          const double r = std::hypot(px - cx, py - cy);
          if (r <= params.support) sum += personKernel(r, params);
        }
        best = std::min(best, std::abs(sum - peak.response));
      }
    EXPECT_LT(best, 1e-3);
  }
}

TEST(PersonPeaks, WallsAndFieldsHaveNone) {
  PersonReturns wall;
  for (int i = 0; i < 100; ++i)
    for (int level = 0; level < 4; ++level) wall.add(10, -5 + 0.1 * i, 0.4 + 0.4 * level);
  for (const PersonPeak& peak : wall.find())
    EXPECT_GT(std::abs(peak.center.y()), 4.3);  // its ends at most
  PersonReturns field;
  Rng rng(RngKey{9, 0, 0, 11});
  for (int i = 0; i < 20000; ++i)
    field.add(rng.uniform(0, 20), rng.uniform(0, 20), rng.uniform(0.3, 2));
  EXPECT_TRUE(field.find().empty());
}

TEST(PersonPeaks, TwoWalkersSideBySideAreTwo) {
  PersonReturns returns;
  returns.person(10, 0, 30, 5);
  returns.person(10, 1.2, 30, 6);
  EXPECT_EQ(returns.find().size(), 2u);
}

TEST(PersonPeaks, NeedReturnsAndHeight) {
  PersonReturns few, low;
  few.person(10, 0, 3, 7);
  EXPECT_TRUE(few.find().empty());
  for (int i = 0; i < 20; ++i) low.add(10, 0.02 * i, 0.35 + 0.03 * i);  // a bollard of 0.9 m
  EXPECT_TRUE(low.find().empty());
}

TEST(PersonPeaks, PostsCrownsAndTwigsAreNone) {
  PersonReturns post, trunk, crown, twigs;
  for (int i = 0; i < 40; ++i) {  // 8 cm wide, as seen from the origin
    post.add(10 + 0.02 * (i % 3), 0.02 * (i % 5), 0.35 + 0.03 * i);
    trunk.add(10 + 0.02 * (i % 3), 0.08 * (i % 5), 0.35 + 0.05 * i);  // 2.3 m high
    crown.add(10 + 0.02 * (i % 3), 0.08 * (i % 5), 1.05 + 0.025 * i);
    twigs.add(10 + 0.02 * (i % 3), 0.08 * (i % 5), (i < 20 ? 0.35 : 1.25) + 0.01 * (i % 20));
  }
  for (const PersonReturns& returns : {post, trunk, crown, twigs}) {
    EXPECT_TRUE(returns.find().empty());
    PersonParams paper;
    paper.max_top = paper.max_bottom = paper.max_gap = 5, paper.min_width = 0;
    EXPECT_EQ(returns.find(paper).size(), 1u);
  }
}

TEST(PersonPeaks, WeightsCountAsReturns) {
  PersonReturns returns;
  returns.person(10, 0, 30, 5);
  const std::vector<float> half(30, 0.5f), none(30, 0.1f);
  const PersonParams params;
  const auto whole = returns.find(),
             weighted = findPersons(returns.x, returns.y, returns.height, params, half);
  ASSERT_EQ(whole.size(), 1u);
  ASSERT_EQ(weighted.size(), 1u);
  EXPECT_NEAR(weighted[0].response, whole[0].response / 2, 1e-3);
  EXPECT_NEAR(weighted[0].normalized, whole[0].normalized, 1e-4);
  EXPECT_NEAR(weighted[0].weight, 15, 1e-6);
  // 30 returns of which three are of surfaces: fewer than min_points.
  EXPECT_TRUE(findPersons(returns.x, returns.y, returns.height, params, none).empty());
}

TEST(PersonPeaks, NoReturnsNoPersons) { EXPECT_TRUE(PersonReturns().find().empty()); }

}  // namespace
}  // namespace perception
