#include "libperception/importers/clouds/CloudLayout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>

#include "libperception/measurement/frames/NoReturns.h"

namespace perception {
namespace {

using Column = std::vector<double>;

// All assumed.
constexpr std::size_t kLeastNumbers = 400;
constexpr std::size_t kMostNumbers = 1U << 18;  // of a scan that are looked at
constexpr std::size_t kSizes = 40;              // bins of the size of a number
constexpr double kLeastInformation = 0.1;       // [nats]
constexpr double kAsGood = 0.8;  // of the most information, that the least number of columns has
constexpr double kLeastSpread = 0.2;  // [m] between the 5 % and the 95 % quantile of a coordinate
constexpr double kMostRings = 256;
constexpr double kOddWords = 0.05;  // share of the words of float64 that no float32 has
constexpr double kRingTells = 0.8;  // share of the variance of the elevations
constexpr double kRises =
    0.95;  // share of the steps of a time that rise, of those that do not stay
constexpr double kLeastTurn = 0.01, kMostTurn = 0.6;  // [s] of a scan
constexpr double kSmallFall = 0.1;                    // of the whole time: less is no new ring
constexpr double kSmallFalls = 0.01;                  // share of the steps
constexpr double kClockSteps = 0.5;  // share of the steps of a time that are whole periods
constexpr double kWhole = 0.1;       // [periods] off a whole number
constexpr double kInOrder = 0.25;    // step of the bearing, of that between returns far apart

/// A number that hardly any measurement has.
bool isOdd(float value) {
  constexpr float kMost = 1e10F, kLeast = 1e-10F;
  return !std::isfinite(value) || std::abs(value) > kMost ||
         (value != 0 && std::abs(value) < kLeast);
}

/// Bin of a number's sign and size, on a scale that is logarithmic beyond a tenth.
std::size_t sizeBin(float value) {
  if (!std::isfinite(value)) return kSizes;
  const double v = std::asinh(10 * static_cast<double>(value));  // 1000 m: 9.9
  return static_cast<std::size_t>(std::clamp(v * 2 + kSizes / 2.0, 0.0, kSizes - 1.0));
}

/// [nats] that the place in rows of `columns` numbers says of the size of a number. What is no
/// number is left out: where it is may follow the order of the beams.
double informationOf(const std::vector<std::size_t>& bins, std::size_t columns) {
  std::vector<std::array<double, kSizes>> counts(columns);
  std::vector<double> rows(columns);
  std::array<double, kSizes> all{};
  double total = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i] == kSizes) continue;
    ++counts[i % columns][bins[i]], ++all[bins[i]], ++rows[i % columns], ++total;
  }
  double information = 0;
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t b = 0; b < kSizes; ++b)
      if (counts[c][b] > 0)
        information += counts[c][b] / total * std::log(counts[c][b] * total / (rows[c] * all[b]));
  return information;
}

double quantile(Column values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Column finiteOf(const Column& values) {
  Column finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double v) { return std::isfinite(v); });
  return finite;
}

bool rises(const Column& values) {
  std::size_t up = 0, down = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    up += values[i] > values[i - 1], down += values[i] < values[i - 1];
  return up > 0 && values.back() > values.front() &&
         static_cast<double>(up) >= kRises * static_cast<double>(up + down);
}

/// [s] lasts a scan, in s, ms, us or ns.
bool lastsAScan(double span) {
  for (const double unit : {1.0, 1e3, 1e6, 1e9})
    if (span >= kLeastTurn * unit && span <= kMostTurn * unit) return true;
  return false;
}

/// Rises as a clock does: by whole periods, through the time of a scan, and falls only to begin
/// anew. Bytes are no clock, nor are values that were sorted.
bool isClock(const Column& values) {
  if (!rises(values)) return false;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const bool bytes =
      *least >= 0 && *most < kMostRings &&
      std::all_of(values.begin(), values.end(), [](double v) { return v == std::floor(v); });
  if (bytes || !lastsAScan(*most - *least)) return false;
  Column steps;
  std::size_t small_falls = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step > 0) steps.push_back(step);
    small_falls += step < 0 && -step < kSmallFall * (*most - *least);
  }
  if (static_cast<double>(small_falls) > kSmallFalls * static_cast<double>(steps.size()))
    return false;
  const double period = quantile(steps, 0.5);
  const auto whole = std::count_if(steps.begin(), steps.end(), [&](double step) {
    const double periods = step / period;
    return periods > 0.5 && std::abs(periods - std::round(periods)) <= kWhole;
  });
  return static_cast<double>(whole) >= kClockSteps * static_cast<double>(steps.size());
}

/// Whether returns follow each other as a scanner sees them: bearings of neighbors in the file are
/// alike, those of others are not.
bool inScanningOrder(const Column& x, const Column& y) {
  Column near, far;
  const std::size_t n = x.size(), half = n / 2;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const auto turn = [&](std::size_t k) {
      return std::abs(std::remainder(std::atan2(y[k], x[k]) - std::atan2(y[i], x[i]), 2 * M_PI));
    };
    // A far one that has nothing to do with the order in which rings follow each other.
    const double a = turn(i + 1), b = turn((i * 7919 + half) % n);
    if (std::isfinite(a) && std::isfinite(b)) near.push_back(a), far.push_back(b);
  }
  return !near.empty() && quantile(near, 0.5) <= kInOrder * quantile(far, 0.5);
}

bool isCoordinate(const Column& values) {
  const Column finite = finiteOf(values);
  if (finite.size() < 2 || 2 * finite.size() < values.size()) return false;
  if (quantile(finite, 0.99) > kFarthestReturn || quantile(finite, 0.01) < -kFarthestReturn)
    return false;
  return quantile(finite, 0.95) - quantile(finite, 0.05) >= kLeastSpread && !isClock(finite);
}

/// Whether heights of returns: a coordinate, or those of even ground below a scanner, which hardly
/// differ but of which at least half are negative, as no intensity, ring or time is.
bool isHeight(const Column& values) {
  if (isCoordinate(values)) return true;
  const Column finite = finiteOf(values);
  if (finite.size() < 2 || 2 * finite.size() < values.size()) return false;
  const double low = quantile(finite, 0.01), high = quantile(finite, 0.99);
  return low > -kFarthestReturn && low < high && quantile(finite, 0.5) < 0;
}

/// Share of the variance of the elevations that is between the values of a column.
double toldOfElevation(const Column& column, const Column& x, const Column& y, const Column& z) {
  struct Sums {
    double n = 0, sum = 0;
  };
  std::map<double, Sums> groups;
  double n = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    const double range = std::hypot(x[i], y[i]);
    if (!std::isfinite(range) || !std::isfinite(z[i]) || range <= 0) continue;
    const double elevation = std::atan2(z[i], range);
    Sums& group = groups[column[i]];
    ++group.n, group.sum += elevation;
    ++n, sum += elevation, squares += elevation * elevation;
  }
  if (n < 2) return 0;
  double between = 0;
  for (const auto& [value, group] : groups) between += group.sum * group.sum / group.n;
  const double variance = squares - sum * sum / n;
  return variance > 0 ? (between - sum * sum / n) / variance : 0;
}

bool isSmallWhole(const Column& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double v) { return v >= 0 && v < kMostRings && v == std::floor(v); });
}

/// Whether it can be an intensity: nowhere negative, and not the same everywhere, as what fills
/// rows.
bool isMeasured(const Column& values) {
  const Column finite = finiteOf(values);
  if (finite.empty()) return false;
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  return *least >= 0 && *most > *least;
}

/// Names of what is beside the coordinates, and the scale of the intensities.
void nameOthers(const std::vector<Column>& values, std::size_t first, CloudLayout& layout) {
  const Column &x = values[first], &y = values[first + 1], &z = values[first + 2];
  bool intensity = false, ring = false, time = false;
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (c >= first && c < first + 3) continue;
    const Column& v = values[c];
    if (!ring && isSmallWhole(v) && toldOfElevation(v, x, y, z) >= kRingTells) {
      layout.columns[c] = "ring", ring = true;
    } else if (!time && isClock(v) && inScanningOrder(x, y)) {
      layout.columns[c] = "time", time = true;
    } else if (!intensity && c > first && isMeasured(v)) {
      layout.columns[c] = "intensity", intensity = true;
      const Column finite = finiteOf(v);
      const double most = *std::max_element(finite.begin(), finite.end());
      layout.intensity_max = most <= 1 ? 1 : most <= 255 ? 255 : most <= 65535 ? 65535 : most;
    }
  }
}

}  // namespace

std::optional<std::size_t> columnCountOf(const std::vector<float>& numbers) {
  if (numbers.size() < kLeastNumbers) return {};
  std::vector<std::size_t> bins(std::min(numbers.size(), kMostNumbers));
  std::transform(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(bins.size()),
                 bins.begin(), sizeBin);
  std::array<double, kMostCloudColumns + 1> told{};
  for (std::size_t columns = 3; columns <= kMostCloudColumns; ++columns)
    told[columns] = informationOf(bins, columns);
  const double most = *std::max_element(told.begin(), told.end());
  if (most < kLeastInformation) return {};
  for (std::size_t columns = 3;; ++columns)
    if (told[columns] >= kAsGood * most) return columns;
}

bool looksLikeDoubles(const std::string& bytes) {
  const std::size_t count = std::min(bytes.size() / sizeof(double), kMostNumbers);
  std::vector<float> words(2 * count), numbers(count);
  if (count == 0) return false;
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(float));
  const auto odd = std::count_if(words.begin(), words.end(), isOdd);
  if (static_cast<double>(odd) < kOddWords * static_cast<double>(words.size())) return false;
  for (std::size_t i = 0; i < count; ++i) {
    double value = 0;
    std::memcpy(&value, bytes.data() + i * sizeof(double), sizeof(double));
    numbers[i] = static_cast<float>(value);
  }
  const auto columns = columnCountOf(numbers);
  if (!columns) return false;
  std::vector<Column> values(*columns);
  for (std::size_t i = 0; i < count / *columns * *columns; ++i)
    values[i % *columns].push_back(static_cast<double>(numbers[i]));
  return layoutOf(values).has_value();
}

std::optional<CloudLayout> layoutOf(const std::vector<std::vector<double>>& values) {
  for (std::size_t first = 0; first + 3 <= values.size(); ++first) {
    if (!isCoordinate(values[first]) || !isCoordinate(values[first + 1]) ||
        !isHeight(values[first + 2]))
      continue;
    CloudLayout layout;
    layout.columns.assign(values.size(), "-");
    layout.columns[first] = "x", layout.columns[first + 1] = "y", layout.columns[first + 2] = "z";
    nameOthers(values, first, layout);
    return layout;
  }
  return {};
}

}  // namespace perception
