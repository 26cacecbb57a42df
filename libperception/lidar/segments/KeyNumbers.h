#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Numbers of keys in the order of their first appearance: open addressing, at most half full.
class KeyNumbers {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  KeyNumbers() : slots_(1024) {}
  /// The number of the key, a new one if it has none.
  std::uint32_t add(std::uint64_t key) {
    if (2 * count_ >= slots_.size()) grow();
    Slot& slot = slots_[slotOf(key)];
    if (slot.number == kNone) slot = {key, count_++};
    return slot.number;
  }
  /// kNone: the key has no number.
  std::uint32_t find(std::uint64_t key) const { return slots_[slotOf(key)].number; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = kNone;
  };
  /// Where the key is or belongs.
  std::size_t slotOf(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32) & mask;
    while (slots_[slot].number != kNone && slots_[slot].key != key) slot = (slot + 1) & mask;
    return slot;
  }
  void grow() {
    std::vector<Slot> old(4 * slots_.size());
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.number != kNone) slots_[slotOf(s.key)] = s;
  }
  std::vector<Slot> slots_;  ///< a power of two
  std::uint32_t count_ = 0;
};

}  // namespace perception
