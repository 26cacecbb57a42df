#include <gtest/gtest.h>

#include <clocale>
#include <locale>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/objects/ObjectClass.h"
#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

const std::string kValid =
    "\xEF\xBB\xBF; a site\nrelative_paths = this-file\n[a]\ngain = 0.5 ; [m]\nopening_deg = 90\n"
    "beams = 32\nseed = 184\nactive = no\nlabel = a b;c#d\nmodel = nets/a.onnx\r\n"
    "corners = -1, 2.5e0\nnames = x , y,z\ncolor = blue\nshare.car = .25\n\n"
    "[class.car] # wheels\nmotion = wheeled\nlength = 4.5\nprior = 0.4\n";

// One to eight changes: a byte replaced, removed, doubled; a piece moved; the end cut off.
std::string mutated(const std::string& text, Rng& rng) {
  std::string s = text;
  const auto place = [&] { return rng.below(static_cast<std::uint32_t>(s.size())); };
  for (auto changes = 1 + rng.below(8); changes > 0 && !s.empty(); --changes) {
    const char telling[] = {'[',  ']',  '=',  ';', '#', ',', '.',
                            '\n', '\r', '\0', ' ', '-', 'e', '\xFF'};
    switch (rng.below(6)) {
      case 0:
        s[place()] = static_cast<char>(rng.below(256));
        break;
      case 1:
        s[place()] = telling[rng.below(sizeof telling)];
        break;
      case 2:
        s.erase(place(), 1 + rng.below(5));
        break;
      case 3:
        s.insert(place(), 1, telling[rng.below(sizeof telling)]);
        break;
      case 4:
        s.insert(place(), s.substr(place(), rng.below(40)));
        break;
      default:
        if (rng.below(4) == 0) s.resize(place());
    }
  }
  return s;
}

TEST(ConfigFuzz, AMutatedFileLoadsOrIsRefusedWithItsFaults) {
  int loaded = 0, refused = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    Rng rng({7, i, 0, 0});
    Config config = Config::fromText(mutated(kValid, rng), "t.ini");
    if (i % 4 == 0) config.set(mutated("a.gain=2", rng));
    const auto params = config.read<AllKinds>("a");
    readClassTable(config);
    const std::string faults = faultsOf(config);
    (faults.empty() ? loaded : refused) += 1;
    if (!faults.empty()) continue;
    EXPECT_GE(params.gain, 0.05);
    EXPECT_LE(params.gain, 5);
    // What was accepted can be written and read again.
    Config again = Config::fromText(config.effectiveText(), "effective.ini");
    EXPECT_EQ(again.read<AllKinds>("a").corners, params.corners);
    readClassTable(again);
    EXPECT_EQ(faultsOf(again), "") << config.effectiveText();
    EXPECT_EQ(again.effectiveText(), config.effectiveText());
  }
  EXPECT_GT(loaded, 100);
  EXPECT_GT(refused, 100);
}

/// A locale as in Germany, made here since the machine need not have one.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(ConfigLocale, ADecimalCommaChangesNothing) {
  const auto load = [] {
    Config config = Config::fromText(kValid + "max_speed = 50\nheight_sigma = 0.225\n");
    config.set("a.seed=1234567");
    config.read<AllKinds>("a");
    readClassTable(config);
    return faultsOf(config) + config.effectiveText();
  };
  const std::string plain = load();
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const std::locale global =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name)) break;
  }
  const std::string german = load();
  std::locale::global(global);
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(german, plain);
  EXPECT_NE(plain.find("seed = 1234567 "), std::string::npos);
  EXPECT_EQ(plain.find("expected"), std::string::npos) << plain;
}

}  // namespace
}  // namespace perception::test
