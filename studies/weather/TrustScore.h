#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// "snow"; for other labels the number.
std::string nameOfPhantom(std::uint16_t label);

/// Counts of returns by trust, in kBins equal bins of [0, 1].
class TrustHistogram {
 public:
  static constexpr int kBins = 1000;

  void add(float trust);
  TrustHistogram& operator+=(const TrustHistogram& other);
  std::size_t total() const { return total_; }
  /// Returns with trust below a multiple of 1 / kBins.
  std::size_t below(double trust) const;
  double sumBetween(int from, int to) const;  ///< of 1 - trust, bins [from, to)
  std::size_t countBetween(int from, int to) const;

 private:
  std::array<std::size_t, kBins> count_{};
  std::array<double, kBins> doubt_{};
  std::size_t total_ = 0;
};

/// How well trust tells phantoms from surfaces, over labeled returns.
class TrustScore {
 public:
  struct Rates {
    std::size_t found = 0, false_alarms = 0, missed = 0;
    std::optional<double> precision, recall, f1;  ///< empty: no such returns
  };
  struct Bin {
    double stated = 0;    ///< mean P(phantom)
    double phantoms = 0;  ///< share
    std::size_t returns = 0;
  };

  /// Whether label 0 counts as a surface (a simulation knows every return), or not at all.
  bool unlabeled_is_surface = false;
  void add(const std::vector<float>& trust, const std::vector<std::uint16_t>& labels);
  void add(float trust, std::uint16_t label);

  TrustHistogram surfaces() const;
  TrustHistogram phantoms() const;
  /// By label, the unlabeled too.
  const std::map<std::uint16_t, TrustHistogram>& byLabel() const { return by_label_; }
  /// At trust < `threshold`; of one kind of phantoms against all false alarms, or of all (0).
  Rates at(double threshold, std::uint16_t kind = 0) const;
  std::optional<double> averagePrecision() const;
  std::vector<Bin> reliability() const;  ///< in ten bins of P(phantom); empty ones are left out
  std::optional<double> calibrationError() const;

 private:
  std::map<std::uint16_t, TrustHistogram> by_label_;
};

}  // namespace perception
