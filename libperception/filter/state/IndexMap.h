#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace perception {

/// splitmix64's finalizer: a bijective hash of 64-bit integers.
inline std::uint64_t mixBits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

/// Maps distinct 64-bit keys to 0, 1, 2 ... in order of first appearance. Open addressing: one
/// allocation for thousands of keys.
class IndexMap {
 public:
  explicit IndexMap(std::size_t expected) {
    std::size_t size = 16;
    while (size < 2 * expected) size *= 2;
    slots_.resize(size);
  }

  /// The key's number, and whether the key is new.
  std::pair<std::size_t, bool> numberOf(std::uint64_t key) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    Slot& s = find(key);
    if (s.number != 0) return {s.number - 1, false};
    s = {key, ++count_};
    return {count_ - 1, true};
  }
  std::size_t size() const { return count_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::size_t number = 0;  // 0: free, else number + 1
  };

  Slot& find(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = static_cast<std::size_t>(mixBits(key)) & mask;
    while (slots_[i].number != 0 && slots_[i].key != key) i = (i + 1) & mask;
    return slots_[i];
  }

  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.number != 0) find(s.key) = s;
  }

  std::vector<Slot> slots_;  // a power of two, at most half full
  std::size_t count_ = 0;
};

}  // namespace perception
