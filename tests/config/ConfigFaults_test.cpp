#include <gtest/gtest.h>

#include <algorithm>

#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

TEST(ConfigFaults, EachHasItsMessage) {
  const std::pair<const char*, const char*> cases[] = {
      {"[a]\ngain = 1,5",
       "t.ini:2: [a] gain: found '1,5', expected a number in 0.05 .. 5 [m] (the decimal mark is a "
       "point)"},
      {"[a]\ngain = 12abc", "t.ini:2: [a] gain: found '12abc', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = nan", "t.ini:2: [a] gain: found 'nan', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = inf", "t.ini:2: [a] gain: found 'inf', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = 1e999", "t.ini:2: [a] gain: found '1e999', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = 0x1", "t.ini:2: [a] gain: found '0x1', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = 5.01", "t.ini:2: [a] gain: found '5.01', expected a number in 0.05 .. 5 [m]"},
      {"[a]\ngain = 1 // m",
       "t.ini:2: [a] gain: found '1 // m', expected a number in 0.05 .. 5 [m] (comments start with "
       "; or #)"},
      {"[a]\ngain =", "t.ini:2: [a] gain: found no value, expected one after '='"},
      {"[a]\ngain = ; 5", "t.ini:2: [a] gain: found no value, expected one after '='"},
      {"[a]\nopening_deg = 361",
       "t.ini:2: [a] opening_deg: found '361', expected a number in 0 .. 360 [deg]"},
      {"[a]\nbeams = 2.0", "t.ini:2: [a] beams: found '2.0', expected an integer in 1 .. 128"},
      {"[a]\nbeams = 99999999999999999999",
       "t.ini:2: [a] beams: found '99999999999999999999', expected an integer in 1 .. 128"},
      {"[a]\nseed = -5",
       "t.ini:2: [a] seed: found '-5', expected an integer in 0 .. 18446744073709551615"},
      {"[a]\nactive = maybe", "t.ini:2: [a] active: found 'maybe', expected true or false"},
      {"[a]\ncorners = 1",
       "t.ini:2: [a] corners: found '1', expected 2 numbers separated by commas, each in -10 .. 10 "
       "[m]"},
      {"[a]\ncorners = 1,,2",
       "t.ini:2: [a] corners: found '1,,2', expected 2 numbers separated by commas, each in -10 .. "
       "10 "
       "[m]"},
      {"[a]\nnames = x,", "t.ini:2: [a] names: found 'x,', expected words separated by commas"},
      {"[a]\nnames = x ,#y",
       "t.ini:2: [a] names: found 'x ,#y', expected words separated by commas"},
      {"[a]\ncolor = gren",
       "t.ini:2: [a] color: found 'gren', expected one of red, green, blue; did you mean "
       "'green'?"},
      {"[a]\nshare.x = 2", "t.ini:2: [a] share.x: found '2', expected a number in 0 .. 1"},
      {"[a]\nshare. = 1",
       "t.ini:2: [a] share.: unknown key, expected one of gain, opening_deg, beams, seed, active, "
       "label, model, corners, names, color, share.NAME"},
      {"[a]\nGAIN = 1", "t.ini:2: [a] GAIN: unknown key, did you mean 'gain'?"},
      {"[a]\ngian = 1", "t.ini:2: [a] gian: unknown key, did you mean 'gain'?"},
      {"[a]\ngain = 1\ngain = 1", "t.ini:3: [a] gain: duplicate, first in t.ini:2"},
      {"[a]\ngain = 4\nbeams = 1", "t.ini:1: [a]: a gain of 3 m and more needs 2 beams"},
      {"[a]\nlabel = x\ty\x01",
       "t.ini:2: [a] label: found 'x\\x09y\\x01', expected a line without control characters"},
      {"[a]\nla\x1b"
       "bel = x",
       "t.ini:2: [a] la\\x1b"
       "bel: found 'x', expected a line without control characters"},
      {"[a", "t.ini:1: found '[a', expected a title as [section]"},
      {"[]", "t.ini:1: found '[]', expected a title as [section]"},
      {"[a] x", "t.ini:1: found '[a] x', expected a title as [section]"},
      {"[", "t.ini:1: found '[', expected a title as [section]"},
      {"gain = 1", "t.ini:1: 'gain': key outside of any section, expected a [section] first"},
      {"[a]\ngain", "t.ini:2: found 'gain', expected [section], key = value or a comment"},
      {"[a]\n= 5", "t.ini:2: found '= 5', expected [section], key = value or a comment"},
      {"relative_paths = here",
       "t.ini:1: relative_paths: found 'here', expected this-file or working-folder"},
      {"[aa]\nx = 1\ny = 2", "t.ini:1: [aa]: unknown section, did you mean [a]?"},
      {"[lidar]", "t.ini:1: [lidar]: unknown section: nothing reads it"},
      {"\xFF\xFE[\0a", "t.ini:1: found UTF-16, expected UTF-8"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(faultsOfText(text), message) << text;
}

TEST(ConfigFaults, AllAreReportedTogetherInTheOrderOfTheFile) {
  Config config =
      Config::fromText("[a]\ngain = x\n[b\nc = 1\n[a]\nbeams = 0\nbems = 1\n[zzzzzz]\n", "t.ini");
  config.set("a.seed=-1");
  config.read<AllKinds>("a");
  config.read<AllKinds>("needed", {}, true);
  EXPECT_EQ(
      faultsOf(config),
      "t.ini: [needed]: section is missing\n"
      "t.ini:2: [a] gain: found 'x', expected a number in 0.05 .. 5 [m]\n"
      "t.ini:3: found '[b', expected a title as [section]\n"
      "t.ini:6: [a] beams: found '0', expected an integer in 1 .. 128\n"
      "t.ini:7: [a] bems: unknown key, did you mean 'beams'?\n"
      "t.ini:8: [zzzzzz]: unknown section: nothing reads it\n"
      "--set a.seed=-1: [a] seed: found '-1', expected an integer in 0 .. 18446744073709551615");
}

TEST(ConfigFaults, ARefusedValueDoesNotAlsoBreakARule) {
  EXPECT_EQ(faultsOfText("[a]\ngain = 4\nbeams = one"),
            "t.ini:3: [a] beams: found 'one', expected an integer in 1 .. 128");
}

TEST(ConfigFaults, AKeyOfAnotherSectionIsSentThere) {
  struct Other {
    int trust = 0;
    void visit(ParamVisitor& v) { v.integer("trust", trust, {0, 9}, "more"); }
  };
  Config config = Config::fromText("[a]\ntrust = 1\n", "t.ini");
  config.read<AllKinds>("a");
  config.read<Other>("weather");
  EXPECT_EQ(faultsOf(config), "t.ini:2: [a] trust: unknown key here, it belongs to [weather]");
}

TEST(ConfigFaults, ReadingTwiceReportsOnce) {
  Config config = Config::fromText("[a]\ngain = x\n", "t.ini");
  config.read<AllKinds>("a");
  config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), "t.ini:2: [a] gain: found 'x', expected a number in 0.05 .. 5 [m]");
}

TEST(ConfigFaults, ThousandsAreCut) {
  std::string text;
  for (int i = 0; i < 10000; ++i) text += "rubbish " + std::to_string(i) + "\n";
  const std::string faults = faultsOfText(text);
  EXPECT_EQ(std::count(faults.begin(), faults.end(), '\n'), 50);
  EXPECT_NE(faults.find("\nt.ini: and more faults after the first 50"), std::string::npos);
}

TEST(ConfigFaults, MissingFileIsTheOnlyFault) {
  const TemporaryFolder folder;
  const std::string path = folder / "none.ini";
  Config config = Config::fromFile(path);
  config.read<AllKinds>("a", {}, true);
  config.fault("", "", "no [class.NAME] section");
  EXPECT_EQ(faultsOf(config), path + ": cannot be read: No such file or directory");
}

TEST(ConfigFaults, AFolderAndAHugeFileAreNoConfiguration) {
  const TemporaryFolder folder;
  EXPECT_EQ(faultsOf(Config::fromFile(folder.path())),
            folder.path() + ": cannot be read: Is a directory");
  writeText(folder / "big.ini", std::string(5u << 20, '\n'));
  EXPECT_EQ(faultsOf(Config::fromFile(folder / "big.ini")),
            (folder / "big.ini") + ": has more than 4194304 bytes, expected a configuration file");
}

}  // namespace
}  // namespace perception::test
