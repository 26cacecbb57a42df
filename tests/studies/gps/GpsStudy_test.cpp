#include "studies/gps/GpsStudy.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

/// Three users; each class at its own steady speed with the receiver's noise.
void writeWorld(const std::string& folder) {
  const double speeds[] = {1.4, 4.0, 12.0, 7.0};
  Rng rng({1, 0, 0, 0});
  for (std::size_t m = 0; m < 4; ++m) {
    std::filesystem::create_directories(folder + "/" + gpsModes()[m]);
    for (const char* user : {"a", "b", "c"}) {
      std::ofstream file(folder + "/" + gpsModes()[m] + "/" + gpsModes()[m] + "_" + user +
                         "_1.csv");
      file << "t_s,lat_deg,lon_deg\n";
      double x = 0;
      for (int i = 0; i < 300; ++i) {
        x += speeds[m] * (1 + 0.1 * rng.normal());
        file << i << ',' << 40 + 0.3 * rng.normal() / 111000 << ','
             << 116 + (x + 0.3 * rng.normal()) / 85000 << '\n';
      }
    }
  }
}

TEST(SpeedRegimes, LikelihoodIsThatOfAMarkovChain) {
  SpeedRegimes r;
  r.add({{3, 3, 4, 3, 3, 4, 3, 3}});
  r.finish();
  // It sums to one over all continuations.
  double sum = 0;
  for (int b = 0; b < SpeedRegimes::kBins; ++b)
    sum += std::exp(r.logLikelihood({3, b}, 0, 2) - r.logLikelihood({3}, 0, 1));
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_GT(r.logLikelihood({3, 3, 4}, 0, 3), r.logLikelihood({3, 9, 3}, 0, 3));
}

TEST(GpsStudy, TellsSteadySpeedsApart) {
  const test::TemporaryFolder folder;
  writeWorld(folder.path());
  GpsParams params;
  params.folder = folder.path();
  params.draws = 3;
  params.sections = 50;
  const auto e = prepareGps(params);
  EXPECT_EQ(e.users.size(), 3u);
  EXPECT_GT(runGps(e, params, GpsRule::kRegimes).balanced, 0.95);
}

TEST(GpsStudy, SaysWhatIsMissing) {
  const test::TemporaryFolder folder;
  GpsParams params;
  params.folder = folder.path();
  try {
    readGpsTracks(params);
    FAIL();
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("pedestrian: no such folder"), std::string::npos);
  }
}

TEST(GpsStudy, FindsPedestriansOnRecordings) {
  GpsParams params;
  params.folder = PERCEPTION_SHARED_DATA "/data/gps_modes";
  if (!std::filesystem::exists(params.folder)) GTEST_SKIP() << "no recordings in gps_modes";
  const auto e = prepareGps(params);
  const auto paper = runGps(e, params, GpsRule::kChi2), ours = runGps(e, params, GpsRule::kRegimes);
  EXPECT_GE(ours.balanced, 0.65);
  EXPECT_GE(ours.balanced, paper.balanced + 0.10);
  EXPECT_GE(ours.right[0], 0.95);
}

}  // namespace
}  // namespace perception
