#include "libperception/weather/trust/PointTrust.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Compress.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/weather/SensorVerdict.h"

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
  for (std::size_t s = 0; s < suspects_.count; ++s) {
    const std::size_t i = suspects_.index[s];
    suspects_.geometry[s] += labelOdds(cloud, i, params_);
    suspects_.geometry[s] += echoOdds(cloud, i, params_);
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
  intensity_odds_ = {};
  if (uses_intensity_) {
    learnIntensity();
    intensity_odds_ = law_.logRatios();
    for (float& odds : intensity_odds_) odds *= static_cast<float>(params_.intensity_gain);
  }
  addIntensity(suspects_.geometry.data(), suspects_.cube.data(), suspects_.count,
               intensity_odds_.data(), suspects_.first.data(), suspects_.second.data());
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
  doubted_.clear();
  const auto weather = static_cast<float>(share_.logOdds());
  const float nothing_near = curve(TrustFeature::kSurroundings).at(0);
  const std::size_t open =
      findOpen(-kCertainOdds - weather, suspects_.second.data(), suspects_.count, open_.data());
  for (std::size_t k = 0; k < open; ++k) {
    const std::uint32_t s = open_[k];
    const float odds = suspects_.second[s] + weather, trust = sigmoid(-odds);
    cloud.trust[suspects_.index[s]] = trust;
    stats.weight_lost += static_cast<double>(1 - trust);
    if (!(odds > kPhantom)) continue;
    const Doubt doubt = oddsParts(cloud, s, odds, nothing_near).largest();
    doubted_.emplace_back(suspects_.index[s], doubt);
    stats.doubts.add(doubt);
  }
  stats.phantoms += doubted_.size();
}

// Parts beside that of a return without label, echo, intensity and anything within half a meter.
OddsParts PointTrust::oddsParts(const LidarCloud& cloud, std::size_t s, float odds,
                                float nothing_near) const {
  const auto own = static_cast<float>(params_.gain);
  const std::size_t i = suspects_.index[s];
  OddsParts parts;
  parts[DoubtCause::kIntensity] = own * intensity_odds_[suspects_.binOf(s)];
  parts[DoubtCause::kSensorLabel] = own * labelOdds(cloud, i, params_);
  parts[DoubtCause::kEcho] = own * echoOdds(cloud, i, params_);
  parts[DoubtCause::kAmongPhantoms] =
      curve(TrustFeature::kSurroundings).at(suspects_.surroundings[s]) - nothing_near;
  for (const float part : parts.of) odds -= part;
  parts[DoubtCause::kIsolated] = odds;
  return parts;
}

std::optional<Doubt> PointTrust::doubtAbout(std::uint32_t i) const {
  const auto found = std::lower_bound(doubted_.begin(), doubted_.end(), i,
                                      [](const auto& d, std::uint32_t at) { return d.first < at; });
  if (found == doubted_.end() || found->first != i) return std::nullopt;
  return found->second;
}

TrustStats PointTrust::apply(SensorFrame& frame) {
  TrustStats stats;
  auto* cloud = std::get_if<LidarCloud>(&frame.data);
  doubted_.clear();
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
