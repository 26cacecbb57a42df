#include "libperception/weather/PointTrust.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

constexpr float kPhantom = 0;  // [log-odds] decision threshold
constexpr float kLeastSecondPass =
    -5;  // [log-odds] below it the second pass cannot change the decision
constexpr std::size_t kIntensityStep = 4;  // every fourth return is a sufficient sample
constexpr float kCertainOdds = 8;          // [log-odds]

float sigmoid(float v) { return 1 / (1 + std::exp(-v)); }

PERCEPTION_WIDEST void markFrom(float least, const float* __restrict odds, std::size_t count,
                                std::int32_t* __restrict marks) {
  for (std::size_t s = 0; s < count; ++s) marks[s] = odds[s] >= least;
}

/// Indices of log-odds not below `least`; returns how many they are.
std::size_t findOpen(float least, const float* odds, std::size_t count, std::uint32_t* open) {
  constexpr std::size_t kBlock = 1024;
  std::array<std::int32_t, kBlock> marks;
  std::size_t found = 0;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t size = std::min(kBlock, count - first);
    markFrom(least, odds + first, size, marks.data());
    found += packPlaces(marks.data(), size, static_cast<std::uint32_t>(first), open + found);
  }
  return found;
}

/// Number of ranges [m] up to `far`; 0 is no range.
PERCEPTION_WIDEST int countWithin(const float* ranges, std::size_t count, float far) {
  int within = 0;
  for (std::size_t i = 0; i < count; ++i) within += (ranges[i] > 0) & (ranges[i] <= far);
  return within;
}

/// The first of two echoes of a pulse is rain when it is weaker or shorter.
bool isRainEcho(const LidarCloud& c, std::size_t i) {
  if (i + 1 >= c.size() || c.echo[i] != 0 || c.echo[i + 1] != 1) return false;
  const float dot = c.x[i] * c.x[i + 1] + c.y[i] * c.y[i + 1] + c.z[i] * c.z[i + 1];
  const float a = c.x[i] * c.x[i] + c.y[i] * c.y[i] + c.z[i] * c.z[i];
  const float b = c.x[i + 1] * c.x[i + 1] + c.y[i + 1] * c.y[i + 1] + c.z[i + 1] * c.z[i + 1];
  if (!(a < b) || !(dot * std::abs(dot) > 0.99999F * a * b)) return false;  // of different pulses
  const bool weaker = !c.intensity.empty() && c.intensity[i] < c.intensity[i + 1];
  const bool shorter = !c.pulse_width.empty() && c.pulse_width[i] < c.pulse_width[i + 1];
  return weaker || shorter;
}

}  // namespace

CountCurves::CountCurves(const TrustCurve& of_tight, const TrustCurve& of_wide,
                         const TrustCurve& of_beyond) {
  constexpr std::uint32_t kMost = NeighborCounts::kMost;
  for (std::uint32_t n = 0; n < kMost; ++n) {
    tight[n] = of_tight.at(static_cast<float>(n)), wide[n] = of_wide.at(static_cast<float>(n));
    for (std::uint32_t part = 0; part < kMost; ++part)
      beyond[n * kMost + part] =
          of_beyond.at(n > 0 ? static_cast<float>(part) / static_cast<float>(n) : 1.0F);
  }
}

namespace {

/// Log-odds of some suspects by geometry; `near` and `high`: indices into the curves of range and
/// height.
PERCEPTION_WIDER void weigh(const std::uint32_t* __restrict neighbors,
                            const std::int32_t* __restrict near,
                            const std::int32_t* __restrict high, std::size_t count, float bias,
                            const float* __restrict of_range, const float* __restrict of_height,
                            const float* __restrict tight, const float* __restrict wide,
                            const float* __restrict beyond, float* __restrict odds) {
  constexpr std::uint32_t kMost = NeighborCounts::kMost;
  constexpr int kBits = NeighborCounts::kBits;
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t bits = neighbors[s];
    const auto n = static_cast<std::int32_t>(bits % kMost);
    const auto w = static_cast<std::int32_t>(bits >> kBits & (kMost - 1));
    const auto b = static_cast<std::int32_t>(bits >> 2 * kBits & (kMost * kMost - 1));
    odds[s] = bias + of_range[near[s]] + tight[n] + wide[w] + beyond[b] + of_height[high[s]];
  }
}

/// First pass: geometry plus intensity. Initializes the second pass with it.
PERCEPTION_WIDER void addIntensity(const float* __restrict geometry,
                                   const std::uint32_t* __restrict cube, std::size_t count,
                                   const float* __restrict ratios, float* __restrict first,
                                   float* __restrict second) {
  for (std::size_t s = 0; s < count; ++s) {
    const auto bin = static_cast<std::int32_t>(cube[s] >> SuspectReturns::kBinShift);
    first[s] = second[s] = geometry[s] + ratios[bin];
  }
}

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
      share_(params),
      cubes_(static_cast<float>(params.max_range)) {}

// Enters all returns into the range image and the near ones into their cubes, as trusted.
void PointTrust::placeReturns(const SensorFrame& frame, const LidarCloud& cloud) {
  uses_intensity_ = params_.use_intensity && cloud.intensity.size() == cloud.size();
  cubes_.clear();
  census_ = {};
  suspects_.count = 0;
  const HeightAboveGround height(frame.T_ego_sensor, frame.ground);
  const auto far = static_cast<float>(params_.max_range);
  std::array<std::uint32_t, RangeImage::kBlock> bins{};
  image_.fill(cloud, [&](const RangeImage::Block& block) {
    if (uses_intensity_)
      IntensityLaw::findBins(&cloud.intensity[block.first], block.count, bins.data());
    count(block, bins.data());
    suspects_.add(cloud, block, bins.data(), height, far, cubes_);
  });
}

void PointTrust::count(const RangeImage::Block& block, const std::uint32_t* bins) {
  const auto far = static_cast<float>(params_.max_range);
  for (std::size_t k = 0; k < block.count; k += kIntensityStep)
    census_.returns[bins[k]] += (block.ranges[k] > 0) & (block.ranges[k] <= far);
  census_.within_share_range +=
      countWithin(block.ranges, block.count, static_cast<float>(params_.share_range));
}

NeighborRules PointTrust::neighborRules() const {
  return {static_cast<float>(params_.max_range), static_cast<float>(params_.tight),
          static_cast<float>(params_.wide), static_cast<float>(params_.beyond),
          params_.surface_neighbors};
}

// First pass: removes certain surfaces and weighs the geometry of the remaining suspects.
void PointTrust::countNeighbors() {
  suspects_.makeRoomForResults();
  neighbors_.count(image_, neighborRules(), suspects_);
  suspects_.clearSurfaces(static_cast<std::uint32_t>(params_.surface_neighbors));
  open_.resize(suspects_.index.size());
  constexpr std::size_t kBlock = RangeImage::kBlock;
  const TrustCurve &of_range = curve(TrustFeature::kRange),
                   &of_height = curve(TrustFeature::kHeight);
  std::array<std::int32_t, kBlock> near, high;
  for (std::size_t s = 0; s < suspects_.count; s += kBlock) {
    const std::size_t count = std::min(kBlock, suspects_.count - s);
    of_range.findPlaces(&suspects_.range[s], count, near.data());
    of_height.findPlaces(&suspects_.height[s], count, high.data());
    weigh(&suspects_.neighbors[s], near.data(), high.data(), count,
          static_cast<float>(params_.bias), of_range.table(), of_height.table(),
          count_curves_.tight.data(), count_curves_.wide.data(), count_curves_.beyond.data(),
          &suspects_.geometry[s]);
  }
}

void PointTrust::applySensorLabels(const LidarCloud& cloud) {
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

// Learns the intensities of phantoms and surfaces from the geometric log-odds.
void PointTrust::learnIntensity() {
  std::array<double, IntensityLaw::kBins> phantoms{};
  const auto weather = static_cast<float>(share_.logOdds()), least = -kCertainOdds - weather;
  const std::size_t open =
      findOpen(least, suspects_.geometry.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    if (suspects_.index[s] % kIntensityStep == 0)
      phantoms[suspects_.binOf(s)] += static_cast<double>(sigmoid(suspects_.geometry[s] + weather));
  }
  law_.forget(1 - 1 / params_.intensity_memory);
  for (std::size_t b = 0; b < IntensityLaw::kBins; ++b)
    law_.add(b, kIntensityStep * phantoms[b], kIntensityStep * (census_.returns[b] - phantoms[b]));
}

// Completes the first pass with the intensity.
void PointTrust::weighIntensity() {
  std::array<float, IntensityLaw::kBins> ratios{};
  if (uses_intensity_) {
    learnIntensity();
    ratios = law_.logRatios();
    for (float& ratio : ratios) ratio *= static_cast<float>(params_.intensity_gain);
  }
  addIntensity(suspects_.geometry.data(), suspects_.cube.data(), suspects_.count, ratios.data(),
               suspects_.first.data(), suspects_.second.data());
}

// Second pass: adds the first pass's result for the returns within half a meter.
void PointTrust::applyNeighborhood() {
  const std::size_t open =
      findOpen(kLeastSecondPass, suspects_.first.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    if (suspects_.first[s] > kPhantom) cubes_.doubt(suspects_.cubeOf(s));
  }
  const auto own = static_cast<float>(params_.gain);
  const auto bias = static_cast<float>(params_.second_bias);
  const TrustCurve& of_surroundings = curve(TrustFeature::kSurroundings);
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    const float first = suspects_.first[s];
    const float surroundings = cubes_.surroundings(suspects_.corner[s], first > kPhantom);
    suspects_.surroundings[s] = surroundings;
    suspects_.second[s] = own * first + bias + of_surroundings.at(surroundings);
  }
}

void PointTrust::writeTrust(LidarCloud& cloud, TrustStats& stats) {
  cloud.trust.assign(cloud.size(), 1);
  const auto weather = static_cast<float>(share_.logOdds());
  const std::size_t open =
      findOpen(-kCertainOdds - weather, suspects_.second.data(), suspects_.count, open_.data());
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
  placeReturns(frame, *cloud);
  countNeighbors();
  applySensorLabels(*cloud);
  weighIntensity();
  applyNeighborhood();
  share_.follow(suspects_, census_.within_share_range);
  stats.returns = cloud->size();
  stats.share = share_.value();
  writeTrust(*cloud, stats);
  return stats;
}

AirCensus PointTrust::census(const SensorFrame& frame) const {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  return cloud != nullptr ? AirCensus::of(frame, *cloud, suspects_) : AirCensus();
}

std::vector<SuspectReturn> PointTrust::suspects() const {
  std::vector<SuspectReturn> all;
  all.reserve(suspects_.count);
  for (std::size_t s = 0; s < suspects_.count; ++s) all.push_back(suspects_.at(s));
  return all;
}

std::size_t PointTrust::memoryBytes() const {
  return image_.memoryBytes() + neighbors_.memoryBytes() + suspects_.memoryBytes() +
         cubes_.memoryBytes();
}

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params) {
  return std::make_unique<PointTrust>(params);
}

}  // namespace perception
