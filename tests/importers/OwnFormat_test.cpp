#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/StampText.h"
#include "tests/importers/ImportFixture.h"

// A format that the library does not know: a class and a row of importers() are all it needs.

namespace perception {
namespace {

/// Text lines "t [s] x y [m]": one walker about sensors that stand, as a laser sees it.
class WalkerImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--walk", file_, "text file of lines t x y")->required();
  }
  void run(ImportLog& log) override {
    std::int64_t number = 0;
    forEachRow(file_, kSpaces, [&](const TextRow& row) {
      row.expect(row.size() == 3, "3: t x y");
      if (log.options().wants(number)) write(row, number, log);
      ++number;
    });
  }

 private:
  static void write(const TextRow& row, std::int64_t number, ImportLog& log) {
    SensorFrame frame;
    frame.sensor = "LASER";
    frame.stamp = kUndatedStart + row.real(0);
    const Vector3 place(row.real(1), row.real(2), 0);
    ObjectDetections found;
    ObjectDetection& walker = found.objects.emplace_back();
    walker.label = "object";
    walker.score = 1;
    walker.space_box = ObjectDetection::SpaceBox{place, 0, .1, .1, .1};
    frame.data = std::move(found);
    log.ego(frame.stamp, Pose3::Identity());
    log.frame(frame.stamp, number);
    log.sensor(frame);
    TruthObject truth;
    truth.frame = number;
    truth.type = "Pedestrian";
    truth.position = place;
    log.truth(frame.stamp, truth);
  }

  std::string file_;
};

class OwnFormat : public test::ImportRun {
 protected:
  OwnFormat() {
    importers().push_back({"walker", "one walker", 0, []() -> std::unique_ptr<Importer> {
                             return std::make_unique<WalkerImporter>();
                           }});
  }
  ~OwnFormat() override { importers().pop_back(); }
};

TEST_F(OwnFormat, IsImportedWithItsTruthAndTracked) {
  std::string walk;
  for (int i = 0; i < 40; ++i) walk += fmt::format("{:.2f} {:.3f} 2\n", .05 * i, 5 + .05 * 1.5 * i);
  write("walk.txt", walk);
  ASSERT_EQ(import("walker", {"--walk", file("walk.txt")}), 0) << error_;
  EXPECT_EQ(result_.frames, 40);
  EXPECT_EQ(result_.truth_types.at("Pedestrian"), 40u);

  const std::vector<Scene> scenes = track("udacity.ini", "L");
  ASSERT_FALSE(scenes.empty());
  ASSERT_EQ(scenes.back().objects.size(), 1u);
  const SceneObject& walker = scenes.back().objects[0];
  EXPECT_NEAR(walker.position.x(), 5 + .05 * 1.5 * 39, .2);
  EXPECT_NEAR(walker.position.y(), 2, .2);
  EXPECT_NEAR(walker.velocity.x(), 1.5, .3);
}

TEST_F(OwnFormat, FaultsNameFileAndLine) {
  write("walk.txt", "0 5 2\n0.05 5\n");
  expectFault(65, "walk.txt:2: 2 fields", "walker", {"--walk", file("walk.txt")});
}

TEST_F(OwnFormat, SharedOptionsChooseFrames) {
  write("walk.txt", "0 5 2\n0.05 5 2\n0.1 5 2\n");
  ASSERT_EQ(import("walker", {"--walk", file("walk.txt"), "--first", "1"}), 0) << error_;
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{1, 2}));
}

}  // namespace
}  // namespace perception
