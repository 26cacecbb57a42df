#pragma once
#include <cmath>
#include <cstddef>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// The first of two echoes of a pulse is rain when it is weaker or shorter. For clouds with echoes.
inline bool isRainEcho(const LidarCloud& c, std::size_t i) {
  if (i + 1 >= c.size() || c.echo[i] != 0 || c.echo[i + 1] != 1) return false;
  const float dot = c.x[i] * c.x[i + 1] + c.y[i] * c.y[i + 1] + c.z[i] * c.z[i + 1];
  const float a = c.x[i] * c.x[i] + c.y[i] * c.y[i] + c.z[i] * c.z[i];
  const float b = c.x[i + 1] * c.x[i + 1] + c.y[i + 1] * c.y[i + 1] + c.z[i + 1] * c.z[i + 1];
  if (!(a < b) || !(dot * std::abs(dot) > 0.99999F * a * b)) return false;  // of different pulses
  const bool weaker = !c.intensity.empty() && c.intensity[i] < c.intensity[i + 1];
  const bool shorter = !c.pulse_width.empty() && c.pulse_width[i] < c.pulse_width[i + 1];
  return weaker || shorter;
}

/// What the sensor itself says of a return [log-odds of a phantom]: TrustParams::sensor_label where
/// it is labeled as rain or dirt, else 0.
inline float labelOdds(const LidarCloud& cloud, std::size_t i, const TrustParams& params) {
  if (cloud.label.empty()) return 0;
  const auto label = static_cast<PointLabel>(cloud.label[i]);
  const bool phantom = label == PointLabel::kRain || label == PointLabel::kDirt;
  return phantom ? static_cast<float>(params.sensor_label) : 0;
}

/// TrustParams::rain_rule [log-odds of a phantom] where isRainEcho(), else 0.
inline float echoOdds(const LidarCloud& cloud, std::size_t i, const TrustParams& params) {
  if (cloud.echo.empty() || !isRainEcho(cloud, i)) return 0;
  return static_cast<float>(params.rain_rule);
}

/// [0, 1] P(phantom) by the sensor's own verdict and echoes alone; 0 where they say nothing.
inline double instrumentDoubt(const LidarCloud& cloud, std::size_t i, const TrustParams& params) {
  const auto odds = static_cast<double>(labelOdds(cloud, i, params) + echoOdds(cloud, i, params));
  return odds > 0 ? 1 / (1 + std::exp(-odds)) : 0;
}

}  // namespace perception
