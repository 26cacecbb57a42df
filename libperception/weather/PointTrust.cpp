#include "libperception/weather/PointTrust.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Lanes.h"
#include "libperception/core/Wider.h"
#include "libperception/weather/HeightAboveGround.h"

namespace perception {
namespace {

constexpr float kTightFloor = 0.03F;        // [m] noise of a range
constexpr float kBeyondFloor = 0.3F;        // [m]
constexpr float kPhantom = 0;               // [log-odds] above it a verdict is "phantom"
constexpr float kSettled = -5;              // [log-odds] below it no neighbour can make a phantom
constexpr double kIntensityPrior = 50;      // [returns] that a bin's ratio must stand against
constexpr std::size_t kIntensityStep = 4;   // every fourth return tells as much
constexpr float kBeyondDoubt = 8;           // [log-odds]
constexpr float kIntensityBound = 4;        // [log-odds]
constexpr double kFewestPhantoms = 20;      // [returns] below it no intensity is learnt
constexpr double kShareBounds[] = {-7, 2};  // [log-odds] that weather may add

float sigmoid(float v) { return 1 / (1 + std::exp(-v)); }
double logit(double p) { return std::log(p / (1 - p)); }

constexpr std::size_t at(TrustFeature feature) { return static_cast<std::size_t>(feature); }

/// How many of the eight nearest pixels are within `tight` of `r`: rows of three and a fourth
/// beside them that does not count.
int sameAround(const float* pixel, std::ptrdiff_t stride, float r, float tight) {
  using Float4 = float __attribute__((vector_size(16)));
  using Int4 = std::int32_t __attribute__((vector_size(16)));
  const auto same = [&](const float* row) -> Int4 {
    Float4 off;
    std::memcpy(&off, row - 1, sizeof off);
    off -= r;
    return (off < tight) & (-off < tight);
  };
  const Int4 counts =
      same(pixel - stride) + same(pixel + stride) + (same(pixel) & Int4{-1, 0, -1, 0});
  return -(counts[0] + counts[1] + counts[2]);
}

/// How the beams around a return fare, counted.
struct Neighbours {
  int tight = 0, wide = 0, beyond = 0, filled = 0;
};

/// `corner`: first pixel of the neighbourhood. Rows of eight and a ninth column apart.
PERCEPTION_WIDER Neighbours countNeighbours(const float* corner, std::ptrdiff_t stride, float r,
                                            float tight, float wide, float behind) {
  static_assert(RangeImage::kColumnReach == 4 && RangeImage::kRowReach == 2, "nine by five");
  Int8 near = eight(0), neighbours = eight(0), beyond = eight(0), filled = eight(0);
  const auto count = [&](const Float8& other) {  // downwards: true is -1
    const Float8 off = magnitude(other - r);
    near += off<tight, neighbours += off<wide, beyond += other> behind, filled += other> 0;
  };
  Float8 ninth = eight(0.0F);
  for (int row = 0; row < 5; ++row, corner += stride) {
    Float8 line = load8(corner);
    if (row == 2) line[RangeImage::kColumnReach] = 0;  // the return itself
    count(line);
    ninth[row] = corner[kLanes];
  }
  count(ninth);
  // None exceeds 45: four of them fit a number.
  std::int32_t lanes[kLanes], all = 0;
  store8(near + (neighbours << 8) + (beyond << 16) + (filled << 24), lanes);
  for (const std::int32_t lane : lanes) all -= lane;
  return {all & 255, all >> 8 & 255, all >> 16 & 255, all >> 24 & 255};
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

TrustCurve::TrustCurve(const std::vector<double>& knots, const std::vector<double>& values) {
  low_ = static_cast<float>(knots.front());
  per_unit_ = static_cast<float>(kLast / (knots.back() - knots.front()));
  std::size_t k = 0;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double v =
        knots.front() + static_cast<double>(i) * (knots.back() - knots.front()) / kLast;
    while (k + 2 < knots.size() && v > knots[k + 1]) ++k;
    const double share = std::clamp((v - knots[k]) / (knots[k + 1] - knots[k]), 0.0, 1.0);
    table_[i] = static_cast<float>(values[k] + share * (values[k + 1] - values[k]));
  }
}

std::size_t IntensityLaw::binOf(float intensity) {
  if (!(intensity > 0)) return 0;
  static const std::array<std::uint8_t, 256> kBinOfByte = [] {
    std::array<std::uint8_t, 256> bins{};
    for (std::size_t byte = 1; byte < bins.size(); ++byte)
      for (std::size_t rest = byte; rest > 0 && bins[byte] + 1U < kBins; rest /= 2) ++bins[byte];
    return bins;
  }();
  return kBinOfByte[static_cast<std::size_t>(std::clamp(intensity * 255 + 0.5F, 0.0F, 255.0F))];
}

void IntensityLaw::forget(double share) {
  for (auto* counts : {&phantoms_, &surfaces_})
    for (double& count : *counts) count *= share;
}

void IntensityLaw::add(float intensity, double phantom, double returns) {
  const std::size_t bin = binOf(intensity);
  phantoms_[bin] += phantom * returns;
  surfaces_[bin] += (1 - phantom) * returns;
}

std::array<float, IntensityLaw::kBins> IntensityLaw::logRatios() const {
  std::array<float, kBins> ratios{};
  double phantoms = 0, surfaces = 0;
  for (std::size_t b = 0; b < kBins; ++b) phantoms += phantoms_[b], surfaces += surfaces_[b];
  if (phantoms < kFewestPhantoms || surfaces < kFewestPhantoms) return ratios;
  for (std::size_t b = 0; b < kBins; ++b) {
    const double pooled = 0.5 * (phantoms_[b] / phantoms + surfaces_[b] / surfaces);
    const double p = (phantoms_[b] + kIntensityPrior * pooled) / (phantoms + kIntensityPrior);
    const double s = (surfaces_[b] + kIntensityPrior * pooled) / (surfaces + kIntensityPrior);
    if (p > 0 && s > 0)
      ratios[b] =
          std::clamp(static_cast<float>(std::log(p / s)), -kIntensityBound, kIntensityBound);
  }
  return ratios;
}

PointTrust::PointTrust(const TrustParams& params)
    : params_(params),
      image_(params.column, params.row),
      share_(params.fitted_share),
      cubes_(static_cast<float>(params.max_range)) {
  for (std::size_t f = 0; f < kTrustFeatures; ++f)
    curves_[f] = TrustCurve(TrustParams::knotsOf(static_cast<TrustFeature>(f)), params.curves[f]);
}

// How the beams around a return fare.
void PointTrust::lookAround(std::size_t pixel, SuspectReturn& suspect) const {
  const float r = suspect.features[at(TrustFeature::kRange)];
  const float* corner = image_.pixels().data() + pixel - RangeImage::kRowReach * image_.stride() -
                        RangeImage::kColumnReach;
  const Neighbours n = countNeighbours(corner, image_.stride(), r,
                                       static_cast<float>(params_.tight) * r + kTightFloor,
                                       static_cast<float>(params_.wide) * r + kTightFloor,
                                       (1 + static_cast<float>(params_.beyond)) * r + kBeyondFloor);
  suspect.features[at(TrustFeature::kTight)] = static_cast<float>(n.tight);
  suspect.features[at(TrustFeature::kWide)] = static_cast<float>(n.wide);
  suspect.features[at(TrustFeature::kBeyond)] =
      n.filled > 0 ? static_cast<float>(n.beyond) / static_cast<float>(n.filled) : 1.0F;
}

void PointTrust::findSuspects(const SensorFrame& frame, const LidarCloud& cloud) {
  suspects_.clear();
  const HeightAboveGround height(frame.T_ego_sensor, frame.ground);
  const auto far = static_cast<float>(params_.max_range);
  const float* image = image_.pixels().data();
  const std::ptrdiff_t stride = image_.stride();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float r = image_.ranges()[i];
    if (!(r > 0) || r > far) continue;
    const std::size_t pixel = image_.pixelOf(i);
    const float tight = static_cast<float>(params_.tight) * r + kTightFloor;
    const int around = sameAround(image + pixel, stride, r, tight);
    if (around >= params_.surface_neighbours) continue;
    SuspectReturn& suspect =
        suspects_.emplace_back();  // in place: a copy would wait for the stores
    suspect.index = static_cast<std::uint32_t>(i);
    suspect.features[at(TrustFeature::kRange)] = r;
    suspect.features[at(TrustFeature::kHeight)] = height.of(cloud.x[i], cloud.y[i], cloud.z[i]);
    lookAround(pixel, suspect);
    float sum = static_cast<float>(params_.bias);
    for (const TrustFeature f : {TrustFeature::kRange, TrustFeature::kTight, TrustFeature::kWide,
                                 TrustFeature::kBeyond, TrustFeature::kHeight})
      sum += curves_[at(f)].at(suspect.features[at(f)]);
    suspect.geometry = sum;
  }
}

void PointTrust::hearSensor(const LidarCloud& cloud) {
  if (cloud.label.empty() && cloud.echo.empty()) return;
  const auto rain = static_cast<std::uint8_t>(PointLabel::kRain);
  const auto dirt = static_cast<std::uint8_t>(PointLabel::kDirt);
  for (SuspectReturn& suspect : suspects_) {
    const std::size_t i = suspect.index;
    if (!cloud.label.empty() && (cloud.label[i] == rain || cloud.label[i] == dirt))
      suspect.sensor += static_cast<float>(params_.sensor_label);
    if (!cloud.echo.empty() && isRainEcho(cloud, i))
      suspect.sensor += static_cast<float>(params_.rain_rule);
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
  constexpr double kWidth = 0.25;  // [log-odds]
  std::array<double, kBins> counts{};
  const auto reach = static_cast<float>(params_.share_range);
  int near = 0;
  for (const float r : image_.ranges())
    near += static_cast<int>(r > 0) & static_cast<int>(r <= reach);
  if (near == 0) return;
  for (const SuspectReturn& s : suspects_) {
    if (s.features[at(TrustFeature::kRange)] > reach) continue;
    const double place = static_cast<double>(s.second) / kWidth + kBins / 2.0;
    counts[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))] += 1;
  }
  double share = started_ ? share_ : params_.fitted_share;
  for (int step = 0; step < 30; ++step) {
    const double shift = logit(share) - logit(params_.fitted_share);
    double phantoms = 0;
    for (int b = 0; b < kBins; ++b)
      phantoms += counts[static_cast<std::size_t>(b)] /
                  (1 + std::exp(-((b + 0.5 - kBins / 2.0) * kWidth + shift)));
    share = std::clamp(phantoms / near, params_.least_share, 0.9);
  }
  const double weight = started_ ? 1 / params_.share_memory : 1;
  share_ += weight * (share - share_);
  started_ = true;
}

void PointTrust::learnIntensity(const LidarCloud& cloud) {
  if (!params_.use_intensity || cloud.intensity.empty()) return;
  law_.forget(1 - 1 / params_.intensity_memory);
  const auto weather = static_cast<float>(weatherLogOdds());
  const auto far = static_cast<float>(params_.max_range);
  std::size_t next = 0;
  for (std::size_t i = 0; i < cloud.size(); i += kIntensityStep) {
    while (next < suspects_.size() && suspects_[next].index < i) ++next;
    const float r = image_.ranges()[i];
    if (!(r > 0) || r > far) continue;
    const bool suspected = next < suspects_.size() && suspects_[next].index == i;
    const float odds =
        suspected ? suspects_[next].geometry + suspects_[next].sensor + weather : -kBeyondDoubt;
    law_.add(cloud.intensity[i], odds > -kBeyondDoubt ? static_cast<double>(sigmoid(odds)) : 0,
             kIntensityStep);
  }
  const auto ratios = law_.logRatios();
  for (SuspectReturn& s : suspects_)
    s.intensity = ratios[IntensityLaw::binOf(cloud.intensity[s.index])];
}

void PointTrust::countCompany(const LidarCloud& cloud) {
  cubes_.clear();
  cubes_.place(cloud.x, cloud.y, cloud.z);
  std::size_t next = 0;
  const auto far = static_cast<float>(params_.max_range);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool suspected = next < suspects_.size() && suspects_[next].index == i;
    const bool doubted = suspected && suspects_[next].first > kPhantom;
    next += suspected;
    const float r = image_.ranges()[i];
    if (r > 0 && r <= far) cubes_.add(i, doubted);
  }
}

// The second pass: what did the first make of the neighbours and of what else is within half a
// metre?
void PointTrust::askCompany(const LidarCloud& cloud) {
  const auto gain = static_cast<float>(params_.intensity_gain);
  for (SuspectReturn& s : suspects_) s.first = s.geometry + s.sensor + gain * s.intensity;
  countCompany(cloud);
  const auto own = static_cast<float>(params_.gain);
  const auto bias = static_cast<float>(params_.second_bias);
  for (SuspectReturn& s : suspects_) {
    s.second = s.first;
    if (s.first < kSettled) continue;
    const std::size_t i = s.index;
    float& company = s.features[at(TrustFeature::kCompany)];
    company = cubes_.company(cloud.x[i], cloud.y[i], cloud.z[i], s.first > kPhantom);
    s.second = own * s.first + bias + curves_[at(TrustFeature::kCompany)].at(company);
  }
}

TrustStats PointTrust::apply(SensorFrame& frame) {
  TrustStats stats;
  auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return stats;
  image_.fill(*cloud);
  findSuspects(frame, *cloud);
  hearSensor(*cloud);
  learnIntensity(*cloud);
  askCompany(*cloud);
  followWeather();

  stats.returns = cloud->size();
  stats.share = share_;
  cloud->trust.assign(cloud->size(), 1);
  const auto weather = static_cast<float>(weatherLogOdds());
  for (const SuspectReturn& s : suspects_) {
    const float odds = s.second + weather;
    if (odds < -kBeyondDoubt) continue;
    cloud->trust[s.index] = sigmoid(-odds);
    stats.phantoms += odds > kPhantom;
  }
  return stats;
}

std::size_t PointTrust::memoryBytes() const {
  return image_.memoryBytes() + sizeof(SuspectReturn) * suspects_.capacity() + cubes_.memoryBytes();
}

std::unique_ptr<PointFilter> makePointTrust(const TrustParams& params) {
  return std::make_unique<PointTrust>(params);
}

}  // namespace perception
