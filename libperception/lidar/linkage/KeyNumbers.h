#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Numbers of keys in the order of their first appearance: open addressing, at most half full.
class KeyNumbers {
 public:
  static constexpr std::uint32_t kNone = ~0u;

  /// `slots`: for the first keys, a power of two.
  explicit KeyNumbers(std::size_t slots = 1024) : slots_(slots) { setMask(); }
  /// The number of the key, a new one if it has none.
  std::uint32_t add(std::uint64_t key) {
    if (2 * count_ > mask_) grow();
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
    // The highest bits, which all bits of the key change.
    auto slot = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> shift_);
    while (slots_[slot].number != kNone && slots_[slot].key != key) slot = (slot + 1) & mask_;
    return slot;
  }
  void setMask() {
    mask_ = slots_.size() - 1, shift_ = 64;
    for (std::size_t slots = slots_.size(); slots > 1; slots /= 2) --shift_;
  }
  void grow() {
    std::vector<Slot> old(4 * slots_.size());
    old.swap(slots_);
    setMask();
    for (const Slot& s : old)
      if (s.number != kNone) slots_[slotOf(s.key)] = s;
  }
  std::vector<Slot> slots_;  ///< a power of two
  std::size_t mask_ = 0;     ///< of the numbers of slots
  int shift_ = 0;            ///< of a hash to the number of a slot
  std::uint32_t count_ = 0;
};

}  // namespace perception
