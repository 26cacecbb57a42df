#include "libperception/weather/NeighborTree.h"

#include <algorithm>
#include <nanoflann.hpp>

namespace perception {
namespace {

/// The scan as nanoflann wants to see it.
struct CloudAdaptor {
  const LidarCloud& cloud;
  std::size_t kdtree_get_point_count() const { return cloud.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return axis == 0 ? cloud.x[i] : axis == 1 ? cloud.y[i] : cloud.z[i];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudAdaptor>,
                                                 CloudAdaptor, 3, std::uint32_t>;

}  // namespace

struct NeighborTree::Impl {
  explicit Impl(const LidarCloud& cloud) : adaptor{cloud}, tree(3, adaptor, {10}) {
    tree.buildIndex();
  }
  CloudAdaptor adaptor;
  Tree tree;
};

NeighborTree::NeighborTree(const LidarCloud& cloud) : impl_(std::make_unique<Impl>(cloud)) {}
NeighborTree::~NeighborTree() = default;

void NeighborTree::nearest(std::size_t i, std::size_t count, std::vector<float>& squared) const {
  const LidarCloud& cloud = impl_->adaptor.cloud;
  const float query[3] = {cloud.x[i], cloud.y[i], cloud.z[i]};
  std::vector<std::uint32_t> indices(count + 1);
  squared.resize(count + 1);
  const std::size_t found = impl_->tree.knnSearch(query, count + 1, indices.data(), squared.data());
  squared.resize(found);
  if (!squared.empty()) squared.erase(squared.begin());  // the return itself
}

bool NeighborTree::hasWithin(std::size_t i, double radius, std::size_t count) const {
  std::vector<float> squared;
  nearest(i, count, squared);
  return squared.size() == count && squared.back() <= static_cast<float>(radius * radius);
}

}  // namespace perception
