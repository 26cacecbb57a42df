#pragma once
#include <algorithm>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/architecture/SourceTree.h"

namespace perception::test {

inline constexpr const char* kProduct[] = {"libperception", "gui-offscreen", "studies"};

/// A line v.real("key", member, ...) of a visit().
struct VisitedKey {
  std::string folder, file, owner, key, member;  // owner: the struct that is visited
  bool expert = false;
};

/// The code without what stands behind // in its lines.
inline std::string withoutComments(const std::string& text) {
  std::string out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::size_t comment = line.find("//");
    // An address in a string is no comment.
    out += comment != std::string::npos && (comment == 0 || line[comment - 1] != ':')
               ? line.substr(0, comment)
               : line;
    out += '\n';
  }
  return out;
}

/// Where the block that holds `at` ends.
inline std::size_t endOfBlock(const std::string& code, std::size_t at) {
  int depth = 0;
  bool quoted = false;
  for (; at < code.size(); ++at) {
    const char c = code[at];
    if (c == '"' && code[at - 1] != '\\') quoted = !quoted;
    if (quoted) continue;
    if (c == '{') ++depth;
    if (c == '}' && --depth < 0) break;
  }
  return at;
}

inline std::vector<VisitedKey> keysOf(const SourceFile& file) {
  static const std::regex visit(
      R"re(\bv\.(?:real|angle|integer|unsigned64|boolean|text|path|reals|words|choice|choiceOf|table)\(\s*"([^"]+)",\s*([\w.]*))re");
  static const std::regex owner(R"re((\w+)::visit\(ParamVisitor)re");
  const std::string code = withoutComments(file.text);
  std::vector<std::pair<std::size_t, std::size_t>> expert;
  const std::string mark = "v.expert();";
  for (std::size_t at = code.find(mark); at != std::string::npos; at = code.find(mark, at + 1))
    expert.push_back({at, endOfBlock(code, at)});
  std::map<std::size_t, std::string> owners;  // by place
  for (std::sregex_iterator i(code.begin(), code.end(), owner), end; i != end; ++i)
    owners[static_cast<std::size_t>(i->position())] = (*i)[1];
  std::vector<VisitedKey> keys;
  for (std::sregex_iterator i(code.begin(), code.end(), visit), end; i != end; ++i) {
    const auto at = static_cast<std::size_t>(i->position());
    // A function that a visit calls stands in front of it.
    const auto next = owners.upper_bound(at);
    const std::string owned_by = next != owners.begin() ? std::prev(next)->second
                                 : next != owners.end() ? next->second
                                                        : "";
    const bool hidden = std::any_of(expert.begin(), expert.end(), [&](const auto& range) {
      return range.first < at && at < range.second;
    });
    const std::string folder = file.path.substr(0, file.path.rfind('/'));
    keys.push_back({folder, file.path, owned_by, (*i)[1], (*i)[2], hidden});
  }
  return keys;
}

inline std::vector<VisitedKey> keysOfProduct() {
  std::vector<VisitedKey> all;
  for (const char* folder : kProduct) {
    for (const SourceFile& file : filesBelow(folder)) {
      if (!file.isHeader() && !file.isSource()) continue;
      for (VisitedKey& key : keysOf(file)) all.push_back(std::move(key));
    }
  }
  return all;
}

}  // namespace perception::test
