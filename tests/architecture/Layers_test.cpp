#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/architecture/Modules.h"
#include "tests/architecture/SourceTree.h"

namespace perception::test {
namespace {

// Floors of the filter: a folder may include those before it; Step and CRbpfTracker (filter itself)
// stand on top.
const std::vector<std::string> kFloorsOfFilter = {"libperception/filter/simd",
                                                  "libperception/filter/state",
                                                  "libperception/filter/predict",
                                                  "libperception/filter/likelihood",
                                                  "libperception/filter/associate",
                                                  "libperception/filter/update",
                                                  "libperception/filter"};

// Where only classes of MRPT's own kind (files CXxx) may know MRPT.
const std::set<std::string> kWithoutMrpt = {
    "core",  "config", "simd",    "measurement", "filter",  "scene",     "grid",
    "lidar", "radar",  "boxes3d", "vision",      "weather", "detectors", "evaluation"};

// Libraries that stay behind our own headers.
const std::vector<std::string> kOnlyInSources = {"octomap/", "opencv2/", "GL/",      "GLES",
                                                 "EGL/",     "embree3/", "embree4/", "dds/dds.h"};

// What core may know besides the standard library.
const std::vector<std::string> kLibrariesOfCore = {"Eigen/", "unsupported/Eigen/", "fmt/",
                                                   "Random123/", "tbb/"};

bool beginsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

bool beginsWithAny(const std::string& text, const std::vector<std::string>& starts) {
  return std::any_of(starts.begin(), starts.end(),
                     [&](const std::string& s) { return beginsWith(text, s); });
}

std::string moduleOf(const std::string& path) {
  if (beginsWith(path, "libperception/")) return firstFolders(path, 2).substr(14);
  return firstFolders(path, 1);
}

// A class CXxx derives from one of MRPT's: CRbpfTracker.cpp.
bool isMrptClassFile(const SourceFile& file) {
  const std::string name = file.name();
  return name.size() > 2 && name[0] == 'C' && std::isupper(static_cast<unsigned char>(name[1]));
}

// Why an include within the filter breaks the order of its floors, or nothing.
std::string faultOfFloors(const SourceFile& file, const Include& include) {
  const auto floorOf = [](const std::string& path) {
    const std::string folder = path.substr(0, path.rfind('/'));
    return std::find(kFloorsOfFilter.begin(), kFloorsOfFilter.end(), folder);
  };
  const auto from = floorOf(file.path), to = floorOf(include.path);
  if (from == kFloorsOfFilter.end()) return "the folder is no floor of the filter";
  if (to > from) return *from + " must not include " + *to;
  return "";
}

// PERCEPTION_DPM=OFF leaves the engine of part models out: nothing else may need it.
std::string faultOfDpm(const SourceFile& file, const Include& include) {
  const std::string folder = "libperception/detectors/dpm/";
  if (!beginsWith(include.path, folder) || beginsWith(file.path, folder)) return "";
  return "only detectors/dpm may include detectors/dpm";
}

// Why the include breaks a rule, or nothing.
std::string faultOf(const SourceFile& file, const Include& include) {
  const std::string module = moduleOf(file.path);
  const Module* rule = moduleNamed(module);
  if (rule == nullptr) return "the module is not in the table of layers";
  if (include.quoted) {
    const std::string other = moduleOf(include.path);
    if (!std::filesystem::exists(std::filesystem::path(PERCEPTION_SOURCE_DIR) / include.path)) {
      return "is no path from the root of the repository";
    }
    if (other != module && !rule->may_include.count(other))
      return module + " must not include " + other;
    if (other == "detectors") return faultOfDpm(file, include);
    return module == "filter" && other == module ? faultOfFloors(file, include) : "";
  }
  if (beginsWith(include.path, "mrpt/")) {
    if (std::count(include.path.begin(), include.path.end(), '/') == 1 &&
        include.path != "mrpt/version.h") {
      return "is an umbrella header: name what is used";
    }
    if (kWithoutMrpt.count(module) && !isMrptClassFile(file) &&
        !beginsWith(include.path, "mrpt/config/")) {
      return "only files CXxx of " + module + " may include MRPT";
    }
  }
  if (!file.isSource() && beginsWithAny(include.path, kOnlyInSources))
    return "belongs into a source file";
  if (module == "core" && include.path.find('/') != std::string::npos &&
      !beginsWithAny(include.path, kLibrariesOfCore) && !beginsWith(include.path, "sys/")) {
    return "core knows Eigen, fmt, Random123, TBB and the standard library";
  }
  return "";
}

std::vector<SourceFile> ourSources() {
  std::vector<SourceFile> sources;
  for (const char* folder : {"libperception", "gui-offscreen", "studies", "apps"}) {
    for (SourceFile& file : filesBelow(folder)) {
      if (file.isHeader() || file.isSource()) sources.push_back(std::move(file));
    }
  }
  return sources;
}

TEST(Layers, EveryIncludeKeepsTheRule) {
  const auto sources = ourSources();
  ASSERT_GT(sources.size(), 20u);
  for (const SourceFile& file : sources) {
    for (const Include& include : includesOf(file)) {
      const std::string fault = faultOf(file, include);
      EXPECT_EQ(fault, "") << file.path << ":" << include.line << ": " << include.path;
    }
  }
}

// With these two rules each header compiles alone, in the source beside it, and twice;
// HeadersAlone.cmake compiles those that have no source.
TEST(Layers, SourcesIncludeTheirOwnHeaderFirst) {
  const auto sources = ourSources();
  std::set<std::string> headers;
  for (const SourceFile& file : sources) {
    if (!file.isHeader()) continue;
    headers.insert(file.path);
    EXPECT_NE(("\n" + file.text).find("\n#pragma once\n"), std::string::npos) << file.path;
  }
  int pairs = 0;
  for (const SourceFile& file : sources) {
    const std::string header = file.path.substr(0, file.path.rfind('.')) + ".h";
    if (!file.isSource() || headers.count(header) == 0) continue;
    const auto includes = includesOf(file);
    EXPECT_TRUE(!includes.empty() && includes[0].path == header) << file.path << ": " << header;
    ++pairs;
  }
  EXPECT_GT(pairs, 100);
}

std::string faultOfLine(const std::string& path, const std::string& line) {
  const SourceFile file{path, line + "\n"};
  const auto includes = includesOf(file);
  return includes.size() == 1 ? faultOf(file, includes[0]) : "(no include)";
}

TEST(Layers, TheCheckerFindsWhatIsForbidden) {
  EXPECT_EQ(
      faultOfLine("libperception/core/A.h", "#include \"libperception/measurement/Measurement.h\""),
      "core must not include measurement");
  EXPECT_EQ(faultOfLine("libperception/filter/A.cpp", "# include \"libperception/scene/Scene.h\""),
            "filter must not include scene");
  EXPECT_EQ(faultOfLine("libperception/filter/state/A.h",
                        "#include \"libperception/filter/likelihood/Gating.h\""),
            "libperception/filter/state must not include libperception/filter/likelihood");
  EXPECT_EQ(
      faultOfLine("libperception/filter/update/A.h", "#include \"libperception/filter/Step.h\""),
      "libperception/filter/update must not include libperception/filter");
  EXPECT_EQ(
      faultOfLine("libperception/filter/newcomer/A.h", "#include \"libperception/filter/Step.h\""),
      "the folder is no floor of the filter");
  EXPECT_EQ(faultOfLine("libperception/detectors/A.h",
                        "#include \"libperception/detectors/dpm/DpmEngine.h\""),
            "only detectors/dpm may include detectors/dpm");
  EXPECT_EQ(faultOfLine("libperception/scene/A.cpp", "#include \"Scene.h\""),
            "is no path from the root of the repository");
  EXPECT_EQ(faultOfLine("libperception/app/A.cpp", "#include <mrpt/obs.h>"),
            "is an umbrella header: name what is used");
  EXPECT_EQ(faultOfLine("libperception/filter/Step.cpp", "#include <mrpt/poses/CPose3D.h>"),
            "only files CXxx of filter may include MRPT");
  EXPECT_EQ(faultOfLine("libperception/filter/Chi.cpp", "#include <mrpt/poses/CPose3D.h>"),
            "only files CXxx of filter may include MRPT");
  EXPECT_EQ(faultOfLine("gui-offscreen/Labels.h", "#include <opencv2/core.hpp>"),
            "belongs into a source file");
  EXPECT_EQ(faultOfLine("libperception/core/A.cpp", "#include <nlohmann/json.hpp>"),
            "core knows Eigen, fmt, Random123, TBB and the standard library");
  EXPECT_EQ(faultOfLine("libperception/newcomer/A.h", "#include <vector>"),
            "the module is not in the table of layers");
}

TEST(Layers, TheCheckerAllowsWhatIsAllowed) {
  EXPECT_EQ(faultOfLine("libperception/filter/update/A.h",
                        "#include \"libperception/filter/state/Track.h\""),
            "");
  EXPECT_EQ(faultOfLine("libperception/detectors/dpm/A.h",
                        "#include \"libperception/detectors/dpm/DpmEngine.h\""),
            "");
  EXPECT_EQ(
      faultOfLine("libperception/filter/A.cpp", "#include \"libperception/core/math/Angle.h\""),
      "");
  EXPECT_EQ(
      faultOfLine("libperception/filter/CRbpfTracker.h", "#include <mrpt/bayes/CParticleFilter.h>"),
      "");
  EXPECT_EQ(faultOfLine("libperception/filter/A.cpp", "#include <mrpt/config/CConfigFile.h>"), "");
  EXPECT_EQ(faultOfLine("libperception/sensors/A.h", "#include <mrpt/obs/CObservation.h>"), "");
  EXPECT_EQ(faultOfLine("gui-offscreen/Labels.cpp", "#include <opencv2/core.hpp>"), "");
  EXPECT_EQ(faultOfLine("libperception/core/math/Random.cpp", "#include <Random123/philox.h>"), "");
}

TEST(Layers, TheTableHasNoCycle) {
  for (const Module& module : modules()) {
    // The order of the table is one in which every module follows all that it may include.
    for (const std::string& other : module.may_include) {
      const Module* found = moduleNamed(other);
      EXPECT_TRUE(found != nullptr && found < &module) << module.name << ": " << other;
    }
  }
}

// Otherwise docs/structure.svg would show more than there is.
TEST(Layers, WhatThePictureSaysIsUsed) {
  std::set<std::pair<std::string, std::string>> used;
  for (const SourceFile& file : ourSources()) {
    for (const Include& include : includesOf(file)) {
      if (include.quoted) used.insert({moduleOf(file.path), moduleOf(include.path)});
    }
  }
  for (const Module& module : modules()) {
    for (const std::string& other : nearestBelow(module))
      EXPECT_EQ(used.count({module.name, other}), 1u) << module.name << ": " << other;
  }
}

}  // namespace
}  // namespace perception::test
