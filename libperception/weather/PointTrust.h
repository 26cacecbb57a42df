#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libperception/weather/PointFilter.h"
#include "libperception/weather/RangeImage.h"
#include "libperception/weather/SurroundingCubes.h"
#include "libperception/weather/TrustParams.h"

namespace perception {

/// A curve through knots, read from a table: a division and a look-up per return.
class TrustCurve {
 public:
  TrustCurve() = default;
  TrustCurve(const std::vector<double>& knots, const std::vector<double>& values);
  float at(float v) const {
    const float place = (v - low_) * per_unit_ + 0.5F;
    const int index = place > 0 ? static_cast<int>(place) : 0;
    return table_[static_cast<std::size_t>(index < kLast ? index : kLast)];
  }

 private:
  static constexpr int kLast = 511;
  float low_ = 0, per_unit_ = 1;
  std::array<float, kLast + 1> table_{};
};

/// A return that may be a phantom, and how it looks.
struct SuspectReturn {
  std::uint32_t index = 0;                       ///< in the cloud
  std::array<float, kTrustFeatures> features{};  ///< [m], counts or shares, as TrustFeature
  float geometry = 0;   ///< [log-odds] of the first pass, without intensity and weather
  float intensity = 0;  ///< [log-odds] learnt of its intensity
  float sensor = 0;     ///< [log-odds] of the sensor's own verdict and of its echoes
  float first = 0;      ///< [log-odds] of the first pass
  float second = 0;     ///< [log-odds] of the second pass
};

/// What intensities phantoms and surfaces have, learnt from scan to scan from what the geometry
/// says: instruments scale them as they like, and some snow is dark and some is bright.
class IntensityLaw {
 public:
  static constexpr std::size_t kBins = 9;
  static std::size_t binOf(float intensity);  ///< [0, 1]: zero, then octaves of 1/255
  void forget(double share);                  ///< [-] of what is known that stays
  void add(float intensity, double phantom, double returns);
  /// [log-odds] per bin; 0 where nothing is known.
  std::array<float, kBins> logRatios() const;

 private:
  std::array<double, kBins> phantoms_{}, surfaces_{};  // [returns]
};

/// P(phantom) of every return from how it stands among its neighbours in the range image, its
/// height above the ground, its intensity, the sensor's label and echoes. Two passes: in the second
/// counts what the first made of the returns nearby, so that a dark car keeps its dark returns. The
/// share of phantoms follows the weather (Saerens et al., Neural Computation 2002), so that nothing
/// is doubted in clear air.
class PointTrust final : public PointFilter {
 public:
  explicit PointTrust(const TrustParams& params);

  TrustStats apply(SensorFrame& frame) override;

  /// Of the last scan, for studies and fits.
  const std::vector<SuspectReturn>& suspects() const { return suspects_; }
  double share() const { return share_; }
  std::array<float, IntensityLaw::kBins> intensityLogRatios() const { return law_.logRatios(); }
  double rowPitch() const { return image_.rowPitch(); }  ///< [rad]
  std::size_t memoryBytes() const;

 private:
  void findSuspects(const SensorFrame& frame, const LidarCloud& cloud);
  void lookAround(std::size_t pixel, SuspectReturn& suspect) const;
  void hearSensor(const LidarCloud& cloud);
  void followWeather();
  void learnIntensity(const LidarCloud& cloud);
  void askCompany(const LidarCloud& cloud);
  void countCompany(const LidarCloud& cloud);
  double weatherLogOdds() const;

  TrustParams params_;
  std::array<TrustCurve, kTrustFeatures> curves_;
  RangeImage image_;
  IntensityLaw law_;
  double share_;  // [-] of phantoms within share_range
  bool started_ = false;
  std::vector<SuspectReturn> suspects_;
  SurroundingCubes cubes_;
};

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params);

}  // namespace perception
