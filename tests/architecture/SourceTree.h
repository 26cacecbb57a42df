#pragma once
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace perception::test {

/// A file of the repository: path from its root, content.
struct SourceFile {
  std::string path, text;

  bool isHeader() const { return std::filesystem::path(path).extension() == ".h"; }
  bool isSource() const { return std::filesystem::path(path).extension() == ".cpp"; }
  std::string name() const { return std::filesystem::path(path).filename().string(); }
};

/// One #include line of a file.
struct Include {
  std::string path;
  bool quoted = false;
  int line = 0;
};

inline std::string readWhole(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// All files below `folder` (from the root) without build folders, results and git's own: a folder,
/// or a file where several checkouts share one.
inline std::vector<SourceFile> filesBelow(const std::string& folder) {
  const std::filesystem::path root(PERCEPTION_SOURCE_DIR);
  std::vector<SourceFile> files;
  if (!std::filesystem::exists(root / folder)) return files;
  for (auto i = std::filesystem::recursive_directory_iterator(root / folder);
       i != std::filesystem::recursive_directory_iterator(); ++i) {
    const std::string path = i->path().lexically_relative(root).generic_string();
    const std::string name = i->path().filename().string();
    const bool top = path.find('/') == std::string::npos;
    if (i->is_directory() &&
        (name == ".git" || (top && (name.rfind("build", 0) == 0 || name == "out")))) {
      i.disable_recursion_pending();
    } else if (i->is_regular_file() && name != ".git") {
      files.push_back({path, readWhole(i->path())});
    }
  }
  return files;
}

inline std::vector<Include> includesOf(const SourceFile& file) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
  std::vector<Include> includes;
  std::istringstream in(file.text);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, pattern))
      includes.push_back({match[2], match[1] == "\"", number});
  }
  return includes;
}

/// The first folders of the path, up to `count`: ("libperception/core/math/Angle.h", 2) is
/// "libperception/core".
inline std::string firstFolders(const std::string& path, int count) {
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) {
    const std::size_t slash = path.find('/', i == 0 ? 0 : end + 1);
    if (slash == std::string::npos) break;
    end = slash;
  }
  return path.substr(0, end);
}

}  // namespace perception::test
