#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

enum class Paint { kRed, kGreen, kBlue };

/// One key of every kind.
struct AllKinds {
  double gain = 0.4;
  double opening = radians(15);
  int beams = 64;
  unsigned long long seed = 0;
  bool active = true;
  std::string label = "front";
  std::string model;
  std::vector<double> corners = {0, 1.5};
  std::vector<std::string> names = {"a", "b"};
  Paint color = Paint::kGreen;
  std::vector<std::pair<std::string, double>> shares;

  void visit(ParamVisitor& v) {
    v.real("gain", gain, {0.05, 5}, "m", "single linkage");
    v.angle("opening_deg", opening, {0, 360}, "of the view");
    v.integer("beams", beams, {1, 128}, "of the lidar");
    v.unsigned64("seed", seed, "of all random numbers");
    v.boolean("active", active, "in use");
    v.text("label", label, "its name");
    v.path("model", model, "weights");
    v.reals("corners", corners, 2, {-10, 10}, "m", "of the field");
    v.words("names", names, "of the objects");
    v.choiceOf("color", color, {"red", "green", "blue"}, "of the box");
    v.table("share.", shares, {0, 1}, "", "by name");
    v.require(gain < 3 || beams > 1, "a gain of 3 m and more needs 2 beams");
  }
};

/// All lines of the ConfigError that finish() throws; empty when there is none.
inline std::string faultsOf(const Config& config) {
  try {
    config.finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// Faults of a text whose section [a] is read as AllKinds.
inline std::string faultsOfText(const std::string& text) {
  Config config = Config::fromText(text, "t.ini");
  config.read<AllKinds>("a");
  return faultsOf(config);
}

/// Section [a] of a file, which has these faults.
inline AllKinds readFile(const std::string& path, const std::string& faults = "") {
  Config config = Config::fromFile(path);
  const auto params = config.read<AllKinds>("a");
  EXPECT_EQ(faultsOf(config), faults);
  return params;
}

inline void writeText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace perception::test
