#include "libperception/grid/GridOctomap.h"

#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libperception/grid/ScanEvidence.h"

namespace perception {
namespace {

// A cell with the time of its last change. (OctoMap's own OcTreeStamped takes the wall clock, in
// seconds.)
class StampedNode : public octomap::OcTreeNode {
 public:
  std::int32_t ms = 0;  // since the grid's first scan

  // OctoMap's deleteNode() leaves the array of deleted children behind and asserts on it later.
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

constexpr octomap::key_type kMiddle = 32768;  // key of the tree's centre: 16 bits per axis

// Walks the tree along neighbouring keys: only the levels that differ are descended again, since
// search() from the root for each cell would take the time of several scans.
class TreeCursor {
 public:
  explicit TreeCursor(StampedTree& tree) : tree_(tree) {
    if (!tree.getRoot())
      tree.setNodeValue(octomap::OcTreeKey(kMiddle, kMiddle, kMiddle), 0.0F, true);
    path_[0] = tree.getRoot();
  }

  // The cell's node; where there is none, a new unknown one or null.
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

  static constexpr int kDepth = 16;
  StampedTree& tree_;
  StampedNode* path_[kDepth + 1] = {};
  int depth_ = 0;  // down to which path_ holds
  octomap::OcTreeKey key_;
};

constexpr double kForgotten = 0.1;       // [log-odds] of a cell that is as good as unknown
constexpr std::int64_t kSweepMs = 1000;  // between removals of what is forgotten or outside
constexpr std::int64_t kReach = 30000;   // cells from the centre at which the tree is moved

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
      // Beams make free cells only in the slab itself, where they bear on driving.
      const bool create = cell.weight > 0 || cell.relevant;
      if (StampedNode* node = cursor.at(keyOf(cell.cell), create))
        add(*node, cell.logOdds(params()));
    }
    if (now_ms_ - swept_ms_ >= kSweepMs) sweep();
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite() || !inWindow(place)) return 0;
    const StampedNode* node =
        tree_->search(keyOf({evidence_.indexOf(place.x()), evidence_.indexOf(place.y()),
                             evidence_.indexOf(place.z())}));
    return node ? decayed(*node) : 0;
  }

  std::vector<GridCell> occupiedCells() const override {
    std::vector<GridCell> cells;
    for (auto leaf = tree_->begin_leafs(), end = tree_->end_leafs(); leaf != end; ++leaf) {
      const double log_odds = decayed(*leaf);
      if (log_odds <= params().occupied) continue;
      const Vector3 centre = centreOf(leaf.getKey());
      if (inWindow(centre)) {
        cells.push_back({centre, Vector3::Constant(params().resolution), log_odds});
      }
    }
    return cells;
  }

  std::size_t memoryBytes() const override {
    return tree_->memoryUsage() + evidence_.memoryBytes();
  }

 private:
  std::unique_ptr<StampedTree> newTree() const {
    return std::make_unique<StampedTree>(params().resolution);
  }

  // Moves the clock and the window.
  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 centre = scan.T_world_ground.translation();
    const CellIndex cell = {evidence_.indexOf(centre.x()), evidence_.indexOf(centre.y()),
                            evidence_.indexOf(centre.z())};
    if (!started_) {
      first_ = scan.stamp;
      anchor_ = cell;
      started_ = true;
    }
    const auto ms = static_cast<std::int64_t>(std::llround((scan.stamp - first_) * 1000));
    stats.late = ms < now_ms_;
    now_ms_ = std::max(now_ms_, ms);
    centre_ = centre;
    if (now_ms_ > std::numeric_limits<std::int32_t>::max() ||
        std::max({std::abs(cell.x - anchor_.x), std::abs(cell.y - anchor_.y),
                  std::abs(cell.z - anchor_.z)}) > kReach) {
      restartAt(cell, scan.stamp);
    }
  }

  // The keys and the cells' times are used up after hours or kilometres: a new tree around the
  // vehicle, with what it remembers.
  void restartAt(const CellIndex& cell, Stamp stamp) {
    std::vector<GridCell> kept;
    for (auto leaf = tree_->begin_leafs(), end = tree_->end_leafs(); leaf != end; ++leaf) {
      kept.push_back({centreOf(leaf.getKey()), Vector3::Zero(), decayed(*leaf)});
    }
    tree_ = newTree();
    anchor_ = cell;
    first_ = stamp;
    now_ms_ = swept_ms_ = 0;
    TreeCursor cursor(*tree_);
    for (const GridCell& old : kept) {
      if (!inWindow(old.centre)) continue;
      add(*cursor.at(keyOf({evidence_.indexOf(old.centre.x()), evidence_.indexOf(old.centre.y()),
                            evidence_.indexOf(old.centre.z())}),
                     true),
          old.log_odds);
    }
  }

  void add(StampedNode& node, double log_odds) const {
    const double after = std::clamp(decayed(node) + log_odds, params().low, params().high);
    node.setLogOdds(static_cast<float>(after));
    node.ms = static_cast<std::int32_t>(now_ms_);
  }

  double decayed(const StampedNode& node) const {
    const double age = static_cast<double>(now_ms_ - node.ms) / 1000;
    return static_cast<double>(node.getLogOdds()) * std::exp(-age / params().tau);
  }

  // Bounds memory: the tree itself has no window and never forgets.
  void sweep() {
    swept_ms_ = now_ms_;
    if (StampedNode* root = tree_->getRoot(); root && sweep(*root, {0, 0, 0}, 0)) tree_->clear();
  }

  // Removes what is forgotten or outside below a node; `corner`: its lowest key. True: nothing is
  // left.
  bool sweep(StampedNode& node, const std::array<int, 3>& corner, int depth) {
    constexpr int kDepth = 16;
    if (depth == kDepth) {
      const Vector3 centre = centreOf({static_cast<octomap::key_type>(corner[0]),
                                       static_cast<octomap::key_type>(corner[1]),
                                       static_cast<octomap::key_type>(corner[2])});
      return std::abs(decayed(node)) < kForgotten || !inWindow(centre);
    }
    bool empty = true;
    const int half = 1 << (kDepth - 1 - depth);
    for (unsigned i = 0; i < 8; ++i) {
      if (!tree_->nodeChildExists(&node, i)) continue;
      const std::array<int, 3> child = {corner[0] + (i & 1 ? half : 0),
                                        corner[1] + (i & 2 ? half : 0),
                                        corner[2] + (i & 4 ? half : 0)};
      if (sweep(*tree_->getNodeChild(&node, i), child, depth + 1)) {
        tree_->deleteNodeChild(&node, i);
      } else {
        empty = false;
      }
    }
    if (empty) node.freeChildren();
    return empty;
  }

  bool inWindow(const Vector3& place) const {
    const Vector3 d = place - centre_;
    return std::max(std::abs(d.x()), std::abs(d.y())) <= params().size / 2;
  }

  // Relative to the anchor: keys have 16 bits, worlds may have coordinates of hundreds of
  // kilometres.
  octomap::OcTreeKey keyOf(const CellIndex& cell) const {
    const auto key = [](std::int64_t i) {
      return static_cast<octomap::key_type>(std::clamp<std::int64_t>(i + kMiddle, 0, 65535));
    };
    return {key(cell.x - anchor_.x), key(cell.y - anchor_.y), key(cell.z - anchor_.z)};
  }
  Vector3 centreOf(const octomap::OcTreeKey& key) const {
    return {evidence_.centreOf(key[0] - kMiddle + anchor_.x),
            evidence_.centreOf(key[1] - kMiddle + anchor_.y),
            evidence_.centreOf(key[2] - kMiddle + anchor_.z)};
  }

  ScanEvidence evidence_;
  std::unique_ptr<StampedTree> tree_;
  bool started_ = false;
  Stamp first_;                             // time 0 of the cells
  std::int64_t now_ms_ = 0, swept_ms_ = 0;  // since first_
  CellIndex anchor_;                        // cell of the tree's centre
  Vector3 centre_ = Vector3::Zero();        // [m] of the window, world
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridOctomap(const GridParams& params) {
  return std::make_unique<GridOctomap>(params);
}

}  // namespace perception
