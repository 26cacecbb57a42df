#include "libperception/lidar/SpaceLinkage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "libperception/lidar/Forest.h"

namespace perception {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// Numbers of keys in the order of their first appearance: open addressing, at most half full.
class KeyNumbers {
 public:
  KeyNumbers() : slots_(1024) {}
  std::uint32_t add(std::uint64_t key) {
    if (2 * count_ >= slots_.size()) grow();
    Slot& slot = slots_[slotOf(key)];
    if (slot.number == kNone) slot = {key, count_++};
    return slot.number;
  }
  std::uint32_t find(std::uint64_t key) const { return slots_[slotOf(key)].number; }
  std::uint32_t count() const { return count_; }

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

/// 21 bits for each of three integers.
std::uint64_t keyOf(std::int32_t a, std::int32_t b, std::int32_t c) {
  constexpr std::int64_t kMiddle = 1 << 20;
  return static_cast<std::uint64_t>(a + kMiddle) << 42 |
         static_cast<std::uint64_t>(b + kMiddle) << 21 | static_cast<std::uint64_t>(c + kMiddle);
}

std::int32_t cellOf(float v, float per_meter) {
  const float place = v * per_meter;
  const auto cell = static_cast<std::int32_t>(place);  // towards zero
  return cell - (place < static_cast<float>(cell));
}

/// Members of groups, group by group, in their order.
struct Buckets {
  Buckets(const std::vector<std::uint32_t>& group_of, std::size_t groups)
      : start(groups + 1, 0), member(group_of.size()) {
    for (const std::uint32_t g : group_of) ++start[g + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < group_of.size(); ++i)
      member[next[group_of[i]]++] = static_cast<std::uint32_t>(i);
  }
  std::vector<std::uint32_t> start, member;
};

/// Cubes so small that all their returns are linked, in blocks wider than the longest link.
class CubeLinkage {
 public:
  CubeLinkage(const std::vector<LinkedReturn>& returns, float least, float most)
      : returns_(returns),
        per_cube_(std::sqrt(3.0f) / least * 1.0001f),
        cubes_per_block_(static_cast<std::int32_t>(std::ceil(most * per_cube_)) + 1),
        cube_of_(cubes()),
        in_cube_(cube_of_, cube_count_),
        block_of_(blocks()),
        in_block_(block_of_, block_key_.size()),
        groups_(cube_count_) {}

  Partition link() {
    for (std::uint32_t c = 0; c + 1 < in_block_.start.size(); ++c) linkWithin(c);
    // Half of the 26 neighbors: every pair once.
    constexpr std::int32_t kStep[13][3] = {
        {1, 0, 0},  {-1, 1, 0}, {0, 1, 0}, {1, 1, 0},  {-1, -1, 1}, {0, -1, 1}, {1, -1, 1},
        {-1, 0, 1}, {0, 0, 1},  {1, 0, 1}, {-1, 1, 1}, {0, 1, 1},   {1, 1, 1}};
    for (std::uint32_t c = 0; c + 1 < in_block_.start.size(); ++c) {
      for (const auto& step : kStep) {
        const auto& [x, y, z] = block_key_[c];
        const std::uint32_t d = block_table_.find(keyOf(x + step[0], y + step[1], z + step[2]));
        if (d != kNone) linkBlocks(c, d);
      }
    }
    return partitionOf(cube_of_, groups_);
  }

 private:
  /// Least box around returns, and their longest link [m].
  struct Bounds {
    float x0, x1, y0, y1, z0, z1, length;

    void add(const Bounds& b) {
      x0 = std::min(x0, b.x0), x1 = std::max(x1, b.x1);
      y0 = std::min(y0, b.y0), y1 = std::max(y1, b.y1);
      z0 = std::min(z0, b.z0), z1 = std::max(z1, b.z1);
      length = std::max(length, b.length);
    }
    /// False: no return in one is linked to one in the other.
    bool mayLink(const Bounds& b) const {
      const float link = std::min(length, b.length);
      const float dx = std::max({0.0f, x0 - b.x1, b.x0 - x1}),
                  dy = std::max({0.0f, y0 - b.y1, b.y0 - y1}),
                  dz = std::max({0.0f, z0 - b.z1, b.z0 - z1});
      return dx * dx + dy * dy + dz * dz <= link * link;
    }
  };

  /// The cube of every return; sets the bounds of the cubes.
  std::vector<std::uint32_t> cubes() {
    KeyNumbers table;
    std::vector<std::uint32_t> cube_of;
    cube_of.reserve(returns_.size());
    std::uint64_t last = 0;  // neighbors in the scan are often in one cube
    for (const LinkedReturn& r : returns_) {
      const std::uint64_t key =
          keyOf(cellOf(r.x, per_cube_), cellOf(r.y, per_cube_), cellOf(r.z, per_cube_));
      const std::uint32_t cube = !cube_of.empty() && key == last ? cube_of.back() : table.add(key);
      if (cube == bounds_.size()) bounds_.push_back({r.x, r.x, r.y, r.y, r.z, r.z, r.length});
      bounds_[cube].add({r.x, r.x, r.y, r.y, r.z, r.z, r.length});
      cube_of.push_back(cube), last = key;
    }
    cube_count_ = table.count();
    return cube_of;
  }

  std::vector<std::uint32_t> blocks() {
    std::vector<std::uint32_t> block_of;
    block_of.reserve(cube_count_);
    for (std::uint32_t c = 0; c < cube_count_; ++c) {
      const LinkedReturn& r = returns_[in_cube_.member[in_cube_.start[c]]];
      const std::array<std::int32_t, 3> key = {blockOf(r.x), blockOf(r.y), blockOf(r.z)};
      block_of.push_back(block_table_.add(keyOf(key[0], key[1], key[2])));
      if (block_of.back() == block_key_.size())
        block_key_.push_back(key), block_bounds_.push_back(bounds_[c]);
      block_bounds_[block_of.back()].add(bounds_[c]);
    }
    return block_of;
  }

  /// Blocks are of whole cubes and wider than a link and a cube: linked returns lie in neighboring
  /// blocks at most.
  std::int32_t blockOf(float v) const {
    const std::int32_t cube = cellOf(v, per_cube_);
    return (cube >= 0 ? cube : cube - cubes_per_block_ + 1) / cubes_per_block_;
  }

  bool near(std::uint32_t a, std::uint32_t b) const {
    if (!bounds_[a].mayLink(bounds_[b])) return false;
    for (std::uint32_t i = in_cube_.start[a]; i < in_cube_.start[a + 1]; ++i) {
      const LinkedReturn& r = returns_[in_cube_.member[i]];
      for (std::uint32_t j = in_cube_.start[b]; j < in_cube_.start[b + 1]; ++j) {
        const LinkedReturn& s = returns_[in_cube_.member[j]];
        const float x = r.x - s.x, y = r.y - s.y, z = r.z - s.z, l = std::min(r.length, s.length);
        if (x * x + y * y + z * z <= l * l) return true;
      }
    }
    return false;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    if (groups_.find(a) != groups_.find(b) && near(a, b)) groups_.unite(a, b);
  }

  void linkWithin(std::uint32_t c) {
    for (std::uint32_t i = in_block_.start[c]; i < in_block_.start[c + 1]; ++i)
      for (std::uint32_t j = i + 1; j < in_block_.start[c + 1]; ++j)
        join(in_block_.member[i], in_block_.member[j]);
  }

  bool uniform(std::uint32_t c) {
    const std::uint32_t first = groups_.find(in_block_.member[in_block_.start[c]]);
    for (std::uint32_t i = in_block_.start[c] + 1; i < in_block_.start[c + 1]; ++i)
      if (groups_.find(in_block_.member[i]) != first) return false;
    return true;
  }

  /// The cubes of block c that may be linked to some of block d.
  void facing(std::uint32_t c, std::uint32_t d, std::vector<std::uint32_t>& cubes) const {
    cubes.clear();
    for (std::uint32_t i = in_block_.start[c]; i < in_block_.start[c + 1]; ++i) {
      const std::uint32_t cube = in_block_.member[i];
      if (bounds_[cube].mayLink(block_bounds_[d])) cubes.push_back(cube);
    }
  }

  void linkBlocks(std::uint32_t c, std::uint32_t d) {
    if (!block_bounds_[c].mayLink(block_bounds_[d])) return;
    const bool whole = uniform(c) && uniform(d);
    const auto same = [&] {
      return groups_.find(in_block_.member[in_block_.start[c]]) ==
             groups_.find(in_block_.member[in_block_.start[d]]);
    };
    if (whole && same()) return;
    facing(c, d, of_one_), facing(d, c, of_other_);
    for (const std::uint32_t i : of_one_) {
      for (const std::uint32_t j : of_other_) {
        join(i, j);
        if (whole && same()) return;
      }
    }
  }

  const std::vector<LinkedReturn>& returns_;
  const float per_cube_;  ///< [1/m]
  const std::int32_t cubes_per_block_;
  std::uint32_t cube_count_ = 0;
  std::vector<Bounds> bounds_;
  std::vector<std::uint32_t> cube_of_;
  Buckets in_cube_;
  std::vector<std::array<std::int32_t, 3>> block_key_;
  std::vector<Bounds> block_bounds_;
  KeyNumbers block_table_;
  std::vector<std::uint32_t> block_of_;
  Buckets in_block_;
  Forest groups_;
  std::vector<std::uint32_t> of_one_, of_other_;  ///< cubes of two blocks that face each other
};

}  // namespace

Partition linkInSpace(const std::vector<LinkedReturn>& returns, float least, float most) {
  return CubeLinkage(returns, least, most).link();
}

}  // namespace perception
