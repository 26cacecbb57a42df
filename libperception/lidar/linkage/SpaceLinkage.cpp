#include "libperception/lidar/linkage/SpaceLinkage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>

#include "libperception/lidar/linkage/Forest.h"
#include "libperception/lidar/linkage/KeyNumbers.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/RawVector.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

bool linked(const LinkedReturn& r, const LinkedReturn& s) {
  const float x = r.x - s.x, y = r.y - s.y, z = r.z - s.z, l = std::min(r.length, s.length);
  return x * x + y * y + z * z <= l * l;
}

/// Place of a block: 21 bits for each of three integers.
inline __attribute__((always_inline)) std::uint64_t keyOf(std::int32_t x, std::int32_t y,
                                                          std::int32_t z) {
  constexpr std::int32_t kMiddle = 1 << 20;
  const auto part = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v + kMiddle));
  };
  return part(x) << 42 | part(y) << 21 | part(z);
}

/// What a step of -1, 0 or 1 blocks along each axis adds to a key.
std::uint64_t stepOf(std::int64_t x, std::int64_t y, std::int64_t z) {
  return (static_cast<std::uint64_t>(x) << 42) + (static_cast<std::uint64_t>(y) << 21) +
         static_cast<std::uint64_t>(z);
}

/// Largest integer that is not above v.
inline __attribute__((always_inline)) std::int32_t floorOf(float v) {
  const auto whole = static_cast<std::int32_t>(v);  // towards zero
  return whole - (v < static_cast<float>(whole));
}

/// Where returns lie among cubes and blocks of n by n by n cubes.
struct CubeGrid {
  float per_cube;   ///< [1/m]
  std::int32_t n;   ///< cubes along a block
  float per_block;  ///< [blocks a cube] 1 / n

  /// 64-bit words with a bit for each cube of a block.
  std::uint32_t words() const { return static_cast<std::uint32_t>(n * n * n + 63) / 64; }

  /// Key of the block and place in it of each return; without branches, so that the compiler
  /// vectorizes it.
  PERCEPTION_WIDER void placeAll(const LinkedReturn* returns, std::size_t count,
                                 std::uint64_t* block, std::uint32_t* within) const {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t x = floorOf(returns[i].x * per_cube), y = floorOf(returns[i].y * per_cube),
                         z = floorOf(returns[i].z * per_cube);
      const std::int32_t bx = blockOf(x), by = blockOf(y), bz = blockOf(z);
      block[i] = keyOf(bx, by, bz);
      within[i] = static_cast<std::uint32_t>(((x - bx * n) * n + (y - by * n)) * n + (z - bz * n));
    }
  }

 private:
  /// The middle of a cube is far from a block's border against rounding.
  std::int32_t blockOf(std::int32_t cube) const {
    return floorOf((static_cast<float>(cube) + 0.5f) * per_block);
  }
};

/// Cubes so small that all their returns are linked, in blocks wider than the longest link. Cubes
/// are numbered block by block; returns are sorted by cube.
class CubeLinkage {
 public:
  CubeLinkage(const std::vector<LinkedReturn>& returns, float least, float most)
      : returns_(returns), block_numbers_(slotsFor(returns.size())) {
    grid_.per_cube = std::sqrt(3.0f) / least * 1.0001f;
    // Blocks are wider than a link and a cube: linked returns lie in neighboring blocks at most.
    grid_.n = static_cast<std::int32_t>(std::ceil(most * grid_.per_cube)) + 1;
    grid_.per_block = 1 / static_cast<float>(grid_.n);
    place();
    numberCubes();
    sortReturns();
    bound();
  }

  Partition link() {
    Forest groups(first_return_.size() - 1);
    groups_ = &groups;
    const auto blocks = static_cast<std::uint32_t>(block_key_.size());
    uniform_.assign(blocks, 0);
    for (std::uint32_t c = 0; c < blocks; ++c) linkWithin(c);
    // Half of the 26 neighbors: every pair once. Those that share a face first: most others are in
    // one group by then.
    constexpr std::int8_t kStep[13][3] = {
        {1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {-1, 1, 0}, {0, 1, 1},  {0, -1, 1},
        {1, 0, 1}, {-1, 0, 1}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};
    for (const auto& step : kStep) {
      const std::uint64_t aside = stepOf(step[0], step[1], step[2]);
      for (std::uint32_t c = 0; c < blocks; ++c) {
        const std::uint32_t d = block_numbers_.find(block_key_[c] + aside);
        if (d != KeyNumbers::kNone) linkBlocks(c, d);
      }
    }
    return partitionOf(cube_of_, groups);
  }

 private:
  /// Least box around returns [m], and their longest link [m] in the last lane of `high`.
  struct Bounds {
    Float4 low, high;

    explicit Bounds(const LinkedReturn& r) : low(load<Float4>(&r.x)), high(low) {}
    void add(const Bounds& b) { low = smaller(low, b.low), high = larger(high, b.high); }
    /// False: no return in one is linked to one in the other.
    bool mayLink(const Bounds& b) const {
      const float link = std::min(high[3], b.high[3]);
      const Float4 apart = larger(larger(low - b.high, b.low - high), Float4{});
      const Float4 squares = apart * apart;
      return squares[0] + squares[1] + squares[2] <= link * link;
    }
  };

  static std::size_t slotsFor(std::size_t returns) {
    std::size_t slots = 64;  // small groups are many
    while (slots < 1024 && 4 * slots < returns) slots *= 2;
    return slots;
  }

  /// The blocks, which of their cubes have returns, and the place of each return among all cubes.
  void place() {
    constexpr std::size_t kPiece = 512;  // returns that fit in the L1 cache
    std::array<std::uint64_t, kPiece> block;
    std::array<std::uint32_t, kPiece> within;
    const std::uint32_t words = grid_.words();
    cube_of_.resize(returns_.size());
    std::uint64_t last_key = ~std::uint64_t{0};  // of none
    std::uint32_t first_word = 0;                ///< of the last block
    for (std::size_t first = 0; first < returns_.size(); first += kPiece) {
      const std::size_t count = std::min(kPiece, returns_.size() - first);
      grid_.placeAll(&returns_[first], count, block.data(), within.data());
      for (std::size_t k = 0; k < count; ++k) {
        if (block[k] != last_key) {  // neighbors in the scan are often in one block
          last_key = block[k];
          const std::uint32_t number = block_numbers_.add(last_key);
          if (number == block_key_.size()) {
            block_key_.push_back(last_key);
            used_.resize(used_.size() + words, 0);
          }
          first_word = words * number;
        }
        cube_of_[first + k] = 64 * first_word + within[k];
        used_[first_word + within[k] / 64] |= std::uint64_t{1} << within[k] % 64;
      }
    }
  }

  /// Numbers the cubes with returns, block by block, and counts these.
  void numberCubes() {
    const std::uint32_t words = grid_.words();
    const std::unique_ptr<std::uint32_t[]> number(new std::uint32_t[64 * used_.size()]);
    std::uint32_t count = 0;
    first_cube_.reserve(block_key_.size() + 1);
    for (std::size_t word = 0; word < used_.size(); ++word) {
      if (words == 1 || word % words == 0) first_cube_.push_back(count);
      for (std::uint64_t used = used_[word]; used != 0; used &= used - 1)
        number[64 * word + static_cast<std::size_t>(__builtin_ctzll(used))] = count++;
    }
    first_cube_.push_back(count);
    first_return_.assign(count + 1, 0);
    for (std::uint32_t& cube : cube_of_) cube = number[cube], ++first_return_[cube + 1];
  }

  void sortReturns() {
    std::partial_sum(first_return_.begin(), first_return_.end(), first_return_.begin());
    std::vector<std::uint32_t> next(first_return_.begin(), first_return_.end() - 1);
    sorted_.resize(returns_.size());
    for (std::size_t i = 0; i < returns_.size(); ++i) sorted_[next[cube_of_[i]]++] = returns_[i];
  }

  void bound() {
    bounds_.reserve(first_return_.size());
    for (std::size_t cube = 0; cube + 1 < first_return_.size(); ++cube) {
      Bounds bounds(sorted_[first_return_[cube]]);
      for (std::uint32_t i = first_return_[cube] + 1; i < first_return_[cube + 1]; ++i)
        bounds.add(Bounds(sorted_[i]));
      bounds_.push_back(bounds);
    }
    block_bounds_.reserve(block_key_.size());
    for (std::size_t c = 0; c < block_key_.size(); ++c) {
      Bounds bounds = bounds_[first_cube_[c]];
      for (std::uint32_t cube = first_cube_[c] + 1; cube < first_cube_[c + 1]; ++cube)
        bounds.add(bounds_[cube]);
      block_bounds_.push_back(bounds);
    }
  }

  bool near(std::uint32_t a, std::uint32_t b) const {
    if (!bounds_[a].mayLink(bounds_[b])) return false;
    for (std::uint32_t i = first_return_[a]; i < first_return_[a + 1]; ++i) {
      const LinkedReturn& r = sorted_[i];
      for (std::uint32_t j = first_return_[b]; j < first_return_[b + 1]; ++j) {
        if (linked(r, sorted_[j])) return true;
      }
    }
    return false;
  }

  /// Whether two groups became one.
  bool join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t one = groups_->find(a), other = groups_->find(b);
    if (one == other || !near(a, b)) return false;
    groups_->unite(one, other);
    return true;
  }

  /// Cubes with close numbers first, which often touch, until all are in one group.
  void linkWithin(std::uint32_t c) {
    const std::uint32_t first = first_cube_[c], end = first_cube_[c + 1];
    std::uint32_t parts = end - first;
    for (std::uint32_t step = 1; step < end - first && parts > 1; ++step)
      for (std::uint32_t i = first; i + step < end && parts > 1; ++i) parts -= join(i, i + step);
    uniform_[c] = parts == 1;
  }

  /// Whether all cubes of a block are in one group; once they are, they stay so.
  bool uniform(std::uint32_t c) {
    if (uniform_[c]) return true;
    const std::uint32_t first = groups_->find(first_cube_[c]);
    for (std::uint32_t i = first_cube_[c] + 1; i < first_cube_[c + 1]; ++i)
      if (groups_->find(i) != first) return false;
    uniform_[c] = 1;
    return true;
  }

  /// The cubes of block c that may be linked to some of block d.
  void facing(std::uint32_t c, std::uint32_t d, std::vector<std::uint32_t>& cubes) const {
    cubes.clear();
    for (std::uint32_t i = first_cube_[c]; i < first_cube_[c + 1]; ++i)
      if (bounds_[i].mayLink(block_bounds_[d])) cubes.push_back(i);
  }

  void linkBlocks(std::uint32_t c, std::uint32_t d) {
    if (!block_bounds_[c].mayLink(block_bounds_[d])) return;
    const bool whole = uniform(c) && uniform(d);
    const auto same = [&] {
      return groups_->find(first_cube_[c]) == groups_->find(first_cube_[d]);
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
  CubeGrid grid_{};
  KeyNumbers block_numbers_;
  std::vector<std::uint64_t> block_key_;
  std::vector<std::uint64_t> used_;          ///< [block][word] bits of its cubes with returns
  std::vector<std::uint32_t> cube_of_;       ///< of each return
  std::vector<std::uint32_t> first_cube_;    ///< of each block, and the end
  std::vector<std::uint32_t> first_return_;  ///< of each cube, and the end
  RawVector<LinkedReturn> sorted_;           ///< cube by cube
  std::vector<Bounds> bounds_, block_bounds_;
  std::vector<char> uniform_;  ///< known to be, of each block
  Forest* groups_ = nullptr;
  std::vector<std::uint32_t> of_one_, of_other_;  ///< cubes of two blocks that face each other
};

/// By looking at every pair.
Partition linkFew(const std::vector<LinkedReturn>& returns) {
  Forest groups(returns.size());
  for (std::uint32_t i = 1; i < returns.size(); ++i)
    for (std::uint32_t j = 0; j < i; ++j)
      if (linked(returns[i], returns[j])) groups.unite(i, j);
  std::vector<std::uint32_t> own(returns.size());
  std::iota(own.begin(), own.end(), 0u);
  return partitionOf(own, groups);
}

}  // namespace

Partition linkInSpace(const std::vector<LinkedReturn>& returns, float least, float most) {
  constexpr std::size_t kFew = 40;  // looking at all pairs is cheap (assumed)
  if (returns.size() <= kFew) return linkFew(returns);
  return CubeLinkage(returns, least, most).link();
}

}  // namespace perception
