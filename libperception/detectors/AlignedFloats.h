#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace perception {

/// Uninitialized array of floats, aligned to 64 bytes, with one vector of padding that may be read
/// and written.
class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::size_t size) : size_(size) {
    constexpr std::size_t kBytes = 64;
    const std::size_t bytes = ((size + 16) * sizeof(float) + kBytes - 1) / kBytes * kBytes;
    values_.reset(static_cast<float*>(std::aligned_alloc(kBytes, bytes)));
    if (!values_) throw std::bad_alloc();
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  float* data() { return values_.get(); }
  const float* data() const { return values_.get(); }
  float& operator[](std::size_t i) { return values_.get()[i]; }
  const float& operator[](std::size_t i) const { return values_.get()[i]; }

 private:
  struct Free {
    void operator()(float* p) const { std::free(p); }
  };
  std::size_t size_ = 0;
  std::unique_ptr<float, Free> values_;
};

}  // namespace perception
