#include "libperception/weather/PointTrust.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Wider.h"
#include "libperception/weather/HeightAboveGround.h"

namespace perception {
namespace {

constexpr float kPhantom = 0;               // [log-odds] above it a verdict is "phantom"
constexpr float kSettled = -5;              // [log-odds] below it no neighbour can make a phantom
constexpr std::size_t kIntensityStep = 4;   // every fourth return tells as much
constexpr float kBeyondDoubt = 8;           // [log-odds]
constexpr double kShareBounds[] = {-7, 2};  // [log-odds] that weather may add

float sigmoid(float v) { return 1 / (1 + std::exp(-v)); }
double logit(double p) { return std::log(p / (1 - p)); }

/// The places of odds not below `least`: their number.
std::size_t findOpen(float least, const float* odds, std::size_t count, std::uint32_t* open) {
  std::size_t found = 0;
  for (std::size_t s = 0; s < count; ++s) {  // what is below is overwritten by the next
    open[found] = static_cast<std::uint32_t>(s);
    found += odds[s] >= least;
  }
  return found;
}

/// Of ranges [m], how many are no farther than that; 0 is none.
PERCEPTION_WIDER int countWithin(const float* ranges, std::size_t count, float far) {
  int within = 0;
  for (std::size_t i = 0; i < count; ++i) within += (ranges[i] > 0) & (ranges[i] <= far);
  return within;
}

/// The first of two echoes of a pulse is rain when it is weaker or shorter (paper).
bool isRainEcho(const LidarCloud& c, std::size_t i) {
  if (i + 1 >= c.size() || c.echo[i] != 0 || c.echo[i + 1] != 1) return false;
  const float dot = c.x[i] * c.x[i + 1] + c.y[i] * c.y[i + 1] + c.z[i] * c.z[i + 1];
  const float a = c.x[i] * c.x[i] + c.y[i] * c.y[i] + c.z[i] * c.z[i];
  const float b = c.x[i + 1] * c.x[i + 1] + c.y[i + 1] * c.y[i + 1] + c.z[i + 1] * c.z[i + 1];
  if (!(a < b) || !(dot * std::abs(dot) > 0.99999F * a * b)) return false;  // another direction
  const bool weaker = !c.intensity.empty() && c.intensity[i] < c.intensity[i + 1];
  const bool shorter = !c.pulse_width.empty() && c.pulse_width[i] < c.pulse_width[i + 1];
  return weaker || shorter;
}

}  // namespace

CountCurves::CountCurves(const TrustCurve& of_tight, const TrustCurve& of_wide,
                         const TrustCurve& of_beyond) {
  constexpr std::uint32_t kMost = NeighbourCounts::kMost;
  for (std::uint32_t n = 0; n < kMost; ++n) {
    tight[n] = of_tight.at(static_cast<float>(n)), wide[n] = of_wide.at(static_cast<float>(n));
    for (std::uint32_t part = 0; part < kMost; ++part)
      beyond[n * kMost + part] =
          of_beyond.at(n > 0 ? static_cast<float>(part) / static_cast<float>(n) : 1.0F);
  }
}

namespace {

std::array<TrustCurve, kTrustFeatures> curvesOf(const TrustParams& params) {
  std::array<TrustCurve, kTrustFeatures> curves;
  for (std::size_t f = 0; f < kTrustFeatures; ++f)
    curves[f] = TrustCurve(TrustParams::knotsOf(static_cast<TrustFeature>(f)), params.curves[f]);
  return curves;
}

}  // namespace

PointTrust::PointTrust(const TrustParams& params)
    : params_(params),
      curves_(curvesOf(params)),
      count_curves_(curve(TrustFeature::kTight), curve(TrustFeature::kWide),
                    curve(TrustFeature::kBeyond)),
      image_(params.column, params.row),
      share_(params.fitted_share),
      cubes_(static_cast<float>(params.max_range)) {}

// Every return into the image and into its cube, all of them trusted as yet.
void PointTrust::placeReturns(const LidarCloud& cloud) {
  cubes_.clear();
  const auto far = static_cast<float>(params_.max_range);
  image_.fill(cloud, [&](std::size_t first, std::size_t count) {
    cubes_.add(&cloud.x[first], &cloud.y[first], &cloud.z[first], &image_.ranges()[first], count,
               far);
  });
}

NeighbourRules PointTrust::neighbourRules() const {
  return {static_cast<float>(params_.max_range), static_cast<float>(params_.tight),
          static_cast<float>(params_.wide), static_cast<float>(params_.beyond),
          params_.surface_neighbours};
}

// The first pass: who is no surface for sure, and what does the geometry say of it?
void PointTrust::lookAround(const SensorFrame& frame, const LidarCloud& cloud) {
  suspects_.reserve(cloud.size());
  open_.resize(suspects_.index.size());
  suspects_.count =
      findSuspects(image_, neighbourRules(), suspects_.index.data(), suspects_.neighbours.data());
  const HeightAboveGround height(frame.T_ego_sensor, frame.ground);
  const TrustCurve &of_range = curve(TrustFeature::kRange),
                   &of_height = curve(TrustFeature::kHeight);
  const auto bias = static_cast<float>(params_.bias);
  for (std::size_t s = 0; s < suspects_.count; ++s) {
    const std::size_t i = suspects_.index[s];
    const NeighbourCounts counts = suspects_.neighbours[s];
    const float r = image_.ranges()[i], high = height.of(cloud.x[i], cloud.y[i], cloud.z[i]);
    suspects_.range[s] = r, suspects_.height[s] = high;
    suspects_.geometry[s] = bias + of_range.at(r) + count_curves_.tight[counts.tight()] +
                            count_curves_.wide[counts.wide()] +
                            count_curves_.beyond[counts.beyondAndFilled()] + of_height.at(high);
  }
}

void PointTrust::hearSensor(const LidarCloud& cloud) {
  if (cloud.label.empty() && cloud.echo.empty()) return;
  const auto rain = static_cast<std::uint8_t>(PointLabel::kRain);
  const auto dirt = static_cast<std::uint8_t>(PointLabel::kDirt);
  for (std::size_t s = 0; s < suspects_.count; ++s) {
    const std::size_t i = suspects_.index[s];
    if (!cloud.label.empty() && (cloud.label[i] == rain || cloud.label[i] == dirt))
      suspects_.geometry[s] += static_cast<float>(params_.sensor_label);
    if (!cloud.echo.empty() && isRainEcho(cloud, i))
      suspects_.geometry[s] += static_cast<float>(params_.rain_rule);
  }
}

double PointTrust::weatherLogOdds() const {
  if (!params_.adapt_share) return 0;
  const double change = logit(share_) - logit(params_.fitted_share);
  return std::clamp(params_.share_gain * change, kShareBounds[0], kShareBounds[1]);
}

// Expectation maximisation of the share of this scan's returns near the sensor: a histogram of
// log-odds does for its steps. `near`: returns within share_range, those that nobody suspects
// included.
void PointTrust::followWeather() {
  if (!params_.adapt_share) return;
  constexpr int kBins = 128;
  constexpr float kPerLogOdds = 4, kMiddle = kBins / 2;
  static const std::array<double, kBins> kSurfaceOdds = [] {  // at the middles of the bins
    std::array<double, kBins> odds{};
    for (int b = 0; b < kBins; ++b)
      odds[static_cast<std::size_t>(b)] =
          std::exp(-(b + 0.5 - static_cast<double>(kMiddle)) / static_cast<double>(kPerLogOdds));
    return odds;
  }();
  const auto reach = static_cast<float>(params_.share_range);
  const int near = countWithin(image_.ranges().data(), image_.ranges().size(), reach);
  if (near == 0) return;
  std::array<std::uint32_t, kBins> counts{};
  for (std::size_t s = 0; s < suspects_.count; ++s) {
    const float place = std::clamp(suspects_.second[s] * kPerLogOdds + kMiddle, 0.0F, kBins - 1.0F);
    counts[static_cast<std::size_t>(place)] += suspects_.range[s] <= reach;
  }
  double share = started_ ? share_ : params_.fitted_share;
  for (int step = 0; step < 30; ++step) {
    const double against = std::exp(logit(params_.fitted_share) - logit(share));
    double phantoms = 0;
    for (std::size_t b = 0; b < kBins; ++b)
      phantoms += static_cast<double>(counts[b]) / (1 + kSurfaceOdds[b] * against);
    share = std::clamp(phantoms / near, params_.least_share, 0.9);
  }
  const double weight = started_ ? 1 / params_.share_memory : 1;
  share_ += weight * (share - share_);
  started_ = true;
}

// Asks what intensities are those of phantoms, by what the geometry says of these returns.
void PointTrust::learnIntensity(const LidarCloud& cloud) {
  IntensityLaw::findBins(cloud.intensity, bins_);
  const auto far = static_cast<float>(params_.max_range);
  std::array<std::uint32_t, IntensityLaw::kBins> returns{};
  const std::vector<float>& ranges = image_.ranges();
  for (std::size_t i = 0; i < cloud.size(); i += kIntensityStep)
    returns[bins_[i]] += (ranges[i] > 0) & (ranges[i] <= far);
  std::array<double, IntensityLaw::kBins> phantoms{};
  const auto weather = static_cast<float>(weatherLogOdds());
  const std::size_t open =
      findOpen(-kBeyondDoubt - weather, suspects_.geometry.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t i = suspects_.index[open_[k]];
    if (i % kIntensityStep == 0)
      phantoms[bins_[i]] += static_cast<double>(sigmoid(suspects_.geometry[open_[k]] + weather));
  }
  law_.forget(1 - 1 / params_.intensity_memory);
  for (std::size_t b = 0; b < IntensityLaw::kBins; ++b)
    law_.add(b, kIntensityStep * phantoms[b], kIntensityStep * (returns[b] - phantoms[b]));
}

// The first pass, complete: geometry and intensity.
void PointTrust::weighIntensity(const LidarCloud& cloud) {
  const bool used = params_.use_intensity && cloud.intensity.size() == cloud.size();
  std::array<float, IntensityLaw::kBins> ratios{};
  if (used) {
    learnIntensity(cloud);
    ratios = law_.logRatios();
    for (float& ratio : ratios) ratio *= static_cast<float>(params_.intensity_gain);
  }
  for (std::size_t s = 0; s < suspects_.count; ++s) {
    const float more = used ? ratios[bins_[suspects_.index[s]]] : 0;
    suspects_.first[s] = suspects_.second[s] = suspects_.geometry[s] + more;
  }
}

// The second pass: what did the first make of the neighbours and of what else is within half a
// metre?
void PointTrust::askCompany(const LidarCloud& cloud) {
  const std::size_t open =
      findOpen(kSettled, suspects_.first.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    const std::size_t i = suspects_.index[s];
    if (suspects_.first[s] > kPhantom) cubes_.doubt(cloud.x[i], cloud.y[i], cloud.z[i]);
  }
  const auto own = static_cast<float>(params_.gain);
  const auto bias = static_cast<float>(params_.second_bias);
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    const std::size_t i = suspects_.index[s];
    const float first = suspects_.first[s];
    suspects_.company[s] = cubes_.company(cloud.x[i], cloud.y[i], cloud.z[i], first > kPhantom);
    suspects_.second[s] =
        own * first + bias + curve(TrustFeature::kCompany).at(suspects_.company[s]);
  }
}

void PointTrust::giveTrust(LidarCloud& cloud, TrustStats& stats) {
  cloud.trust.assign(cloud.size(), 1);
  const auto weather = static_cast<float>(weatherLogOdds());
  const std::size_t open =
      findOpen(-kBeyondDoubt - weather, suspects_.second.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    const float odds = suspects_.second[s] + weather;
    cloud.trust[suspects_.index[s]] = sigmoid(-odds);
    stats.phantoms += odds > kPhantom;
  }
}

TrustStats PointTrust::apply(SensorFrame& frame) {
  TrustStats stats;
  auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return stats;
  placeReturns(*cloud);
  lookAround(frame, *cloud);
  hearSensor(*cloud);
  weighIntensity(*cloud);
  askCompany(*cloud);
  followWeather();
  stats.returns = cloud->size();
  stats.share = share_;
  giveTrust(*cloud, stats);
  return stats;
}

std::vector<SuspectReturn> PointTrust::suspects() const {
  std::vector<SuspectReturn> all;
  all.reserve(suspects_.count);
  for (std::size_t s = 0; s < suspects_.count; ++s) all.push_back(suspects_.at(s));
  return all;
}

std::size_t PointTrust::memoryBytes() const {
  return image_.memoryBytes() + suspects_.memoryBytes() + bins_.capacity() + cubes_.memoryBytes();
}

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params) {
  return std::make_unique<PointTrust>(params);
}

}  // namespace perception
