#include "libperception/lidar/classification/TreesText.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace perception {
namespace {

constexpr std::size_t kMostNodes = 100000;

std::string shipped(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(std::string(PERCEPTION_SOURCE_DIR) + "/ini/models/" + name).rdbuf();
  return text.str();
}

/// The end of a file with six trees, the first one of these nodes.
std::string treesWith(const std::string& nodes) {
  std::string text = "{\n\"trees\":[\n{\"node\":" + nodes + "}";
  for (int i = 1; i < 6; ++i) text += ",\n{\"node\":[[0]]}";
  return text + "\n]}\n";
}

bool separates(const std::string& text) { return separateTrees(text, kMostNodes).has_value(); }

TEST(TreesText, AShippedModelIsThatOfTheSameJsonInAnotherLayout) {
  for (const char* name : {"lidar_simulated.json", "lidar_recordings.json"}) {
    const std::string text = shipped(name), other = nlohmann::json::parse(text).dump(1);
    ASSERT_TRUE(separates(text)) << name;
    ASSERT_FALSE(separates(other)) << name;
    const std::string written = ClusterClassifier::parse(text, name).write();
    EXPECT_EQ(written, ClusterClassifier::parse(other, name).write()) << name;
    EXPECT_EQ(written, text) << name;
  }
}

TEST(TreesText, GivesTheTreesAndTheTextWithoutThem) {
  const auto separate = separateTrees(treesWith("[[3,-1.5e0,1,2],[0.25],[7]]"), kMostNodes);
  ASSERT_TRUE(separate);
  EXPECT_EQ(separate->text, "{\n\"trees\":[]}");
  EXPECT_EQ(separate->trees.roots, (std::vector<std::int32_t>{0, 3, 4, 5, 6, 7}));
  ASSERT_EQ(separate->trees.nodes.size(), 8u);
  const auto& nodes = separate->trees.nodes;
  EXPECT_EQ(nodes[0].feature, 3);
  EXPECT_EQ(nodes[0].threshold, -1.5F);
  EXPECT_EQ(nodes[0].right, 2);
  EXPECT_EQ(nodes[1].feature, -1);
  EXPECT_EQ(nodes[1].threshold, 0.25F);
}

TEST(TreesText, LeavesToJsonWhatIsNotAsWritten) {
  for (const char* node : {"01", ".5", "1.", "1e", "+1", "inf", "nan", "--1", "1e999", "4e38", "",
                           "null", "\"1\"", "[1]", "1,2", "1 2", "0,.5,1,1"})
    EXPECT_FALSE(separates(treesWith("[[" + std::string(node) + "]]"))) << node;
  for (const char* nodes :
       {"[]", "[[0,1,1,2],[1]]", "[[0,1,0,1],[1]]", "[[52,1,1,1],[1]]", "[[0,1,1.0,1],[1]]",
        "[[-1,1,1,1],[1]]", "[[0,1,1,18446744073709551615],[1]]", "[[0]]]", "[[0]],\"a\":0"})
    EXPECT_FALSE(separates(treesWith(nodes))) << nodes;
  const std::string text = treesWith("[[0]]");
  ASSERT_TRUE(separates(text));
  EXPECT_FALSE(separates(text + "x"));
  EXPECT_FALSE(separates("{\n\"trees\":[]}"));
  for (std::size_t size = 0; size + 2 < text.size(); ++size)
    EXPECT_FALSE(separates(text.substr(0, size))) << size;
  EXPECT_FALSE(separateTrees(text, 5));
}

}  // namespace
}  // namespace perception
