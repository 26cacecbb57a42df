#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libperception/weather/HeightAboveGround.h"
#include "libperception/weather/IntensityLaw.h"
#include "libperception/weather/Neighbors.h"
#include "libperception/weather/PhantomShare.h"
#include "libperception/weather/PointFilter.h"
#include "libperception/weather/RangeImage.h"
#include "libperception/weather/SurroundingCubes.h"
#include "libperception/weather/SuspectReturns.h"
#include "libperception/weather/TrustCurve.h"
#include "libperception/weather/TrustParams.h"

namespace perception {

/// The curves over counts of neighbors, read straight from the counts [log-odds].
struct CountCurves {
  CountCurves(const TrustCurve& of_tight, const TrustCurve& of_wide, const TrustCurve& of_beyond);
  std::array<float, NeighborCounts::kMost> tight, wide;
  std::array<float, NeighborCounts::kMost * NeighborCounts::kMost> beyond;
};

/// P(phantom) of every return from how it stands among its neighbors in the range image, its
/// height above the ground, its intensity, the sensor's label and echoes. Two passes: in the second
/// counts what the first made of the returns nearby, so that a dark car keeps its dark returns. The
/// share of phantoms follows the weather, so that nothing is doubted in clear air.
class PointTrust final : public PointFilter {
 public:
  explicit PointTrust(const TrustParams& params);

  TrustStats apply(SensorFrame& frame) override;

  /// Of the last scan, for studies and fits.
  std::vector<SuspectReturn> suspects() const;
  double share() const { return share_.value(); }
  std::array<float, IntensityLaw::kBins> intensityLogRatios() const { return law_.logRatios(); }
  double rowPitch() const { return image_.rowPitch(); }  ///< [rad]
  std::size_t memoryBytes() const;

 private:
  /// What is counted while the scan is read once.
  struct Census {
    int within_share_range = 0;                                ///< returns
    std::array<std::uint32_t, IntensityLaw::kBins> returns{};  ///< every kIntensityStep'th, near
  };
  void placeReturns(const SensorFrame& frame, const LidarCloud& cloud);
  void count(const RangeImage::Block& block, const std::uint32_t* bins);
  NeighborRules neighborRules() const;
  void countNeighbors();
  void applySensorLabels(const LidarCloud& cloud);
  void learnIntensity();
  void weighIntensity();
  void applyNeighborhood();
  void writeTrust(LidarCloud& cloud, TrustStats& stats);

  const TrustCurve& curve(TrustFeature feature) const {
    return curves_[static_cast<std::size_t>(feature)];
  }

  TrustParams params_;
  std::array<TrustCurve, kTrustFeatures> curves_;
  CountCurves count_curves_;
  RangeImage image_;
  IntensityLaw law_;
  bool uses_intensity_ = false;  // this scan has it, and it is used
  PhantomShare share_;
  Census census_;
  NeighborCounter neighbors_;
  SuspectReturns suspects_;
  std::vector<std::uint32_t> open_;  // suspects that are still to be looked at
  SurroundingCubes cubes_;
};

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params);

}  // namespace perception
