#include "libperception/filter/likelihood/LikelihoodRow.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/Update.h"
#include "libperception/measurement/models/ForwardedModel.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// A PositionModel that does not say that it sees places alone.
class GeneralModel final : public MeasurementModel {
 public:
  explicit GeneralModel(PositionModel m) : m_(std::move(m)) {}
  const std::vector<AxisKind>& axes() const override { return m_.axes(); }
  void predict(const Kinematics* objects, const Extent* extents, std::size_t count,
               const SensorState& sensor, AxisPrediction* out) const override {
    m_.predict(objects, extents, count, sensor, out);
  }
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override {
    return m_.detectionProbability(c, object, extent, sensor, visibility);
  }
  double logLabelLikelihood(int label, ClassId c) const override {
    return m_.logLabelLikelihood(label, c);
  }
  double logLabelClutter(int label) const override { return m_.logLabelClutter(label); }
  double logClutterDensity(const Measurement& m, const SensorState& sensor) const override {
    return m_.logClutterDensity(m, sensor);
  }
  double logBirthDensity(const Measurement& m, ClassId c,
                         const SensorState& sensor) const override {
    return m_.logBirthDensity(m, c, sensor);
  }
  std::optional<BirthState> birth(const Measurement& m, ClassId c,
                                  const SensorState& sensor) const override {
    return m_.birth(m, c, sensor);
  }

 private:
  PositionModel m_;
};

struct RowWorld {
  FilterModel model = test::exactModel(test::linearClasses());
  PositionModel::Params sensor = test::linearSensor();

  RowWorld() {
    ObjectClass car = model.classes[0];
    car.name = "car";
    car.motion = findMotionModel("wheeled");
    car.yaw_rate_psd = 0.0685;
    model.classes.classes.push_back(car);
    model.params.gate_probability = 0.999;
    sensor.classes.push_back(sensor.classes[0]);
    sensor.classes[2].full_range = 5;
    sensor.classes[2].last_range = 60;
    sensor.fov = radians(200);
    sensor.range = 25;
  }

  Track track(Rng& rng) const {
    Track t;
    t.existence = 0.9;
    const Vector2 place(rng.normal(8, 8), rng.normal(0, 8));
    for (int j = 0; j < 3; ++j) {
      ClassFilter f;
      Matrix4 root;
      for (int i = 0; i < 16; ++i) root(i / 4, i % 4) = rng.normal(0, 0.4);
      f.P = root * root.transpose();
      f.x << place.x() + rng.normal(0, 0.3), place.y() + rng.normal(0, 0.3), rng.normal(),
          rng.normal();
      t.bank.push_back(f);
      t.log_class.push_back(std::log(1. / 3));
    }
    t.bank[2].oriented = true;
    t.decided_class = rng.uniform() < 0.2 ? 2 : -1;
    return t;
  }
};

/// The same scan, seen by either model.
MeasurementScan scanOf(const RowWorld& w, const std::vector<Track>& tracks, Rng& rng,
                       bool general) {
  MeasurementScan scan;
  const PositionModel model(w.sensor);
  if (general) {
    scan.model = std::make_shared<const GeneralModel>(model);
  } else {
    scan.model = std::make_shared<const PositionModel>(model);
  }
  for (const Track& t : tracks) {
    Measurement m;
    m.z = Vector2(t.bank[0].x[0] + rng.normal(0, 0.5), t.bank[0].x[1] + rng.normal(0, 0.5));
    m.R = 0.02 * Matrix2::Identity();
    m.R(0, 1) = m.R(1, 0) = 0.005;
    m.seen = 3;
    m.position = m.z;
    m.heading = MeasuredHeading{rng.uniform(-3, 3), 0.1, 0.1};
    scan.measurements.push_back(m);
  }
  auto occlusion = std::make_shared<OcclusionMap>(Vector2(0, 0), 360);
  for (int i = 0; i < 100; ++i) occlusion->add({rng.normal(0, 15), rng.normal(0, 15)});
  scan.occlusion = occlusion;
  return scan;
}

bool alike(double a, double b) { return a == b || std::abs(a - b) < 1e-9; }  // -inf, too

TEST(PlaceRow, IsThatOfTheGeneralWayAndSoIsTheUpdate) {
  const RowWorld w;
  Rng rng({21, 0, 0, 0});
  int pairs = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Track> tracks;
    for (int i = 0; i < 10; ++i) tracks.push_back(w.track(rng));
    Rng a = rng, b = rng;
    const MeasurementScan scan = scanOf(w, tracks, a, false), same = scanOf(w, tracks, b, true);
    rng = a;
    const LikelihoodTable place = likelihoodTable(tracks, scan, w.model);
    const LikelihoodTable general = likelihoodTable(tracks, same, w.model);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const TrackLikelihoods &p = place.tracks[i], &g = general.tracks[i];
      ASSERT_EQ(p.in_view, g.in_view);
      ASSERT_NEAR(p.detection, g.detection, 1e-12);
      ASSERT_EQ(p.pairs.size(), g.pairs.size());
      ASSERT_TRUE(p.predictions.empty());
      for (std::size_t n = 0; n < p.pairs.size(); ++n, ++pairs) {
        ASSERT_EQ(p.pairs[n].measurement, g.pairs[n].measurement);
        ASSERT_NEAR(p.pairs[n].log_likelihood, g.pairs[n].log_likelihood, 1e-9);
        const Track hit = hitTrack(tracks[i], p, p.pairs[n], scan, 1, w.model);
        const Track usual = hitTrack(tracks[i], g, g.pairs[n], same, 1, w.model);
        for (std::size_t j = 0; j < 3; ++j) {
          ASSERT_TRUE(alike(p.pairs[n].log_class_evidence[j], g.pairs[n].log_class_evidence[j]));
          ASSERT_TRUE(alike(hit.log_class[j], usual.log_class[j]));
          ASSERT_LT((hit.bank[j].x - usual.bank[j].x).norm(), 1e-9);
          ASSERT_LT((hit.bank[j].P - usual.bank[j].P).norm(), 1e-9);
        }
      }
    }
  }
  EXPECT_GT(pairs, 100);
}

/// What a lidar has seen for a second, `aside` [m] of the way of its vehicle, which drives at `own`
/// [m/s] along x; what is seen goes along at 3 m/s.
struct SeenAlong {
  FilterModel model = test::exactModel(test::linearClasses());
  Track track;
  TrackLikelihoods row;

  SeenAlong(double own, double aside, bool told_by_shape) {
    for (int j = 0; j < 2; ++j) {
      ClassFilter f;
      f.x << 10, aside, j == 0 ? 3 : 0, 0;
      f.P.topLeftCorner<2, 2>() = 0.01 * Matrix2::Identity();
      if (j == 0) f.P.bottomRightCorner<2, 2>() = 0.01 * Matrix2::Identity();
      track.bank.push_back(f);
      track.log_class.push_back(std::log(0.5));
    }
    track.existence = 0.9;
    PositionModel::Params sensor = test::linearSensor();
    sensor.classes[1] = sensor.classes[0];  // motion alone tells the class
    for (int k = 1; k <= 10; ++k) {
      MeasurementScan scan;
      scan.model = std::make_shared<const PositionModel>(sensor);
      scan.state.stamp = Stamp{std::int64_t{100000000} * k};
      scan.state.ego.velocity = {own, 0};
      Measurement m;
      m.z = Vector2(10 + 0.3 * k, aside);
      m.R = 0.01 * Matrix2::Identity();
      m.seen = 3;
      m.position = m.z;
      if (told_by_shape) m.view = EvidenceView{0, 2, 50};
      scan.measurements = {m};
      for (int j = 0; j < 2; ++j)
        predictClassFilter(model.classes[j], 0.1, track.bank[static_cast<std::size_t>(j)]);
      row = likelihoodTable({track}, scan, model).tracks[0];
      track = hitTrack(track, row, row.pairs.at(0), scan, static_cast<std::uint64_t>(k), model);
    }
  }
  double pThing() const { return std::exp(track.log_class[1]); }
};

TEST(PairTerms, WhatGoesAlongWithTheVehicleMayBeAThingOfWhichOneBeamSeesAPart) {
  const SeenAlong along(3, 4, true);
  EXPECT_GT(along.track.goes_along, 0.99);
  EXPECT_GT(along.pThing(), 0.1);
  for (const double own : {0.0, 1.5, 6.0}) {
    const SeenAlong other(own, 4, true);
    EXPECT_LT(other.pThing(), 1e-3) << own;
  }
}

TEST(PairTerms, WhatIsNotToldByItsShapeIsToldByItsMotion) {
  EXPECT_LT(SeenAlong(3, 4, false).pThing(), 1e-3);
}

TEST(PairTerms, WhatGoesAlongInTheOwnWayIsAVehicleAhead) {
  EXPECT_LT(SeenAlong(3, 0, true).pThing(), 1e-3);
  EXPECT_LT(SeenAlong(3, -1.5, true).pThing(), 1e-3);
}

/// A sensor whose innovations say less of what another one has told by its shape.
class RepeatingModel final : public ForwardedModel {
 public:
  using ForwardedModel::ForwardedModel;
  double innovationShare() const override { return 0.2; }
  double aloneInnovationShare() const override { return 0.5; }
};

TEST(PairTerms, TheMotionOfWhatNoShapeHasToldSaysMoreOfItsClass) {
  FilterModel model = test::exactModel(test::linearClasses());
  Track track;
  for (int j = 0; j < 2; ++j) {
    ClassFilter f;
    f.x << 10, j, 0, 0;
    f.P.topLeftCorner<2, 2>() = Matrix2::Identity();
    track.bank.push_back(f);
    track.log_class.push_back(std::log(0.5));
  }
  PositionModel::Params sensor = test::linearSensor();
  sensor.classes[1] = sensor.classes[0];  // the place alone tells the class
  MeasurementScan scan;
  scan.model = std::make_shared<const RepeatingModel>(std::make_shared<PositionModel>(sensor));
  Measurement m;
  m.position = m.z = Vector2(10, 0);
  m.R = 0.01 * Matrix2::Identity();
  m.seen = 3;
  scan.measurements = {m};
  const auto told = [&] {
    const auto pair = likelihoodTable({track}, scan, model).tracks[0].pairs.at(0);
    return pair.log_class_evidence[0] - pair.log_class_evidence[1];
  };
  const double alone = told();
  track.evidence.emplace_back();  // of a lidar
  EXPECT_GT(alone, 0.1);
  EXPECT_NEAR(told() / alone, 0.2 / 0.5, 1e-9);
}

}  // namespace
}  // namespace perception
