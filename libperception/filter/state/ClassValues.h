#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace perception {

/// One value per class; up to eight without heap allocation.
class ClassValues {
 public:
  ClassValues() = default;
  void assign(std::size_t n, double value) {
    resize(n);
    std::fill(begin(), end(), value);
  }
  /// Values are unspecified afterwards.
  void resize(std::size_t n) {
    size_ = n;
    if (n > kOwn) more_.resize(n);
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  double* begin() { return size_ > kOwn ? more_.data() : own_.data(); }
  double* end() { return begin() + size_; }
  const double* begin() const { return size_ > kOwn ? more_.data() : own_.data(); }
  const double* end() const { return begin() + size_; }
  double& operator[](std::size_t i) { return begin()[i]; }
  const double& operator[](std::size_t i) const { return begin()[i]; }

 private:
  static constexpr std::size_t kOwn = 8;
  std::size_t size_ = 0;
  std::array<double, kOwn> own_{};
  std::vector<double> more_;
};

}  // namespace perception
