#include "libperception/filter/update/UpdateCache.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "libperception/filter/Step.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

TEST(EndedTracks, AreKeptForAsLongAsScenesMayBeLate) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  FilterModel model = exactModel(linearClasses());
  model.params.existence_min = 0.2;
  const auto after = [&](double history, int scans) {
    model.history = history;
    Posterior p = Posterior::empty(1);
    model.proposal = Proposal::kRanked;
    for (int s = 0; s < scans; ++s) {
      const std::vector<test::LabeledPoint> seen =
          s == 0 ? std::vector<test::LabeledPoint>{{1, 2, 0}} : std::vector<test::LabeledPoint>{};
      p = step(p, positionScan(sensor, 0.1 * s, seen), model, {1, 0, 0, 0}, 1).posterior;
    }
    return *p.hypotheses.at(0);
  };
  ASSERT_EQ(after(1, 1).tracks.size(), 1u);
  ASSERT_EQ(after(1, 2).tracks.size(), 0u) << "one miss makes it unlikely";
  const std::uint64_t born = after(1, 1).tracks[0]->id;
  ASSERT_EQ(after(1, 2).ended.size(), 1u);
  EXPECT_EQ(after(1, 2).ended[0].track->id, born);
  EXPECT_EQ(after(1, 2).ended[0].end, Stamp::fromSeconds(1000.1));
  EXPECT_EQ(after(1, 11).ended.size(), 1u);
  EXPECT_EQ(after(1, 13).ended.size(), 0u) << "1.1 s after its end";
  EXPECT_EQ(after(0, 2).ended.size(), 0u) << "scenes are made at once";
}

}  // namespace
}  // namespace perception
