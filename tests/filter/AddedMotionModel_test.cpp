#include <gtest/gtest.h>

#include <cmath>

#include "libperception/filter/Step.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

const Vector2 kRail(std::cos(0.5), std::sin(0.5));

/// A train: white acceleration along its rail, none across it.
void moveOnRail(const GaussianStep& s, Matrix4* transition) {
  const Matrix2 along = kRail * kRail.transpose();
  Matrix4 F = Matrix4::Identity(), Q = Matrix4::Zero();
  F.topRightCorner<2, 2>() = s.dt * along;
  F.bottomRightCorner<2, 2>() = along;
  Q.topLeftCorner<2, 2>() = s.psd * std::pow(s.dt, 3) / 3 * along;
  Q.topRightCorner<2, 2>() = Q.bottomLeftCorner<2, 2>() = s.psd * s.dt * s.dt / 2 * along;
  Q.bottomRightCorner<2, 2>() = s.psd * s.dt * along;
  *s.x = (F * *s.x).eval();
  *s.P = (F * *s.P * F.transpose() + Q).eval();
  if (transition) *transition = F;
}

Kinematics railKinematics(const Vector4& x, bool) {
  Kinematics k;
  k.q.head<4>() = x;
  k.J.topRows<4>().setIdentity();
  return k;
}

/// The row stays in the table of this program.
ClassTable trams() {
  if (!findMotionModel("rail"))
    motionModels().push_back({"rail", true, false, moveOnRail, railKinematics, nullptr});
  Config config = Config::fromText(
      "[class.tram]\nmotion = rail\nmax_speed = 20\naccel_psd = 0.1\nprior = 0.5\n"
      "[class.static-other]\nmotion = static\nmax_speed = 0\nprior = 0.5\n");
  return readClassTable(config);
}

TEST(AMotionModelOfAProgramsOwn, IsReadByItsNameAndTracked) {
  FilterModel model = test::exactModel(trams());
  model.proposal = Proposal::kRanked;
  ASSERT_EQ(model.classes[0].motion->name, "rail");
  auto params = test::linearSensor();
  params.clutter_per_scan = params.births_per_scan = 0.01;
  const auto sensor = std::make_shared<const PositionModel>(params);
  Posterior posterior = Posterior::empty(1);
  // 6 m/s along the rail; the measurements stray to both sides of it.
  for (int i = 0; i < 30; ++i) {
    const double t = 0.1 * i, across = i % 2 == 0 ? 0.1 : -0.1;
    const Vector2 at = 6 * t * kRail + across * Vector2(-kRail.y(), kRail.x());
    const auto scan = test::positionScan(sensor, t, {{at.x(), at.y(), 0}});
    posterior = step(posterior, scan, model, {1, std::uint64_t(i), 0, 0}, 4).posterior;
  }
  const auto& tracks = posterior.hypotheses[mapHypothesis(posterior).slot]->tracks;
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_GT(classProbabilities(*tracks[0])[0], 0.99);
  const Vector2 velocity = tracks[0]->bank[0].x.tail<2>();
  EXPECT_NEAR(velocity.dot(kRail), 6, 0.2);
  // No measurement moves a velocity across the rail: its covariance with the place is zero.
  EXPECT_LT(std::abs(velocity.y() * kRail.x() - velocity.x() * kRail.y()), 1e-9);
}

}  // namespace
}  // namespace perception
