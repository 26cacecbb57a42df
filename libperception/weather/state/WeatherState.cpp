#include "libperception/weather/state/WeatherState.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace perception {
namespace {

using Sector = AirCensus::Sector;
constexpr std::size_t kSectors = AirCensus::kSectors, kShells = AirCensus::kShellCount;

// All of these are assumed (method.md 9.10).
constexpr double kBrief = 1, kLong = 10;  // [s] memories
constexpr double kGap = 5;                // [s] after which the estimate starts anew
constexpr double kIndependent = 0.2;      // [s] between looks that tell something new
constexpr double kStay = 600;             // [s] for which weather lasts
constexpr double kPriorRest = 0.03;       // of precipitation, and of fog
constexpr double kMostEvidence = 2;       // [log-odds] of one look
constexpr double kClearAir = 4e-4;        // share of beams with a lone return near by
constexpr double kDense = 100e-4;         // the same, from which fog may be seen by itself
constexpr double kShortReach = 42;        // [m]
constexpr double kLostLevel = 0.68, kNoLevel = 0.12;  // share of level beams that return
constexpr double kFogEnds = 0.03, kFogReach = 30;     // beyond 10 m of those within; [m]
constexpr double kDropsEnd = 0.15;                    // beyond 4 m of those within: drops
constexpr double kOnlyFar = 2;                        // the same: flakes
constexpr double kSnowShare = 50e-4;  // of beams within 10 m: 50 mm/h of rain by the measured law
constexpr double kLeastSeen = 0.25;   // of the best sector's returns: the sensor looks there
constexpr double kLeastReturns = 1000;
constexpr std::size_t kOpenBin = 12;  // 24 m
/// Share of a sector's returns that stand alone in free air within 10 m, from which they are
/// likelier a cloud than plants, and the exponent of the odds by it (method.md 9.10).
constexpr double kCloud = 550e-4, kCloudExponent = 4;
constexpr double kHardlyCloud = 0.2;  // P that changes no decision
constexpr double kFew = 0.3e-4;       // share of beams that says nothing
// Rates: where the open directions are and how many beams see them.
constexpr double kOpenShare = 0.2;   // of a sector's level beams: it looks into the open
constexpr double kLeastOpen = 300;   // beams of a scan
constexpr double kFiredRank = 0.75;  // of the sectors' returns below the horizon: some are dark

double clampEvidence(double v) { return std::clamp(v, -kMostEvidence, kMostEvidence); }

double quantile(std::vector<double> values, double q) {
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  std::sort(values.begin(), values.end());
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

/// A value and what it weighs.
struct Weighed {
  double value, weight;
};

double medianOf(std::vector<Weighed> values) {
  double half = 0;
  for (const Weighed& v : values) half += v.weight / 2;
  std::sort(values.begin(), values.end(),
            [](const Weighed& a, const Weighed& b) { return a.value < b.value; });
  for (const Weighed& v : values)
    if ((half -= v.weight) <= 0) return v.value;
  return 0;
}

// How much farther away than the first 4 m returns are, which drops are not.
double fartherOf(const std::array<double, kShells>& lone) {
  return (lone[2] + kFew) / (lone[0] + lone[1] + kFew);
}

// Share of the beams with a lone return near by.
double nearOf(const std::array<double, kShells>& lone) { return lone[0] + lone[1] + lone[2] / 2; }

// [m] range within which 99 % of the returns lie.
double reachOf(const std::array<double, AirCensus::kReachBins>& bins) {
  double all = 0, sum = 0;
  for (const double n : bins) all += n;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    sum += bins[k];
    if (all > 0 && sum >= 0.99 * all) return 2 * static_cast<double>(k);
  }
  return 0;
}

// P(a cloud hangs in a sector), by its returns or, where it had more, `usual` of them.
double cloudOf(const Sector& sector, double usual) {
  double lone = 0;
  for (std::size_t k = 0; k + 1 < kShells; ++k) lone += sector.lone[k];
  const double share = lone / std::max({sector.returns, usual, 1.0});
  const double odds = std::pow(share / kCloud, kCloudExponent);
  return odds / (1 + odds);
}

}  // namespace

const char* nameOf(WeatherType type) {
  constexpr std::array<const char*, kWeatherTypes> kNames = {"clear", "rain", "snow", "fog"};
  return kNames[static_cast<std::size_t>(type)];
}

WeatherType WeatherState::type() const {
  const auto most = std::max_element(probability.begin(), probability.end());
  return static_cast<WeatherType>(most - probability.begin());
}

void WeatherEstimator::restart() {
  brief_ = long_ = Means();
  log_p_ = {std::log(1 - 2 * kPriorRest), std::log(kPriorRest), std::log(kPriorRest)};
}

void WeatherEstimator::add(const AirCensus& census, Stamp stamp) {
  const double dt = last_ ? stamp - *last_ : 0;
  const bool first = !last_ || dt > kGap || dt < 0;
  if (first) restart();
  last_ = stamp;
  now_ = census.sectors;
  rates_.setReach(census.max_range);
  blend(census, first, dt);
  for (std::size_t s = 0; s < kSectors; ++s) {
    seen_[s] = std::max(seen_[s], census.sectors[s].returns);
    most_level_ = std::max(most_level_, census.sectors[s].level);
  }
  follow(signsOf(brief_), first ? kIndependent / 2 : dt);
}

void WeatherEstimator::blend(const AirCensus& census, bool first, double dt) {
  const double ground = reachOf(census.ground), upright = reachOf(census.upright);
  double above = 0, within = 0;
  for (std::size_t k = 0; k < AirCensus::kReachBins; ++k)
    (k < kOpenBin ? within : above) += census.ground[k] + census.upright[k];
  for (auto [means, memory] : {std::pair{&brief_, kBrief}, std::pair{&long_, kLong}}) {
    const double share = first ? 1 : 1 - std::exp(-dt / memory);
    const auto move = [share](double& mean, double value) { mean += share * (value - mean); };
    for (std::size_t s = 0; s < kSectors; ++s) {
      Sector& mean = means->sectors[s];
      const Sector& now = census.sectors[s];
      move(mean.returns, now.returns), move(mean.level, now.level);
      for (std::size_t k = 0; k < kShells; ++k)
        move(mean.lone[k], now.lone[k]), move(mean.level_lone[k], now.level_lone[k]);
      move(mean.blocked, now.blocked), move(mean.below, now.below);
      move(mean.brightness, now.brightness), move(mean.lit, now.lit);
    }
    move(means->above24, above), move(means->within24, within);
    move(means->ground_reach, ground), move(means->upright_reach, upright);
  }
}

std::vector<const Sector*> WeatherEstimator::looksOf(const Means& means) const {
  const double best = *std::max_element(seen_.begin(), seen_.end());
  std::vector<const Sector*> looks;
  for (std::size_t s = 0; s < kSectors; ++s)
    if (seen_[s] >= kLeastSeen * best && means.sectors[s].returns > 0)
      looks.push_back(&means.sectors[s]);
  return looks;
}

// The lower quartile over the sectors: weather is everywhere about the sensor, plants are not.
WeatherEstimator::Signs WeatherEstimator::signsOf(const Means& means) const {
  Signs signs;
  const std::vector<const Sector*> looks = looksOf(means);
  double returns = 0, level = 0;
  for (const Sector* look : looks) returns += look->returns, level += look->level;
  if (looks.size() < 3 || returns < kLeastReturns) return signs;
  for (std::size_t k = 0; k < kShells; ++k) {
    std::vector<double> shares;
    for (const Sector* look : looks) shares.push_back(look->lone[k] / look->returns);
    signs.lone[k] = quantile(std::move(shares), 0.25);
  }
  if (most_level_ > 0) signs.level = level / (static_cast<double>(looks.size()) * most_level_);
  signs.reach = std::max(means.ground_reach, means.upright_reach);
  signs.open = means.above24 / std::max(1.0, means.above24 + means.within24);
  signs.any = true;
  return signs;
}

double WeatherEstimator::airOf(const Signs& signs) {
  return 1.5 * std::log((nearOf(signs.lone) + 1e-6) / kClearAir);
}

std::array<double, 3> WeatherEstimator::evidenceOf(const Signs& signs) {
  const auto& lone = signs.lone;
  const double near = nearOf(lone), air = clampEvidence(airOf(signs));
  const double short_reach =
      clampEvidence(std::min({(kShortReach - signs.reach) / 4, (kLostLevel - signs.level) / 0.06,
                              (signs.level - kNoLevel) / 0.04}));
  const double within = lone[0] + lone[1] + lone[2] + lone[3];
  const bool dense = near > kDense && signs.reach < kFogReach;
  const double soft =
      dense ? clampEvidence(3 * std::log(kFogEnds * within / (lone[4] + 1e-6))) : -kMostEvidence;
  const double is_air = std::max(0.0, air), is_soft = std::max(0.0, soft);
  return {-is_air - std::max(0.0, short_reach), std::min(0.0, air) - is_soft,
          std::min(0.0, std::max(short_reach, soft)) - (soft > 0 ? 0 : is_air)};
}

void WeatherEstimator::follow(const Signs& signs, double dt) {
  const double leave = 1 - std::exp(-dt / kStay);
  std::array<double, 3> evidence{};
  if (signs.any) evidence = evidenceOf(signs);
  const double weight = std::min(1.0, dt / kIndependent);
  std::array<double, 3> p{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = (1 - 1.5 * leave) * std::exp(log_p_[k]) + 0.5 * leave;
    p[k] *= std::exp(weight * evidence[k]);
    sum += p[k];
  }
  for (std::size_t k = 0; k < 3; ++k) log_p_[k] = std::log(std::max(p[k] / sum, 1e-9));
}

// Level beams: as many as below the horizon, of which nearly all return. Without directions that
// are open, by all returns.
AirShares WeatherEstimator::sharesOf(const Signs& signs) const {
  const auto& lone = signs.lone;
  AirShares shares;
  shares.few_far = fartherOf(lone) < kDropsEnd;
  shares.drops = (lone[0] + lone[1]) / std::max(signs.open, 0.01);
  shares.all = lone[0] + lone[1] + lone[2];
  shares.flakes = shares.all + lone[3];
  const std::vector<const Sector*> looks = looksOf(long_);
  std::vector<double> below;
  for (const Sector* look : looks) below.push_back(look->below);
  const double fired = below.empty() ? 0 : quantile(std::move(below), kFiredRank);
  std::vector<Weighed> drops, middle, flakes;
  double sum = 0, near = 0, lit = 0, brightness = 0;
  for (const Sector* look : looks) {
    const double open = fired - std::max(0.0, look->blocked);
    if (!(open > kOpenShare * fired)) continue;
    const auto& level = look->level_lone;
    drops.push_back({(level[0] + level[1]) / open, open});
    middle.push_back({level[2] / open, open});
    flakes.push_back({(level[0] + level[1] + level[2] + level[3]) / open, open});
    sum += open, near += level[0], lit += look->lit, brightness += look->brightness;
  }
  if (sum < kLeastOpen) return shares;
  shares.drops = medianOf(std::move(drops)), shares.flakes = medianOf(std::move(flakes));
  shares.few_far = (medianOf(std::move(middle)) + kFew) / (shares.drops + kFew) < kDropsEnd;
  if (lit > near / 2) shares.brightness = brightness / near;
  return shares;
}

WeatherState WeatherEstimator::state() const {
  WeatherState state;
  if (!last_) return state;
  const Signs signs = signsOf(long_), now = signsOf(brief_);
  const auto& lone = signs.lone;
  const double all = lone[0] + lone[1] + lone[2] + lone[3];
  // Drops are seen only near by, flakes farther; more returns than any rain gives are flakes.
  const double farther = fartherOf(lone);
  const double snow = 2 * std::log((all + kFew) / kSnowShare) +
                      std::min(0.0, 3 * std::log(farther / kDropsEnd)) +
                      std::max(0.0, 2 * std::log(farther / kOnlyFar));
  const double wet = std::exp(log_p_[1]), is_snow = 1 / (1 + std::exp(-snow));
  state.probability = {std::exp(log_p_[0]), wet * (1 - is_snow), wet * is_snow,
                       std::exp(log_p_[2])};
  if (now.any)
    state.flurry = 1 / (1 + std::exp(-airOf(now)) * (1 - 2 * kPriorRest) / (2 * kPriorRest));
  const AirShares shares = sharesOf(signs);
  state.rain_mm_h = rates_.rain(shares), state.snow_mm_h = rates_.snow(shares);
  state.visibility = visibilityOfReach(now.reach);
  return state;
}

// A cloud fades out: the sectors beside it count, too.
std::shared_ptr<const AirClouds> WeatherEstimator::clouds(const Pose3& T_world_sensor,
                                                          double weather) const {
  const double usual = kLeastSeen * *std::max_element(seen_.begin(), seen_.end());
  std::array<double, kSectors> own{};
  for (std::size_t s = 0; s < kSectors; ++s)
    own[s] = std::max(cloudOf(now_[s], usual), cloudOf(brief_.sectors[s], usual));
  if (*std::max_element(own.begin(), own.end()) <= std::max(kHardlyCloud, weather)) return nullptr;
  auto clouds = std::make_shared<AirClouds>();
  clouds->T_sensor_world = T_world_sensor.inverse();
  for (std::size_t s = 0; s < kSectors; ++s)
    clouds->probability[s] =
        std::max({own[(s + kSectors - 1) % kSectors], own[s], own[(s + 1) % kSectors]});
  return clouds;
}

}  // namespace perception
