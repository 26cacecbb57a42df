#include "libperception/core/LaneMap.h"

#include <gtest/gtest.h>

#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

LaneMap street() {
  return LaneMap({{"east", {{-200, 0}, {300, 0}}, 4, true},
                  {"west", {{300, 3.6}, {-200, 3.6}}, 4, true},
                  {"lane", {{120, -100}, {120, 100}}, 3, false}});
}

TEST(LaneMap, GivesTheLanesThatCoverAPlaceNearestFirst) {
  const LaneMap map = street();
  const auto on = map.at({37, 0.5});
  ASSERT_EQ(on.size(), 1u);
  EXPECT_EQ(map.lanes()[on[0].lane].name, "east");
  EXPECT_EQ(on[0].direction, 0);
  EXPECT_NEAR(on[0].offset, 0.5, 1e-12);
  const auto between = map.at({-199, 1.7});
  ASSERT_EQ(between.size(), 2u);
  EXPECT_EQ(between[0].lane, 0u);
  EXPECT_NEAR(between[1].offset, 1.9, 1e-12) << "left of who drives west";
  EXPECT_EQ(map.at({120, 0}).size(), 2u);
  EXPECT_FALSE(map.at({120, 50})[0].one_way);
}

TEST(LaneMap, EndsAtItsWidthAndLength) {
  const LaneMap map = street();
  EXPECT_EQ(map.at({50, -1.99}).size(), 1u);
  EXPECT_TRUE(map.at({50, -2.01}).empty());
  EXPECT_EQ(map.at({301.9, 0}).size(), 1u);
  EXPECT_TRUE(map.at({302.1, 0}).empty());
  EXPECT_TRUE(map.at({std::nan(""), 0}).empty());
}

TEST(LaneMap, LookUpMissesNoPlaceOfABentLane) {
  const Lane lane{"bend", {{0, 0}, {37, 4}, {51, 33}, {-20, 90.5}}, 3.4, true};
  const LaneMap map({lane});
  int inside = 0;
  for (double x = -30; x < 70; x += 0.7) {
    for (double y = -20; y < 110; y += 0.7) {
      double nearest = 1e9;
      for (std::size_t k = 0; k + 1 < lane.points.size(); ++k) {
        const Vector2 a = lane.points[k], d = lane.points[k + 1] - a, p(x, y);
        const double s = std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (p - a - s * d).norm());
      }
      if (std::abs(nearest - 1.7) < 1e-9) continue;
      ASSERT_EQ(map.at({x, y}).size(), nearest < 1.7 ? 1u : 0u) << x << " " << y;
      inside += nearest < 1.7;
    }
  }
  EXPECT_GT(inside, 500);
}

class LaneFile : public testing::Test {
 protected:
  /// What is wrong with a file of this content; empty: nothing.
  std::string fault(const std::string& rows) {
    std::ofstream(path_) << "lane,x,y,width,one_way\n" << rows;
    try {
      LaneMap::fromFile(path_);
    } catch (const DataError& e) {
      return e.what();
    }
    return "";
  }
  test::TemporaryFolder folder_;
  std::string path_ = folder_ / "a.lanes.csv";
};

TEST_F(LaneFile, WrittenIsReadAgain) {
  std::ofstream(path_) << lanesText(street().lanes());
  const LaneMap map = LaneMap::fromFile(path_);
  ASSERT_EQ(map.lanes().size(), 3u);
  EXPECT_EQ(map.lanes()[1].points[1], Vector2(-200, 3.6));
  EXPECT_EQ(map.lanes()[2].width, 3);
  EXPECT_FALSE(map.lanes()[2].one_way);
}

TEST_F(LaneFile, FaultsNameFileLineAndWhatWasExpected) {
  EXPECT_EQ(fault("a,0,0,3,1\na,5,0,3,1\n"), "");
  const std::pair<const char*, const char*> cases[] = {
      {"a,0,0,3,1\n", ":2: column 'lane'"},
      {"a,0,0,3,1\nb,0,0,3,1\nb,1,0,3,1\n", ":3: column 'lane'"},
      {"a,0,0,3,1\na,5,0,3,1\nb,0,0,3,1\nb,1,0,3,1\na,9,0,3,1\n", ":6: column 'lane'"},
      {"a,0,0,3,1\na,zero,0,3,1\n", ":3: column 'x'"},
      {"a,0,0,3,1\na,0,0,3,1\n", ":3: column 'x'"},
      {"a,0,0,-3,1\na,5,0,-3,1\n", ":2: column 'width'"},
      {"a,0,0,3,1\na,5,0,4,1\n", ":3: column 'width'"},
      {"a,0,0,3,1\na,5,0,3,0\n", ":3: column 'one_way'"},
      {"a,0,0,3,2\na,5,0,3,2\n", ":2: column 'one_way'"},
  };
  for (const auto& [rows, expected] : cases) {
    const std::string message = fault(rows);
    EXPECT_NE(message.find("a.lanes.csv"), std::string::npos) << message;
    EXPECT_NE(message.find(expected), std::string::npos) << rows << message;
    EXPECT_NE(message.find("expected"), std::string::npos) << message;
  }
  EXPECT_THROW(LaneMap::fromFile(folder_ / "none.csv"), DataError);
}

}  // namespace
}  // namespace perception
