#include "libperception/grid/stores/GridOctomap.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/grid/stores/ScanEvidence.h"

namespace perception {
namespace {

// A cell with the time of its last change. (OctoMap's OcTreeStamped uses the wall clock, in
// seconds.)
class StampedNode : public octomap::OcTreeNode {
 public:
  std::uint32_t ms : 31;     // time since the grid's first scan
  std::uint32_t listed : 1;  // among GridOctomap::listed_

  StampedNode() : ms(0), listed(0) {}

  // OctoMap's deleteNode() keeps the array of deleted children and asserts on it later.
  void freeChildren() {
    delete[] children;
    children = nullptr;
  }
};

class StampedTree : public octomap::OccupancyOcTreeBase<StampedNode> {
 public:
  explicit StampedTree(double resolution) : octomap::OccupancyOcTreeBase<StampedNode>(resolution) {}
  StampedTree* create() const override { return new StampedTree(resolution); }
  std::string getTreeType() const override { return "OcTree"; }
};

constexpr octomap::key_type kMiddle = 32768;  // key of the tree's center: 16 bits per axis

constexpr int kDepth = 16;  // levels of the tree below its root

// Traverses the tree along neighboring keys, descending only the levels that differ: search() from
// the root per cell is several times slower.
class TreeCursor {
 public:
  explicit TreeCursor(StampedTree& tree) : tree_(tree) {
    if (!tree.getRoot())
      tree.setNodeValue(octomap::OcTreeKey(kMiddle, kMiddle, kMiddle), 0.0F, true);
    path_[0] = tree.getRoot();
  }

  // The node of the cell; if missing, a new unknown one (`create`) or null.
  StampedNode* at(const octomap::OcTreeKey& key, bool create) {
    while (depth_ > 0 && !sameBranch(key)) --depth_;
    key_ = key;
    for (; depth_ < kDepth; ++depth_) {
      const unsigned child = octomap::computeChildIdx(key, kDepth - 1 - depth_);
      StampedNode* node = path_[depth_];
      const bool there = tree_.nodeChildExists(node, child);
      if (!there && !create) return nullptr;
      path_[depth_ + 1] =
          there ? tree_.getNodeChild(node, child) : tree_.createNodeChild(node, child);
    }
    return path_[kDepth];
  }

 private:
  bool sameBranch(const octomap::OcTreeKey& key) const {
    const int shift = kDepth - depth_;
    return (key[0] ^ key_[0]) >> shift == 0 && (key[1] ^ key_[1]) >> shift == 0 &&
           (key[2] ^ key_[2]) >> shift == 0;
  }

  StampedTree& tree_;
  StampedNode* path_[kDepth + 1] = {};
  int depth_ = 0;  // depth down to which path_ is valid
  octomap::OcTreeKey key_;
};

constexpr std::uint32_t kLatestMs = 0x7fffffff;  // largest time in a node: 24 days
constexpr double kForgotten = 0.05;              // [log-odds] below it a cell is unknown
constexpr std::int64_t kSweepMs = 1000;          // between removals of decayed and outside cells
constexpr std::int64_t kReach = 30000;  // cells from the center at which the tree is rebuilt

class GridOctomap final : public SafetyGrid {
 public:
  explicit GridOctomap(const GridParams& params)
      : SafetyGrid(params), evidence_(params, false), tree_(newTree()) {}

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    TreeCursor cursor(*tree_);
    for (const CellEvidence& cell : evidence_.collect(scan, stats)) {
      const octomap::OcTreeKey key = keyOf(cell.cell);
      StampedNode* node = cursor.at(key, true);
      add(*node, key, cell.logOdds(params(), decayed(*node)));
    }
    if (now_ms_ - swept_ms_ >= kSweepMs) sweep();
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite() || !inWindow(place)) return 0;
    const StampedNode* node = tree_->search(keyOf(cellOf(place)));
    const double log_odds = node ? decayed(*node) : 0;
    return std::abs(log_odds) < kForgotten ? 0 : log_odds;
  }

  // Uses the list of candidates: the tree holds about a hundred thousand free cells.
  std::vector<GridCell> occupiedWithin(const GridArea& area) const override {
    std::vector<GridCell> cells;
    for (const octomap::OcTreeKey& key : listed_) {
      const StampedNode* node = tree_->search(key);
      const double log_odds = node ? decayed(*node) : 0;
      const Vector3 center = centerOf(key);
      if (log_odds > params().occupied && inWindow(center) && area.holds(center)) {
        cells.push_back({center, Vector3::Constant(params().resolution), log_odds});
      }
    }
    return cells;
  }

  std::vector<GridCell> knownCells() const override {
    std::vector<GridCell> cells;
    for (auto leaf = tree_->begin_leafs(), end = tree_->end_leafs(); leaf != end; ++leaf) {
      const Vector3 center = centerOf(leaf.getKey());
      const double log_odds = decayed(*leaf);
      if (leaf.getDepth() == kDepth && std::abs(log_odds) >= kForgotten && inWindow(center))
        cells.push_back({center, Vector3::Constant(params().resolution), log_odds});
    }
    return cells;
  }

  void restore(const std::vector<GridCell>& cells) override {
    TreeCursor cursor(*tree_);
    for (const GridCell& cell : cells) {
      if (!inWindow(cell.center)) continue;
      const octomap::OcTreeKey key = keyOf(cellOf(cell.center));
      add(*cursor.at(key, true), key, cell.log_odds);
    }
  }

  std::size_t memoryBytes() const override {
    return tree_->memoryUsage() + evidence_.memoryBytes() +
           listed_.capacity() * sizeof(octomap::OcTreeKey);
  }

 private:
  std::unique_ptr<StampedTree> newTree() const {
    return std::make_unique<StampedTree>(params().resolution);
  }

  // Advances time and window.
  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 center = scan.T_world_ground.translation();
    const CellIndex cell = cellOf(center);
    evidence_.moveTo(scan);
    if (!started_) {
      first_ = scan.stamp;
      anchor_ = cell;
      started_ = true;
    }
    const auto ms = static_cast<std::int64_t>(std::llround((scan.stamp - first_) * 1000));
    stats.late = ms < now_ms_;
    now_ms_ = std::max(now_ms_, ms);
    if (now_ms_ > kLatestMs || std::max({std::abs(cell.x - anchor_.x), std::abs(cell.y - anchor_.y),
                                         std::abs(cell.z - anchor_.z)}) > kReach) {
      restartAt(cell, scan.stamp);
    }
  }

  // Keys and times of cells overflow after kilometers or days: builds a new tree around the vehicle
  // with the known cells.
  void restartAt(const CellIndex& cell, Stamp stamp) {
    std::vector<GridCell> kept;
    for (auto leaf = tree_->begin_leafs(), end = tree_->end_leafs(); leaf != end; ++leaf) {
      kept.push_back({centerOf(leaf.getKey()), Vector3::Zero(), decayed(*leaf)});
    }
    listed_.clear();
    tree_ = newTree();
    anchor_ = cell;
    first_ = stamp;
    now_ms_ = swept_ms_ = 0;
    TreeCursor cursor(*tree_);
    for (const GridCell& old : kept) {
      if (!inWindow(old.center)) continue;
      const octomap::OcTreeKey key = keyOf(cellOf(old.center));
      add(*cursor.at(key, true), key, old.log_odds);
    }
  }

  void add(StampedNode& node, const octomap::OcTreeKey& key, double log_odds) {
    const double after = std::clamp(decayed(node) + log_odds, params().low, params().high);
    node.setLogOdds(static_cast<float>(after));
    node.ms = static_cast<std::uint32_t>(now_ms_) & kLatestMs;
    list(node, key);
  }

  // Decay and misses only lower the log-odds, so the list contains all occupied cells.
  void list(StampedNode& node, const octomap::OcTreeKey& key) {
    if (node.listed || node.getLogOdds() <= params().occupied) return;
    node.listed = 1;
    listed_.push_back(key);
  }

  double decayed(const StampedNode& node) const {
    const double age = static_cast<double>(now_ms_ - static_cast<std::int64_t>(node.ms)) / 1000;
    return static_cast<double>(node.getLogOdds()) * std::exp(-age / params().tau);
  }

  // Bounds memory: the tree itself has neither window nor decay.
  void sweep() {
    swept_ms_ = now_ms_;
    listed_.clear();
    if (StampedNode* root = tree_->getRoot(); root && sweep(*root, {0, 0, 0}, 0)) tree_->clear();
  }

  // Removes decayed and outside cells below a node; `corner`: its lowest key. True when none is
  // left.
  bool sweep(StampedNode& node, const std::array<int, 3>& corner, int depth) {
    if (depth == kDepth) {
      const octomap::OcTreeKey key = keyOfCorner(corner);
      node.listed = 0;
      if (std::abs(decayed(node)) < kForgotten || !inWindow(centerOf(key))) return true;
      list(node, key);
      return false;
    }
    bool empty = true;
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree_->nodeChildExists(&node, i)) continue;
      if (sweep(*tree_->getNodeChild(&node, i), childCorner(corner, depth, i), depth + 1)) {
        tree_->deleteNodeChild(&node, i);
      } else {
        empty = false;
      }
    }
    if (empty) node.freeChildren();
    return empty;
  }

  static octomap::OcTreeKey keyOfCorner(const std::array<int, 3>& corner) {
    return {static_cast<octomap::key_type>(corner[0]), static_cast<octomap::key_type>(corner[1]),
            static_cast<octomap::key_type>(corner[2])};
  }
  static std::array<int, 3> childCorner(const std::array<int, 3>& corner, int depth, unsigned i) {
    const int half = 1 << (kDepth - 1 - depth);
    return {corner[0] + (i & 1 ? half : 0), corner[1] + (i & 2 ? half : 0),
            corner[2] + (i & 4 ? half : 0)};
  }

  bool inWindow(const Vector3& place) const { return evidence_.holds(cellOf(place)); }

  CellIndex cellOf(const Vector3& place) const {
    return {evidence_.indexOf(place.x()), evidence_.indexOf(place.y()),
            evidence_.indexOf(place.z())};
  }

  // Relative to the anchor: keys have 16 bits, world coordinates may be hundreds of kilometers.
  octomap::OcTreeKey keyOf(const CellIndex& cell) const {
    const auto key = [](std::int64_t i) {
      return static_cast<octomap::key_type>(std::clamp<std::int64_t>(i + kMiddle, 0, 65535));
    };
    return {key(cell.x - anchor_.x), key(cell.y - anchor_.y), key(cell.z - anchor_.z)};
  }
  Vector3 centerOf(const octomap::OcTreeKey& key) const {
    return {evidence_.centerOf(key[0] - kMiddle + anchor_.x),
            evidence_.centerOf(key[1] - kMiddle + anchor_.y),
            evidence_.centerOf(key[2] - kMiddle + anchor_.z)};
  }

  ScanEvidence evidence_;
  std::unique_ptr<StampedTree> tree_;
  std::vector<octomap::OcTreeKey> listed_;  // all occupied cells and some former ones
  bool started_ = false;
  Stamp first_;                             // time 0 of the cells
  std::int64_t now_ms_ = 0, swept_ms_ = 0;  // since first_
  CellIndex anchor_;                        // cell of the tree's center
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridOctomap(const GridParams& params) {
  return std::make_unique<GridOctomap>(params);
}

}  // namespace perception
