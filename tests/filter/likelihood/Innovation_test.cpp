#include "libperception/filter/likelihood/Innovation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/ClassFilterUpdate.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {
namespace {

ClassTable cars() {
  ObjectClass c;
  c.name = "car";
  c.motion = findMotionModel("wheeled");
  c.length = 4.5, c.width = 1.8;
  return {{c}};
}

/// A car whose center is 10 m ahead.
ClassFilter carAhead(double yaw) {
  ClassFilter f;
  f.x << 10, 0, 0, yaw;
  f.P.diagonal() << 0.05, 0.05, 0.1, 1e-4;
  f.extent = {4.5, 1.8, 0.45, 0.07};
  f.oriented = true;
  return f;
}

/// After its outline, the edges nearer to each other by `narrower` [rad] each than expected.
Extent extentAfter(ClassFilter f, double narrower) {
  const FootprintModel model(cars(), DetectionModel(DetectionParams{}, {{}}, {}));
  const Kinematics k = kinematicsOf(cars()[0], f);
  AxisPrediction p;
  model.predict(&k, &f.extent, 1, {}, &p);
  Measurement m;
  m.z = p.h;
  m.z[FootprintModel::kLeft] -= narrower, m.z[FootprintModel::kRight] += narrower;
  m.R = Vector3(1e-3, 1e-3, 0.06).asDiagonal();
  m.seen = FootprintModel::kAll;
  updateClassFilter(innovationOf(f, k, p, m, model), f);
  return f.extent;
}

TEST(Innovation, ANarrowRearTellsNoLength) {
  const Extent after = extentAfter(carAhead(0), 0.05);
  EXPECT_NEAR(after.length, 4.5, 1e-6);
  EXPECT_NEAR(after.var_length, 0.45, 1e-6);
  EXPECT_LT(after.width, 1.75);
}

TEST(Innovation, ANarrowSideTellsItsLength) {
  const Extent after = extentAfter(carAhead(kPi / 2), 0.05);
  EXPECT_LT(after.length, 4.2);
  EXPECT_NEAR(after.width, 1.8, 1e-6);
}

}  // namespace
}  // namespace perception
