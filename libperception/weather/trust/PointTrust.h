#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/weather/HeightAboveGround.h"
#include "libperception/weather/PointFilter.h"
#include "libperception/weather/trust/IntensityLaw.h"
#include "libperception/weather/trust/Neighbors.h"
#include "libperception/weather/trust/PhantomShare.h"
#include "libperception/weather/trust/RangeImage.h"
#include "libperception/weather/trust/SurroundingCubes.h"
#include "libperception/weather/trust/SuspectReturns.h"
#include "libperception/weather/trust/TrustCurve.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// The curves over counts of neighbors, tabulated by count [log-odds].
struct CountCurves {
  CountCurves(const TrustCurve& of_tight, const TrustCurve& of_wide, const TrustCurve& of_beyond);
  std::array<float, NeighborCounts::kMost> tight, wide;
  std::array<float, NeighborCounts::kMost * NeighborCounts::kMost> beyond;
};

/// P(phantom) of every return from its neighbors in the range image, height above the ground,
/// intensity, the sensor's label and echoes (method.md 9.6). The second pass uses the first pass's
/// result for nearby returns, so that dark returns of a dark car are kept. The share of phantoms
/// adapts to the weather, so that returns in clear air stay trusted.
class PointTrust final : public PointFilter {
 public:
  explicit PointTrust(const TrustParams& params);

  TrustStats apply(SensorFrame& frame) override;
  AirCensus census(const SensorFrame& frame) const override;
  std::optional<Doubt> doubtAbout(std::uint32_t i) const override;

  /// Of the last scan, for studies and fits.
  std::vector<SuspectReturn> suspects() const;
  double share() const { return share_.value(); }
  std::array<float, IntensityLaw::kBins> intensityLogRatios() const { return law_.logRatios(); }
  double rowPitch() const { return image_.rowPitch(); }  ///< [rad]
  std::size_t memoryBytes() const;

 private:
  /// Counts made while the scan is read.
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
  /// Of suspect `s` with those log-odds; `nothing_near`: those of empty surroundings.
  OddsParts oddsParts(const LidarCloud& cloud, std::size_t s, float odds, float nothing_near) const;

  const TrustCurve& curve(TrustFeature feature) const {
    return curves_[static_cast<std::size_t>(feature)];
  }

  TrustParams params_;
  std::array<TrustCurve, kTrustFeatures> curves_;
  CountCurves count_curves_;
  RangeImage image_;
  IntensityLaw law_;
  std::array<float, IntensityLaw::kBins> intensity_odds_{};  // [log-odds] of this scan, by bin
  bool uses_intensity_ = false;                              // available in this scan and enabled
  PhantomShare share_;
  Census census_;
  NeighborCounter neighbors_;
  SuspectReturns suspects_;
  std::vector<std::uint32_t> open_;  // indices of the suspects under evaluation
  SurroundingCubes cubes_;
  std::vector<std::pair<std::uint32_t, Doubt>> doubted_;  // by index in the cloud, ascending
};

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params);

}  // namespace perception
