#include "libperception/config/Config.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expectSame(const AllKinds& a, const AllKinds& b) {
  EXPECT_TRUE(sameBits(a.gain, b.gain)) << a.gain << " " << b.gain;
  EXPECT_TRUE(sameBits(a.opening, b.opening)) << a.opening << " " << b.opening;
  EXPECT_EQ(a.beams, b.beams);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.active, b.active);
  EXPECT_EQ(a.label, b.label);
  EXPECT_EQ(a.model, b.model);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.names, b.names);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.shares, b.shares);
}

AllKinds readAgain(const std::string& effective) {
  Config config = Config::fromText(effective, "effective.ini");
  const auto params = config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), "");
  EXPECT_EQ(config.effectiveText(), effective);
  return params;
}

TEST(Config, ReadsEveryKindOfKey) {
  Config config = Config::fromText(
      "[a]\ngain = 0.5\nopening_deg = 90\nbeams = 32\nseed = 18446744073709551615\nactive = no\n"
      "label = a b;c#d\nmodel = net.onnx\ncorners = -1, 2.5e0\nnames = x , y,z\ncolor = blue\n"
      "share.car = .25\nshare.a.b = 1\n");
  const auto a = config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), "");
  EXPECT_EQ(a.gain, 0.5);
  EXPECT_DOUBLE_EQ(a.opening, kPi / 2);
  EXPECT_EQ(a.beams, 32);
  EXPECT_EQ(a.seed, std::numeric_limits<unsigned long long>::max());
  EXPECT_FALSE(a.active);
  EXPECT_EQ(a.label, "a b;c#d");
  EXPECT_EQ(a.model, "net.onnx");
  EXPECT_EQ(a.corners, (std::vector<double>{-1, 2.5}));
  EXPECT_EQ(a.names, (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(a.color, Paint::kBlue);
  EXPECT_EQ(a.shares, (std::vector<std::pair<std::string, double>>{{"car", .25}, {"a.b", 1}}));
}

TEST(Config, ToleratesByteOrderMarkCarriageReturnsTabsAndLatin1) {
  const std::string text =
      "\xEF\xBB\xBF; first\r\n\t[ a ]\t; section\r\n gain\t=\t2 ; [m]\r\nlabel = B\xFC"
      "cke\r\n\r\nbeams = 3 # lines";
  Config config = Config::fromText(text);
  const auto a = config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), "");
  EXPECT_EQ(a.gain, 2);
  EXPECT_EQ(a.label,
            "B\xFC"
            "cke");
  EXPECT_EQ(a.beams, 3);
}

TEST(Config, MissingSectionLeavesDefaultsUnlessRequired) {
  Config config = Config::fromText("", "t.ini");
  expectSame(config.read<AllKinds>("a"), AllKinds{});
  EXPECT_EQ(faultsOf(config), "");
  config.read<AllKinds>("b", {}, true);
  EXPECT_EQ(faultsOf(config), "t.ini: [b]: section is missing");
}

TEST(Config, ASectionMayBeReadTwiceAndByTwoStructs) {
  struct Other {
    int extra = 0;
    void visit(ParamVisitor& v) { v.integer("extra", extra, {0, 9}, "more"); }
  };
  Config config = Config::fromText("[a]\ngain = 1\nextra = 4\n");
  config.read<AllKinds>("a");
  EXPECT_EQ(config.read<Other>("a").extra, 4);
  EXPECT_EQ(config.read<AllKinds>("a").gain, 1);
  EXPECT_EQ(faultsOf(config), "");
  const std::string text = config.effectiveText();
  EXPECT_EQ(text.find("\ngain = "), text.rfind("\ngain = "));
  EXPECT_NE(text.find("\nextra = 4"), std::string::npos);
}

TEST(Config, PrefixedSectionsComeInTheOrderOfTheFile) {
  const Config config = Config::fromText("[c.z]\n[b]\n[c.a]\n[c.z]\n[c]\n");
  EXPECT_EQ(config.sectionsWithPrefix("c."), (std::vector<std::string>{"c.z", "c.a"}));
  EXPECT_TRUE(config.has("b"));
  EXPECT_FALSE(config.has("d"));
}

TEST(Config, FaultNamesTheLineOfTheKey) {
  Config config = Config::fromText("[a]\ngain = 1\n", "t.ini");
  config.read<AllKinds>("a");
  config.fault("a", "gain", "not with this lidar");
  config.fault("a", "", "no such thing");
  config.fault("", "", "no class");
  EXPECT_EQ(faultsOf(config),
            "t.ini: no class\nt.ini:1: [a]: no such thing\nt.ini:2: [a] gain: not with this lidar");
}

TEST(Config, EmptyInListDefaultsAreNotWrittenAsValues) {
  Config config = Config::fromText("");
  config.read<AllKinds>("a");
  const std::string text = config.effectiveText();
  EXPECT_NE(text.find("\n; model is not set"), std::string::npos) << text;
  EXPECT_NE(text.find("\n; share.NAME is not set"), std::string::npos) << text;
}

TEST(EffectiveText, ShowsAValueThatNoLineCanHold) {
  AllKinds defaults;
  defaults.model = "run #1 #2/a.onnx";
  Config config = Config::fromText("");
  config.read<AllKinds>("a", defaults);
  EXPECT_NE(config.effectiveText().find("\n; model cannot be written: run #1 #2/a.onnx"),
            std::string::npos);
}

TEST(EffectiveText, IsThisOne) {
  Config config = Config::fromText("[a]\ngain = 0.50\nshare.car = 1e-1\n");
  config.set("a.opening_deg=+90.0");
  config.read<AllKinds>("a");
  ASSERT_EQ(faultsOf(config), "");
  EXPECT_EQ(config.effectiveText(),
            R"(; Effective configuration: every section that was read, includes and --set folded in.
; Relative paths start at the folder in which the program was started, or at that of the
; files that come with it.
relative_paths = working-folder

[a]
gain = 0.5                                ; [m] 0.05 .. 5: single linkage; default 0.4
opening_deg = 90                          ; [deg] 0 .. 360: of the view; default 15
beams = 64                                ; 1 .. 128: of the lidar
seed = 0                                  ; of all random numbers
active = true                             ; true | false: in use
label = front                             ; its name
; model is not set                        ; path: weights
corners = 0, 1.5                          ; [m] -10 .. 10: of the field
names = a, b                              ; words: of the objects
color = green                             ; red | green | blue: of the box
share.car = 0.1                           ; 0 .. 1: by name; default not set
)");
}

struct TwoKinds {
  double plain = 1, rare = 2;
  void visit(ParamVisitor& v) {
    v.real("plain", plain, {0, 9}, "", "for everybody");
    v.expert();
    v.real("rare", rare, {0, 9}, "", "for few");
  }
};

TEST(EffectiveText, ShowsExpertsKeysLastAndReadsThemAgain) {
  Config config = Config::fromText("[a]\nrare = 3\n[b]\nplain = 4\n");
  config.read<TwoKinds>("a");
  config.read<TwoKinds>("b");
  const std::string text = config.effectiveText();
  EXPECT_LT(text.find("plain = 4"), text.find("; expert"));
  EXPECT_LT(text.find("; expert"), text.find("rare = 3"));
  Config again = Config::fromText(text);
  EXPECT_EQ(again.read<TwoKinds>("a").rare, 3);
  EXPECT_EQ(again.read<TwoKinds>("b").plain, 4);
  again.finish();
}

TEST(EffectiveText, KeepsTheDifferentDefaultsOfTwoReaders) {
  AllKinds other;
  other.gain = 0.7;
  other.opening = radians(20);
  other.shares = {{"car", 0.5}, {"bus", 0.1}};
  AllKinds third = other;
  third.shares = {{"car", 0.5}, {"tram", 0.1}};
  const auto read = [&](const std::string& text) {
    Config config = Config::fromText(text);
    EXPECT_EQ(config.read<AllKinds>("a").gain, AllKinds{}.gain);
    const auto second = config.read("a", other);
    EXPECT_EQ(second.gain, other.gain);
    EXPECT_EQ(second.opening, other.opening);
    EXPECT_EQ(second.beams, 7);
    EXPECT_EQ(second.shares, other.shares);
    EXPECT_EQ(config.read("a", third).shares, third.shares);
    EXPECT_TRUE(config.read<AllKinds>("a").shares.empty());
    EXPECT_EQ(config.read<AllKinds>("a").gain, AllKinds{}.gain);
    EXPECT_EQ(faultsOf(config), "");
    return config.effectiveText();
  };
  const std::string effective = read("[a]\nbeams = 7\n");
  EXPECT_EQ(read(effective), effective);
  EXPECT_NE(effective.find("\nbeams = 7 "), std::string::npos);
  EXPECT_NE(effective.find("[m] 0.05 .. 5: single linkage; default 0.4 or 0.7\n"),
            std::string::npos)
      << effective;
}

TEST(EffectiveText, ReadsBackToTheBit) {
  // Values without a short decimal, and angles: degrees in the file, radians inside.
  for (int i = 0; i < 300; ++i) {
    const double gain = 0.05 + 4.9 * i / 301 + 1e-16 * i;
    Config config = Config::fromText(
        "[a]\ngain = " + std::to_string(gain) + "e0\nopening_deg = " + std::to_string(i * 1.1 / 3) +
        "\ncorners = 1e-9, " + std::to_string(i / 97.0) + "\nmodel = nets/a.onnx\nshare.x = 0.3\n");
    const auto params = config.read<AllKinds>("a");
    ASSERT_EQ(faultsOf(config), "");
    expectSame(readAgain(config.effectiveText()), params);
  }
}

TEST(EffectiveText, ReadsBackDefaultsThatNoTextGives) {
  for (int i = 0; i < 300; ++i) {
    AllKinds defaults;
    defaults.gain = std::numeric_limits<double>::quiet_NaN();
    defaults.opening = 0.01 * i + 1e-17 * i;  // hardly ever radians() of a number of degrees
    defaults.label = i % 2 ? "" : "a ; b";
    Config config = Config::fromText("");
    config.read<AllKinds>("a", defaults);
    Config again = Config::fromText(config.effectiveText());
    const auto back = again.read<AllKinds>("a", defaults);
    ASSERT_EQ(faultsOf(again), "");
    expectSame(back, defaults);
  }
}

TEST(ConfigSet, WinsOverTheFileAndALaterOneOverAnEarlier) {
  Config config = Config::fromText("[a]\ngain = 1\n");
  config.set("a.gain=2");
  config.set(" a.gain = 3 ");
  config.set("a.label=x=y");
  const auto a = config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), "");
  EXPECT_EQ(a.gain, 3);
  EXPECT_EQ(a.label, "x=y");
}

TEST(ConfigSet, TheLongestSectionOfTheFileTakesTheKey) {
  Config config = Config::fromText("[s]\n[s.A]\n[s.A.b]\n");
  config.set("s.A.b.gain=1");
  config.set("s.A.share.car.x=0.5");
  config.set("new.part.gain=2");
  EXPECT_EQ(config.read<AllKinds>("s.A.b").gain, 1);
  EXPECT_EQ(config.read<AllKinds>("s.A").shares.at(0).first, "car.x");
  EXPECT_EQ(config.read<AllKinds>("new.part").gain, 2);
  config.read<AllKinds>("s");
  EXPECT_EQ(faultsOf(config), "");
}

TEST(ConfigSet, ReachesASectionThatNoFileHasOnceItIsRead) {
  Config config = Config::fromText("[s.A]\nshare.part.gain = 0.3\n", "t.ini");
  config.set("s.A.part.gain=2");
  config.set("s.A.share.part.gain=0.4");
  const auto above = config.read<AllKinds>("s.A");
  EXPECT_EQ(config.read<AllKinds>("s.A.part").gain, 2);
  EXPECT_EQ(above.gain, AllKinds{}.gain);
  EXPECT_EQ(above.shares, (std::vector<std::pair<std::string, double>>{{"part.gain", 0.4}}));
  EXPECT_EQ(faultsOf(config), "");
}

TEST(ConfigSet, CannotMakeAnotherMemberOfAList) {
  Config config = Config::fromText("[class.car]\n", "t.ini");
  config.set("class.cra.gain=1");
  EXPECT_EQ(config.sectionsWithPrefix("class."), std::vector<std::string>{"class.car"});
  config.read<AllKinds>("class.car");
  EXPECT_EQ(faultsOf(config),
            "--set class.cra.gain=1: [class.cra]: unknown section, did you mean [class.car]?");
}

TEST(ConfigSet, FaultsNameTheOption) {
  Config config = Config::fromText("[a]\n", "t.ini");
  for (const char* text :
       {"gain", "gain=1", ".gain=1", "a.=1", "=", "", "a.gain=", "a.label=x ; y"}) {
    config.set(text);
  }
  config.set("a.beams=1,5");
  config.set("a.bems=1");
  config.set("a.label=two\nlines");
  config.read<AllKinds>("a");
  EXPECT_EQ(
      faultsOf(config),
      "--set gain: expected section.key=value\n"
      "--set gain=1: expected section.key=value\n"
      "--set .gain=1: expected section.key=value\n"
      "--set a.=1: expected section.key=value\n"
      "--set =: expected section.key=value\n"
      "--set : expected section.key=value\n"
      "--set a.gain=: found '', expected a value of one line without a comment\n"
      "--set a.label=x ; y: found 'x ; y', expected a value of one line without a comment\n"
      "--set a.beams=1,5: [a] beams: found '1,5', expected an integer in 1 .. 128 (the decimal "
      "mark is a point)\n"
      "--set a.bems=1: [a] bems: unknown key, did you mean 'beams'?\n"
      "--set a.label=two\\x0alines: found 'two\\x0alines', expected a value of one line without "
      "a comment");
}

}  // namespace
}  // namespace perception::test
