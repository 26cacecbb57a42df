#include "libperception/core/TruthStream.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using test::TemporaryFolder;

constexpr int kInstants = 600;  // of a minute at 10 Hz

TruthObject carAt(int k) {
  TruthObject car;
  car.frame = k;
  car.t = 0.1 * k;
  car.id = 5;
  car.type = "Car";
  car.length = 4, car.width = 2, car.height = 1.5;
  return car;
}

std::string truthOf(const TemporaryFolder& folder, const std::vector<TruthObject>& rows) {
  const std::string path = folder / "truth.csv";
  writeGroundTruth(path, rows);
  return path;
}

std::vector<TruthObject> minute() {
  std::vector<TruthObject> rows;
  for (int k = 0; k < kInstants; ++k) {
    rows.push_back(carAt(k));
    rows.push_back(carAt(k));
    rows.back().id = 6;
  }
  return rows;
}

TEST(TruthStream, GivesTheInstantsAroundEachSceneAndFewOthers) {
  const TemporaryFolder folder;
  TruthStream truth(truthOf(folder, minute()));
  for (int k = 0; k < kInstants; k += 50) {
    const auto& window = truth.around({0.1 * k, 0.1 * (k + 49), k, k + 49}).instants;
    ASSERT_LE(window.size(), 75u);
    EXPECT_LE(window.front().frame, std::max(k - 5, 0));
    EXPECT_GE(window.back().frame, std::min(k + 54, kInstants - 1));
    for (const auto& instant : window) ASSERT_EQ(instant.objects.size(), 2u) << instant.t;
    for (std::size_t i = 1; i < window.size(); ++i)
      ASSERT_EQ(window[i].frame, window[i - 1].frame + 1);
  }
}

TEST(TruthStream, FindsFramesWhoseTimesAreShifted) {
  const TemporaryFolder folder;
  std::vector<TruthObject> rows = minute();
  for (const double shift : {-7.0, 7.0}) {
    for (TruthObject& row : rows) row.t = 0.1 * static_cast<double>(row.frame) + shift;
    TruthStream truth(truthOf(folder, rows));
    for (int k = 0; k < kInstants; k += 50) {
      const auto& window = truth.around({0.1 * k, 0.1 * (k + 49), k, k + 49}).instants;
      ASSERT_FALSE(window.empty());
      EXPECT_LE(window.front().frame, k) << shift;
      EXPECT_GE(window.back().frame, k + 49) << shift;
    }
  }
}

TEST(TruthStream, SortsAFileThatIsNotInOrderOfTime) {
  const TemporaryFolder folder;
  std::vector<TruthObject> rows = minute();
  TruthStream ordered(truthOf(folder, rows));
  std::swap(rows.front(), rows.back());
  writeGroundTruth(folder / "other.csv", rows);
  TruthStream other(folder / "other.csv");
  for (int k = 0; k < kInstants; k += 50) {
    const TruthSpan span{0.1 * k, 0.1 * (k + 49), k, k + 49};
    const auto& expected = ordered.around(span).instants;
    const auto& window = other.around(span).instants;
    ASSERT_EQ(window.size(), expected.size()) << k;
    for (std::size_t i = 0; i < window.size(); ++i) {
      EXPECT_EQ(window[i].t, expected[i].t);
      EXPECT_EQ(window[i].frame, expected[i].frame);
      EXPECT_EQ(window[i].objects.size(), expected[i].objects.size());
    }
  }
}

TEST(TruthStream, FindsTheFaultsOfTheWholeFile) {
  const TemporaryFolder folder;
  std::vector<TruthObject> rows = minute();
  rows.back().id = 5;
  const std::string path = truthOf(folder, rows);
  TruthStream truth(path);
  std::string said, whole;
  try {
    truth.around({0, 100, 0, 1000});
  } catch (const DataError& error) {
    said = error.what();
  }
  try {
    readGroundTruth(path);
  } catch (const DataError& error) {
    whole = error.what();
  }
  EXPECT_NE(said.find("an object once per time t"), std::string::npos);
  EXPECT_EQ(said, whole);
}

TEST(TruthStream, OfAFileWithoutRowsGivesNone) {
  const TemporaryFolder folder;
  TruthStream truth(truthOf(folder, {}));
  EXPECT_TRUE(truth.around({0, 5, 0, 50}).instants.empty());
}

}  // namespace
}  // namespace perception
