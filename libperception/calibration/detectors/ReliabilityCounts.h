#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "libperception/core/math/Angle.h"

namespace perception {

/// Stated probabilities, in bins of a tenth, and the shares that came true.
class ReliabilityCounts {
 public:
  void add(double probability, bool object) {
    Bin& bin = bins_[std::min(kBins - 1, static_cast<std::size_t>(probability * kBins))];
    bin.stated += probability;
    bin.variance += probability * (1 - probability);
    bin.objects += object ? 1 : 0;
    ++bin.count;
  }
  double count() const { return sum(&Bin::count); }
  double stated() const { return sum(&Bin::stated) / count(); }
  double objects() const { return sum(&Bin::objects) / count(); }
  double error() const {
    double error = 0;
    for (const Bin& b : bins_) error += std::abs(b.stated - b.objects);
    return error / count();
  }
  /// Expected error of as many independent boxes whose probabilities are true.
  double chance() const {
    double error = 0;
    for (const Bin& b : bins_) error += std::sqrt(2 / kPi * b.variance);
    return error / count();
  }
  /// Rows of number, stated, objects.
  std::vector<std::array<double, 3>> curve() const {
    std::vector<std::array<double, 3>> rows;
    for (const Bin& b : bins_)
      if (b.count > 0) rows.push_back({b.count, b.stated / b.count, b.objects / b.count});
    return rows;
  }

 private:
  static constexpr std::size_t kBins = 10;
  struct Bin {
    double stated = 0, variance = 0, objects = 0, count = 0;
  };
  double sum(double Bin::*of) const {
    double all = 0;
    for (const Bin& b : bins_) all += b.*of;
    return all;
  }
  std::array<Bin, kBins> bins_;
};

}  // namespace perception
