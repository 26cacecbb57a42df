#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "tests/architecture/SourceTree.h"

// Ceilings that keep the tree small: lines of a file, files of a folder, lines of product code.
// limits.txt lists what is above its ceiling today, and the budget of product code. The numbers
// there may only fall. After a change that made something smaller:
//   PERCEPTION_WRITE_LIMITS=1 build/bin/architecture_tests --gtest_filter='Limits.*'
namespace perception::test {
namespace {

constexpr int kLinesOfAFile = 300, kFilesOfAFolder = 20;

/// Numbers by name: of files (their name, so that a file may move) and of folders (their path).
using Numbers = std::map<std::string, int>;

struct Limits {
  int product = 0;  ///< lines
  Numbers files, folders;
};

int lineCount(const SourceFile& file) {
  return static_cast<int>(std::count(file.text.begin(), file.text.end(), '\n'));
}

bool isWrittenByHand(const SourceFile& file) {
  const std::string kind = std::filesystem::path(file.path).extension().string();
  const bool code = file.isSource() || file.isHeader() || kind == ".py" || kind == ".sh" ||
                    kind == ".cmake" || kind == ".js";
  return code && file.path != "gui-offscreen/page/bundle/page.js";
}

bool isProduct(const SourceFile& file) {
  const std::string folder = firstFolders(file.path, 1);
  return (file.isSource() || file.isHeader()) &&
         (folder == "libperception" || folder == "gui-offscreen" || folder == "studies" ||
          folder == "apps");
}

/// What the tree has: lines of product code, files and folders above their ceilings. A folder's
/// README does not count.
Limits measured(const std::vector<SourceFile>& tree) {
  Limits now;
  Numbers folders;
  for (const SourceFile& file : tree) {
    if (file.path.find("__pycache__") != std::string::npos) continue;
    if (file.name() != "README.md")
      ++folders[std::filesystem::path(file.path).parent_path().generic_string()];
    if (isProduct(file)) now.product += lineCount(file);
    if (!isWrittenByHand(file) || lineCount(file) <= kLinesOfAFile) continue;
    int& lines = now.files[file.name()];
    lines = std::max(lines, lineCount(file));
  }
  for (const auto& [folder, files] : folders) {
    if (files > kFilesOfAFolder) now.folders[folder] = files;
  }
  return now;
}

Limits limitsOf(const std::string& text) {
  Limits limits;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind, name;
    int number = 0;
    if (!(words >> kind >> number)) continue;
    words >> name;
    if (kind == "product") limits.product = number;
    if (kind == "file") limits.files[name] = number;
    if (kind == "folder") limits.folders[name] = number;
  }
  return limits;
}

/// Entries above the number that is listed, or above the ceiling and not listed; entries of the
/// list that are no longer needed.
std::vector<std::string> excesses(const Numbers& now, const Numbers& listed, int ceiling) {
  std::vector<std::string> faults;
  for (const auto& [name, number] : now) {
    const auto entry = listed.find(name);
    const int limit = entry == listed.end() ? ceiling : entry->second;
    if (number > limit)
      faults.push_back(name + ": " + std::to_string(number) + ", the limit is " +
                       std::to_string(limit));
  }
  for (const auto& entry : listed) {
    if (now.count(entry.first) == 0)
      faults.push_back(entry.first + ": below the ceiling now, take it off the list");
  }
  return faults;
}

std::string listOf(const char* kind, const Numbers& now, const Numbers& listed) {
  std::string text;
  for (const auto& [name, limit] : listed) {
    const auto entry = now.find(name);
    if (entry == now.end()) continue;
    text += std::string(kind) + " " + std::to_string(std::min(entry->second, limit)) + " " + name +
            "\n";
  }
  return text;
}

std::filesystem::path limitsPath() {
  return std::filesystem::path(PERCEPTION_SOURCE_DIR) / "tests/architecture/limits.txt";
}

/// The comments of the file, and its numbers lowered to those of today.
std::string lowered(const std::string& text, const Limits& now) {
  const Limits listed = limitsOf(text);
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') out += line + "\n";
  }
  return out + "product " + std::to_string(std::min(now.product, listed.product)) + "\n" +
         listOf("folder", now.folders, listed.folders) + listOf("file", now.files, listed.files);
}

TEST(Limits, FilesFoldersAndProductCodeOnlyShrink) {
  const Limits now = measured(filesBelow(""));
  if (std::getenv("PERCEPTION_WRITE_LIMITS") != nullptr) {
    const std::string text = lowered(readWhole(limitsPath()), now);
    std::ofstream(limitsPath(), std::ios::binary) << text;
  }
  const Limits listed = limitsOf(readWhole(limitsPath()));
  ASSERT_GT(listed.product, 0);
  EXPECT_LE(now.product, listed.product)
      << "lines of product code; raise the budget only in a commit that says why";
  for (const std::string& fault : excesses(now.files, listed.files, kLinesOfAFile))
    ADD_FAILURE() << "lines of a file: " << fault;
  for (const std::string& fault : excesses(now.folders, listed.folders, kFilesOfAFolder))
    ADD_FAILURE() << "files of a folder: " << fault;
}

TEST(Limits, ALongFileAndAWideFolderAreFound) {
  std::vector<SourceFile> tree = {{"libperception/core/Long.cpp", std::string(301, '\n')},
                                  {"tests/core/Short.cpp", std::string(300, '\n')}};
  for (int i = 0; i < 21; ++i) tree.push_back({"ini/" + std::to_string(i) + ".ini", "\n"});
  const Limits now = measured(tree);
  EXPECT_EQ(now.product, 301);
  EXPECT_EQ(now.files, (Numbers{{"Long.cpp", 301}}));
  EXPECT_EQ(now.folders, (Numbers{{"ini", 21}}));
}

TEST(Limits, AnEntryMayFallAndNotRise) {
  const Numbers listed = {{"a.cpp", 400}};
  EXPECT_TRUE(excesses({{"a.cpp", 399}}, listed, 300).empty());
  EXPECT_EQ(excesses({{"a.cpp", 401}}, listed, 300).size(), 1u);
  EXPECT_EQ(excesses({{"a.cpp", 400}, {"b.cpp", 301}}, listed, 300).size(), 1u);
  EXPECT_EQ(excesses({}, listed, 300).size(), 1u) << "an entry that is not needed";
}

TEST(Limits, WritingLowersNumbersAndKeepsComments) {
  const std::string before = "# why\nproduct 100\nfolder 30 ini\nfile 400 a.cpp\nfile 350 b.cpp\n";
  const Limits now = {90, {{"a.cpp", 410}}, {{"ini", 25}}};
  EXPECT_EQ(lowered(before, now), "# why\nproduct 90\nfolder 25 ini\nfile 400 a.cpp\n");
}

}  // namespace
}  // namespace perception::test
