#include "libperception/lidar/classification/TreesText.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace perception {
namespace {

constexpr std::string_view kTrees = "\n\"trees\":[";  // no text of JSON holds a line's end

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Reads trees, token by token; each function returns false at what it does not expect.
class TreeReader {
 public:
  TreeReader(std::string_view text, std::size_t most_nodes, BoostedTrees& trees)
      : at_(text.data()), end_(at_ + text.size()), most_nodes_(most_nodes), trees_(trees) {}

  bool read() {
    do {
      if (!readTree()) return false;
    } while (take(','));
    return take(']') && take('}') && (skipSpace(), at_ == end_) &&
           trees_.roots.size() % kClusterKinds == 0;
  }

 private:
  struct Number {
    double value = 0;
    bool whole = false;  ///< digits alone
  };

  void skipSpace() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\n' || *at_ == '\r' || *at_ == '\t')) ++at_;
  }
  bool take(char c) {
    skipSpace();
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  bool take(std::string_view word) {
    skipSpace();
    if (std::string_view(at_, static_cast<std::size_t>(end_ - at_)).substr(0, word.size()) != word)
      return false;
    at_ += word.size();
    return true;
  }
  bool takeDigits() {
    const char* const begin = at_;
    while (at_ < end_ && isDigit(*at_)) ++at_;
    return at_ > begin;
  }

  /// JSON's numbers: -12, 0.5, 1e-7; not 012, .5, 1., inf.
  bool takeNumber(Number& number) {
    skipSpace();
    const char* const begin = at_;
    if (at_ < end_ && *at_ == '-') ++at_;
    const char* const digits = at_;
    if (!takeDigits() || (*digits == '0' && at_ > digits + 1)) return false;
    number.whole = digits == begin;
    if (at_ < end_ && *at_ == '.') {
      ++at_, number.whole = false;
      if (!takeDigits()) return false;
    }
    if (at_ < end_ && (*at_ == 'e' || *at_ == 'E')) {
      ++at_, number.whole = false;
      if (at_ < end_ && (*at_ == '+' || *at_ == '-')) ++at_;
      if (!takeDigits()) return false;
    }
    return std::from_chars(begin, at_, number.value).ec == std::errc();
  }
  /// A whole number below `limit`.
  template <typename Integer>
  bool takeIndex(std::size_t limit, Integer& index) {
    Number number;
    if (!takeNumber(number) || !number.whole || number.value >= static_cast<double>(limit))
      return false;
    index = static_cast<Integer>(number.value);
    return true;
  }

  bool readTree() {
    const std::size_t root = trees_.nodes.size();
    trees_.roots.push_back(static_cast<std::int32_t>(root));
    if (!take('{') || !take("\"node\"") || !take(':') || !take('[')) return false;
    do {
      if (!readNode(root)) return false;
    } while (take(','));
    return take(']') && take('}') && childrenFollow(root);
  }

  bool readNode(std::size_t root) {
    constexpr double kMost = 3e38;  // of float
    BoostedTrees::Node node;
    Number first;
    if (trees_.nodes.size() == most_nodes_ || !take('[') || !takeNumber(first)) return false;
    if (take(',')) {
      if (!first.whole || first.value >= static_cast<double>(kFeatures)) return false;
      node.feature = static_cast<std::int16_t>(first.value);
      if (!takeNumber(first) || !take(',') || !takeIndex(most_nodes_, node.left) || !take(',') ||
          !takeIndex(most_nodes_, node.right))
        return false;
      node.left += static_cast<std::int32_t>(root), node.right += static_cast<std::int32_t>(root);
    }
    if (!take(']') || std::abs(first.value) > kMost) return false;
    node.threshold = static_cast<float>(first.value);
    trees_.nodes.push_back(node);
    return true;
  }

  /// Those of each node of the last tree come after it, in the same tree.
  bool childrenFollow(std::size_t root) const {
    const auto count = static_cast<std::int32_t>(trees_.nodes.size());
    for (auto self = static_cast<std::int32_t>(root); self < count; ++self) {
      const BoostedTrees::Node& node = trees_.nodes[static_cast<std::size_t>(self)];
      if (node.feature < 0) continue;
      for (const std::int32_t child : {node.left, node.right})
        if (child <= self || child >= count) return false;
    }
    return true;
  }

  const char* at_;
  const char* const end_;
  const std::size_t most_nodes_;
  BoostedTrees& trees_;
};

}  // namespace

std::optional<TextWithoutTrees> separateTrees(const std::string& text, std::size_t most_nodes) {
  const std::size_t begin = text.find(kTrees);
  if (begin == std::string::npos) return std::nullopt;
  const std::size_t after = begin + kTrees.size();
  TextWithoutTrees out;
  if (!TreeReader(std::string_view(text).substr(after), most_nodes, out.trees).read())
    return std::nullopt;
  out.text = text.substr(0, after) + "]}";
  return out;
}

}  // namespace perception
