#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

#include "tests/architecture/KeyReader.h"

namespace perception::test {
namespace {

// Goals: what a person can still survey.
constexpr std::size_t kMostKeys = 350, kMostExpertKeys = 60;

/// A line of an INI; `simulated`: of what perception-simulate reads.
struct SetKey {
  std::string section, key;
  bool simulated = false;
};

std::vector<SetKey> keysSetIn(const std::vector<SourceFile>& inis) {
  static const std::regex line_of(R"re(^\s*(?:\[([^\]]+)\]|([\w.-]+)\s*=))re");
  std::vector<SetKey> keys;
  for (const SourceFile& file : inis) {
    const bool simulated = file.path.rfind("ini/vehicles/", 0) == 0 ||
                           file.path.rfind("ini/scenarios/", 0) == 0 ||
                           file.path.rfind("ini/weather/", 0) == 0;
    std::istringstream in(file.text);
    std::smatch match;
    std::string section;
    for (std::string line; std::getline(in, line);) {
      if (!std::regex_search(line, match, line_of)) continue;
      if (match[1].matched) section = match[1];
      if (match[2].matched) keys.push_back({section, match[2], simulated});
    }
  }
  return keys;
}

/// Sections that the comments of structs name, as "sensor.LABEL.radar", by struct. Capitals stand
/// for any name.
std::map<std::string, std::vector<std::string>> sectionsOf(const std::vector<SourceFile>& headers) {
  static const std::regex begin(R"re(^\s*(?:struct|class) (\w+)[^;]*\{)re");
  static const std::regex title(R"re(\[([a-z_]+(?:\.[A-Za-z_]+)*)\])re");
  std::map<std::string, std::vector<std::string>> sections;
  for (const SourceFile& file : headers) {
    std::istringstream in(file.text);
    std::string above;
    std::smatch match;
    for (std::string line; std::getline(in, line);) {
      const std::size_t text = line.find_first_not_of(' ');
      if (text != std::string::npos && line.compare(text, 2, "//") == 0) {
        above += line.substr(text);
        continue;
      }
      if (std::regex_search(line, match, begin)) {
        auto& named = sections[match[1]];
        for (std::sregex_iterator i(above.begin(), above.end(), title), end; i != end; ++i)
          named.push_back((*i)[1]);
      }
      above.clear();
    }
  }
  return sections;
}

bool isOfKind(const std::string& section, const std::string& kind) {
  static const std::regex placeholder("[A-Z]+");
  return std::regex_match(section, std::regex(std::regex_replace(kind, placeholder, "[^.]+")));
}

/// In a section of one of these kinds. A table of keys ("label.") is set by any key that begins so.
bool isSet(const VisitedKey& key, const std::vector<std::string>& kinds,
           const std::vector<SetKey>& set) {
  const bool simulated = key.folder.rfind("libperception/simulation", 0) == 0;
  return std::any_of(set.begin(), set.end(), [&](const SetKey& s) {
    const bool named = key.key.back() == '.' ? s.key.rfind(key.key, 0) == 0 : s.key == key.key;
    return named && s.simulated == simulated &&
           std::any_of(kinds.begin(), kinds.end(),
                       [&](const std::string& kind) { return isOfKind(s.section, kind); });
  });
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

std::vector<SourceFile> headersOfProduct() {
  std::vector<SourceFile> headers;
  for (const char* folder : kProduct) {
    for (SourceFile& file : filesBelow(folder))
      if (file.isHeader()) headers.push_back(std::move(file));
  }
  return headers;
}

TEST(Keys, EachStructSaysItsSection) {
  auto sections = sectionsOf(headersOfProduct());
  for (const VisitedKey& key : keysOfProduct())
    EXPECT_FALSE(sections[key.owner].empty()) << key.file << ": " << key.owner;
}

TEST(Keys, EachIsSetInItsSectionByAShippedIniOrExpert) {
  const auto set = keysSetIn(filesBelow("ini"));
  auto sections = sectionsOf(headersOfProduct());
  for (const VisitedKey& key : keysOfProduct()) {
    if (key.expert) continue;
    EXPECT_TRUE(isSet(key, sections[key.owner], set))
        << key.file << ": " << key.owner << "'s " << key.key;
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
  for (const VisitedKey& key : keys) {
    text += key.owner + "." + key.key + "(" + key.member + (key.expert ? ") expert " : ") ");
  }
  EXPECT_EQ(text,
            "P.gain(gain) P.label.(rows) expert P.turn_deg(p.turn) P.name(name) expert Q.on(on) ");
  EXPECT_EQ(countOf(keys, false), 5u);
  EXPECT_EQ(countOf(keys, true), 2u);
}

TEST(Keys, TheCheckerReadsInis) {
  const auto set = keysSetIn(
      {{"ini/a.ini", "[sensor.A]\ngain = 1 ; x\n; on = 1\n[sensor.A.radar]\nlabel.car = .5\n"},
       {"ini/vehicles/b.ini", "[sensor.B]\nrate = 10\n"}});
  const auto found = [&](const char* folder, const char* key, const char* kind) {
    return isSet({folder, "", "", key, "", false}, {kind}, set);
  };
  EXPECT_TRUE(found("libperception/a", "gain", "sensor.LABEL"));
  EXPECT_FALSE(found("libperception/a", "gain", "sensor.LABEL.radar"));
  EXPECT_FALSE(found("libperception/a", "gain", "sensor"));
  EXPECT_TRUE(found("libperception/a", "label.", "sensor.LABEL.radar"));
  EXPECT_FALSE(found("libperception/a", "labels.", "sensor.LABEL.radar"));
  EXPECT_FALSE(found("libperception/a", "on", "sensor.LABEL"));
  EXPECT_FALSE(found("libperception/a", "rate", "sensor.LABEL"));
  EXPECT_TRUE(found("libperception/simulation", "rate", "sensor.LABEL"));
}

TEST(Keys, TheCheckerReadsSectionsOfStructs) {
  auto sections = sectionsOf({{"P.h",
                               "/// Two: [a], [b.NAME.c] after [radecki2016].\nstruct P {\n"
                               "  double x = 0;  ///< [m]\n};\n\nstruct Q {\n};\n"}});
  EXPECT_EQ(sections["P"], (std::vector<std::string>{"a", "b.NAME.c"}));
  EXPECT_TRUE(sections["Q"].empty());
}

}  // namespace
}  // namespace perception::test
