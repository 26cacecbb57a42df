#pragma once
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception::test {

/// What a sensor says again and again: the evidence of shapes, detections with their labels, or
/// neither.
enum class Repeats { kNothing, kEvidence, kLooks };

/// Positions whose evidence repeats, or whose detections and labels do, or neither.
class RememberingModel final : public PositionModel {
 public:
  RememberingModel(Params params, const EvidenceMemory& memory, Repeats repeats)
      : PositionModel(std::move(params)), memory_(memory), repeats_(repeats) {}
  const EvidenceMemory* evidenceMemory() const override {
    return repeats_ == Repeats::kEvidence ? &memory_ : nullptr;
  }
  const EvidenceMemory* lookMemory() const override {
    return repeats_ == Repeats::kLooks ? &memory_ : nullptr;
  }

 private:
  EvidenceMemory memory_;
  Repeats repeats_;
};

/// One object 2.2 m away, its scans and its track under two linear classes.
struct RepeatFixture {
  EvidenceMemory memory{0.2, 0.9, 0.2, 0.3, 1, 0.5};
  Repeats repeats = Repeats::kEvidence;
  FilterModel model = exactModel(linearClasses());

  RepeatFixture() { model.params.kinematic_exponent = 0; }

  std::shared_ptr<const PositionModel> sensor() const {
    PositionModel::Params params = linearSensor();
    params.classes[1].detection = params.classes[0].detection;  // tells nothing of the class
    return std::make_shared<const RememberingModel>(params, memory, repeats);
  }
  MeasurementScan seen(double t, std::optional<EvidenceView> view,
                       std::vector<double> log_class = {1.5, -0.5}) const {
    MeasurementScan scan = positionScan(sensor(), t, {{1, 2, 0}});
    scan.measurements[0].log_class = std::move(log_class);
    scan.measurements[0].view = view;
    return scan;
  }
  Track born(const MeasurementScan& scan) const {
    return newTrack(likelihoodTable({}, scan, model).births[0], 0, scan, 0, model);
  }
  Track hit(const Track& before, const MeasurementScan& scan) const {
    const Track track = predictTrack(before, scan.state.stamp, model);
    const auto table = likelihoodTable({track}, scan, model);
    return hitTrack(track, table.tracks[0], table.tracks[0].pairs.at(0), scan, 1, model);
  }
};

/// Log odds of the first class against the second.
inline double odds(const Track& track) { return track.log_class[0] - track.log_class[1]; }

inline const EvidenceView kAhead{0.1, 3};

}  // namespace perception::test
