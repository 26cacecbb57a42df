#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include "tests/architecture/SourceTree.h"

namespace perception::test {
namespace {

// Goals: what a person can still survey.
constexpr std::size_t kMostKeys = 350, kMostExpertKeys = 60;

/// A line v.real("key", member, ...) of a visit().
struct VisitedKey {
  std::string folder, file, owner, key, member;  // owner: the struct that is visited
  bool expert = false;
};

/// The code without what stands behind // in its lines.
std::string withoutComments(const std::string& text) {
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
std::size_t endOfBlock(const std::string& code, std::size_t at) {
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

std::vector<VisitedKey> keysOf(const SourceFile& file) {
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
    const auto next = owners.upper_bound(at);
    const std::string owned_by = next == owners.begin() ? "" : std::prev(next)->second;
    const bool hidden = std::any_of(expert.begin(), expert.end(), [&](const auto& range) {
      return range.first < at && at < range.second;
    });
    const std::string folder = file.path.substr(0, file.path.rfind('/'));
    keys.push_back({folder, file.path, owned_by, (*i)[1], (*i)[2], hidden});
  }
  return keys;
}

std::vector<VisitedKey> keysOfProduct() {
  std::vector<VisitedKey> all;
  for (const char* folder : {"libperception", "gui-offscreen", "studies"}) {
    for (const SourceFile& file : filesBelow(folder)) {
      if (!file.isHeader() && !file.isSource()) continue;
      for (VisitedKey& key : keysOf(file)) all.push_back(std::move(key));
    }
  }
  return all;
}

/// Names of all keys that the INIs set.
std::set<std::string> keysSetIn(const std::vector<SourceFile>& inis) {
  static const std::regex assignment(R"re(^\s*([\w.-]+)\s*=)re");
  std::set<std::string> names;
  for (const SourceFile& file : inis) {
    std::istringstream in(file.text);
    std::smatch match;
    for (std::string line; std::getline(in, line);) {
      if (std::regex_search(line, match, assignment)) names.insert(match[1]);
    }
  }
  return names;
}

/// A table of keys ("label.") is set by any key that begins so.
bool isSet(const std::string& key, const std::set<std::string>& names) {
  if (key.back() != '.') return names.count(key) != 0;
  const auto next = names.lower_bound(key);
  return next != names.end() && next->rfind(key, 0) == 0;
}

/// One count for a folder's key, however many structs visit it.
std::size_t countOf(const std::vector<VisitedKey>& keys, bool only_expert) {
  std::set<std::pair<std::string, std::string>> names;
  for (const VisitedKey& key : keys) {
    if (key.expert || !only_expert) names.insert({key.folder, key.key});
  }
  return names.size();
}

TEST(Keys, ThereAreFewEnoughToSurvey) {
  const auto keys = keysOfProduct();
  ASSERT_GT(keys.size(), 100u);
  std::cout << countOf(keys, false) << " keys, " << countOf(keys, true) << " of them expert\n";
  EXPECT_LE(countOf(keys, false), kMostKeys);
  EXPECT_LE(countOf(keys, true), kMostExpertKeys);
}

TEST(Keys, EachIsSetByAShippedIniOrExpert) {
  const auto names = keysSetIn(filesBelow("ini"));
  for (const VisitedKey& key : keysOfProduct())
    EXPECT_TRUE(key.expert || isSet(key.key, names)) << key.file << ": " << key.key;
}

// Sources of defaults -----------------------------------------------------------------------------

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

// The checkers ------------------------------------------------------------------------------------

const char* const kVisit = R"(void P::visit(ParamVisitor& v) {
  v.real("gain", gain, {0, 1}, "-", "a {");  // v.real("none", ...)
  if (x) {
    v.expert();
    v.table("label.", rows, {0, 1}, "-", "b");
  }
  v.angle("turn_deg",
          p.turn, {0, 1}, "c");
  v.expert();
  v.text("name", name, "d");
}
void Q::visit(ParamVisitor& v) { v.boolean("on", on, "e"); }
)";

TEST(Keys, TheCheckerReadsVisits) {
  const auto keys = keysOf({"libperception/a/P.cpp", kVisit});
  std::string text;
  Members members;
  for (const VisitedKey& key : keys) {
    text += key.key + "(" + key.member + (key.expert ? ") expert " : ") ");
    addMember(key, members);
  }
  EXPECT_EQ(text, "gain(gain) label.(rows) expert turn_deg(p.turn) name(name) expert on(on) ");
  EXPECT_EQ(members, (Members{"::turn", "P::gain", "P::name", "P::rows", "Q::on"}));
  EXPECT_EQ(countOf(keys, false), 5u);
  EXPECT_EQ(countOf(keys, true), 2u);
}

TEST(Keys, TheCheckerReadsInis) {
  const auto names = keysSetIn({{"a.ini", "[s]\ngain = 1 ; x\n; on = 1\nlabel.car = .5\n"}});
  EXPECT_TRUE(isSet("gain", names));
  EXPECT_TRUE(isSet("label.", names));
  EXPECT_FALSE(isSet("on", names));
  EXPECT_FALSE(isSet("labels.", names));
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
