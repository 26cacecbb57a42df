#include "libperception/lidar/segments/LidarField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

constexpr int kColumns = 900;  // of 0.4 degrees

/// Columns with returns between two azimuths [deg], counter-clockwise.
std::vector<std::uint8_t> returnsBetween(int from, int to) {
  std::vector<std::uint8_t> any(kColumns, 0);
  for (int k = 0; k < kColumns; ++k) {
    const double degree = 0.4 * k + 0.2;
    any[static_cast<std::size_t>(k)] =
        from < to ? degree > from && degree < to : degree > from || degree < to;
  }
  return any;
}

bool looksAt(const LidarField& field, double degree) { return field.hasAzimuth(radians(degree)); }

TEST(LidarField, IsTheWholeCircleWithoutAnyReturns) {
  const LidarField nothing_known, no_return(std::vector<std::uint8_t>(kColumns, 0));
  for (const LidarField& field : {nothing_known, no_return})
    for (const double degree : {-170.0, 0.0, 90.0}) EXPECT_TRUE(looksAt(field, degree)) << degree;
}

TEST(LidarField, EndsWhereTheReturnsOfALidarThatLooksAheadEnd) {
  const LidarField field(returnsBetween(300, 60));
  for (const double degree : {-59.5, 0.0, 59.5, 300.5})
    EXPECT_TRUE(looksAt(field, degree)) << degree;
  for (const double degree : {-60.5, 60.5, 180.0, -180.0})
    EXPECT_FALSE(looksAt(field, degree)) << degree;
}

TEST(LidarField, HasGapsOnEitherSideOfTheVehicle) {
  std::vector<std::uint8_t> any = returnsBetween(300, 60), behind = returnsBetween(150, 210);
  std::transform(any.begin(), any.end(), behind.begin(), any.begin(),
                 [](std::uint8_t a, std::uint8_t b) { return a | b; });
  const LidarField field(any);
  EXPECT_TRUE(looksAt(field, 180));
  EXPECT_FALSE(looksAt(field, 100));
  EXPECT_FALSE(looksAt(field, -100));
}

TEST(LidarField, ANarrowGapIsOfWhatReturnsNothing) {
  const auto least = std::lround(LidarField::kLeastGap / kTwoPi * kColumns);
  std::vector<std::uint8_t> any(kColumns, 1);
  std::fill_n(any.begin() + 100, least - 1, 0);
  EXPECT_TRUE(LidarField(any).has(100));
  any[100 + static_cast<std::size_t>(least) - 1] = 0;
  EXPECT_FALSE(LidarField(any).has(100));
  EXPECT_FALSE(LidarField(any).has(100 - kColumns));
  EXPECT_TRUE(LidarField(any).has(99));
}

// The sensor's section says 360 degrees; the scanner looks 30 to each side.
TEST(LidarField, ACarThatReachesBeyondItHasAnEndThatIsNotSeen) {
  const ClusterClassifier never_asked(BoostedTrees{}, {}, {0.2, 0.2, 0.2, 0.2, 0.1, 0.1}, {}, {});
  test::SolidScene scene;
  scene.boxes = {{{12.9, 6}, kPi / 2, 4.4, 1.8, 0.25, 1.5}};
  const auto scan = test::shapedFrontEnd({ObjectShape::kVehicle},
                                         std::make_shared<const ClusterClassifier>(never_asked))
                        .extract(castScan(scene, test::narrowLidar()));
  ASSERT_EQ(scan.measurements.size(), 1U);
  const Measurement& car = scan.measurements[0];
  EXPECT_FALSE(car.seen >> FootprintModel::kLeft & 1);
  EXPECT_TRUE(car.seen >> FootprintModel::kRight & 1);
  EXPECT_FALSE(car.sides->length_complete);
}

TEST(LidarField, IsNotToldByAScanThatHoldsObjectsAlone) {
  test::SolidScene scene;
  scene.boxes = {{{12, 0}, kPi / 2, 4.4, 1.8, 0.25, 1.5}};
  test::ObstacleScan whole(scene);
  EXPECT_FALSE(whole.found.field.isWhole());
  const DirectionCells cells(whole.found.points);
  EXPECT_FALSE(fieldOf(cells, whole.found.height, 0.25).isWhole());
  EXPECT_TRUE(fieldOf(cells, whole.found.height, -1).isWhole()) << "nothing counts as ground";
}

}  // namespace
}  // namespace perception
