#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include "libperception/lidar/classification/ClusterClassifier.h"

namespace perception {

/// A classifier's file without its trees, and these.
struct TextWithoutTrees {
  std::string text;  ///< with an empty array of trees
  BoostedTrees trees;
};

/// Reads the trees from a file of the layout of ClusterClassifier::write(), where they are last and
/// nearly all of it, without JSON values in between: the file takes a sixth of the work. Nothing
/// where the layout is another one, or where a tree breaks a rule or has more than `most_nodes`
/// with those before it: whoever reads it as JSON says what is wrong.
std::optional<TextWithoutTrees> separateTrees(const std::string& text, std::size_t most_nodes);

}  // namespace perception
