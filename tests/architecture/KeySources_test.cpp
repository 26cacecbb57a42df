// Where the values of defaults are from.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/architecture/KeyReader.h"

namespace perception::test {
namespace {

bool saysItsSource(const std::string& comment) {
  static const std::regex source(
      R"re(method\.md (\d|\()|\[[a-z]+\d{4}[a-z]?\]|[Tt]uned on|[Ff]itted|[Cc]ounted|[Mm]easured on|[Mm]easured in|[Dd]ata sheet|[Aa]ssumed|[Ss]tandard|[Ss]imulated|[Cc]hosen|[Cc]omputed)re");
  return std::regex_search(comment, source);
}

/// Members that are set by a person or empty have no value whose source could be asked for.
bool hasNumber(const std::string& initializer) {
  static const std::regex number(R"re((^|[^\w.])[\d.]*[1-9]|\btrue\b)re");  // not that of Vector3
  return std::regex_search(initializer, number);
}

std::string trimmedComment(const std::string& line) {
  const std::size_t at = line.find("//");
  return at == std::string::npos ? "" : line.substr(at);
}

/// A line that is a comment and goes on with that of the line before: "// ..." or "///< ...".
bool goesOn(const std::string& line) {
  const std::size_t at = line.find("//");
  return at != std::string::npos && line.find_first_not_of(' ') == at &&
         (line.compare(at, 3, "///") != 0 || line.compare(at, 4, "///<") == 0);
}

/// Members of structs that are visited, as "Struct::member"; "::member": of a struct within the
/// visited one, whatever its name.
using Members = std::set<std::string>;

void addMember(const VisitedKey& key, Members& members) {
  const std::size_t dot = key.member.rfind('.');
  members.insert(dot == std::string::npos ? key.owner + "::" + key.member
                                          : "::" + key.member.substr(dot + 1));
}

/// Declarations "type name = number;  ///< ..." whose comment, or that of the struct, names no
/// source. Only of `members`.
std::vector<std::string> withoutSource(const std::string& header, const Members& members) {
  static const std::regex begin(R"re(^\s*(?:struct|class) (\w+)[^;]*\{)re");
  static const std::regex member(R"re(\b(\w+) *(=|\{)([^;]*?)(?=;|, \w+ =))re");
  std::vector<std::string> lines;
  std::istringstream in(header);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::vector<std::string> faults;
  std::string above, of_struct;  // comments
  std::string name;              // of the struct
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string comment = trimmedComment(lines[i]);
    const std::string code = lines[i].substr(0, lines[i].size() - comment.size());
    if (code.find_first_not_of(' ') == std::string::npos) {
      above = comment.empty() ? "" : above + " " + comment;
      continue;
    }
    if (code[0] == '#') continue;
    if (std::smatch m; std::regex_search(code, m, begin)) of_struct = above + comment, name = m[1];
    std::string statement = code, behind = comment;
    // A declaration may take several lines, its comment as well.
    while (statement.find(';') == std::string::npos && code.find('{') == std::string::npos &&
           code.find('(') == std::string::npos && i + 1 < lines.size()) {
      ++i;
      const std::string more = trimmedComment(lines[i]);
      statement += lines[i].substr(0, lines[i].size() - more.size());
      behind += more;
    }
    while (!behind.empty() && i + 1 < lines.size() && goesOn(lines[i + 1]))
      behind += trimmedComment(lines[++i]);
    for (std::sregex_iterator m(statement.begin(), statement.end(), member), end; m != end; ++m) {
      const std::string found = (*m)[1];
      if ((members.count(name + "::" + found) != 0 || members.count("::" + found) != 0) &&
          hasNumber((*m)[3]) && !saysItsSource(above + behind + of_struct))
        faults.push_back(found);
    }
    above.clear();
  }
  return faults;
}

TEST(Keys, EachDefaultSaysItsSource) {
  std::map<std::string, Members> members;  // by folder
  for (const VisitedKey& key : keysOfProduct()) addMember(key, members[key.folder]);
  for (const auto& [folder, names] : members) {
    for (const SourceFile& file : filesBelow(folder)) {
      if (!file.isHeader()) continue;
      for (const std::string& name : withoutSource(file.text, names))
        ADD_FAILURE() << file.path << ": " << name << " does not say where its value is from";
    }
  }
}

TEST(Keys, TheCheckerReadsMembers) {
  Members members;
  addMember({"", "", "P", "gain", "gain", false}, members);
  addMember({"", "", "P", "turn_deg", "p.turn", false}, members);
  EXPECT_EQ(members, (Members{"::turn", "P::gain"}));
}

TEST(Keys, TheCheckerReadsSources) {
  const std::string header = R"(#include "a/b.h"
struct P {
  double gain = 0.5;  ///< [-] method.md 5.6
  double bare = 2;    ///< [m] of the cell
  /// Fitted to something.
  int count = 3;
  double empty = 0;    ///< off
  double other = 4;    ///< not a key
  double two = 0, more = 0.05;  ///< the second one is a number
  Vector3 place = Vector3::Zero();
  double deep = 3;
  double late = 1;  ///< [s] a comment whose second line says it:
                    ///< assumed
  double next = 2;  ///< [s] has nothing of the line before
};
/// All assumed.
struct Q {
  double bold = 1;
};
struct R {
  double gain = 1;  ///< of a struct that is not visited
};
)";
  EXPECT_EQ(
      withoutSource(header, {"P::gain", "P::bare", "P::count", "P::empty", "P::two", "P::more",
                             "P::place", "::deep", "P::late", "P::next", "Q::bold"}),
      (std::vector<std::string>{"bare", "more", "deep", "next"}));
}

}  // namespace
}  // namespace perception::test
