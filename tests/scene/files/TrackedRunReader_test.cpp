#include "libperception/scene/files/TrackedRunReader.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

using namespace test;

void writeScenes(const std::string& dir) {
  TrackedRunWriter writer(dir, pedestrianAndCar(), kFirstStamp);
  for (int k = 0; k < 5; ++k)
    writer.write(someScene(k, k == 2 ? std::vector<SceneObject>{} : std::vector{someCar(k + 1)}));
  writer.close();
}

TEST(TrackedRunReader, GivesTheScenesOfTheWholeRunOneByOne) {
  const TemporaryFolder folder;
  writeScenes(folder.path());
  const TrackedRun whole = readTrackedRun(folder.path());
  TrackedRunReader reader(folder.path());
  EXPECT_EQ(reader.firstStamp(), kFirstStamp);
  EXPECT_EQ(reader.classNames(), whole.class_names);
  std::vector<Scene> scenes = reader.next(2);
  ASSERT_EQ(scenes.size(), 2u);
  while (auto scene = reader.next()) scenes.push_back(*scene);
  EXPECT_FALSE(reader.next());
  ASSERT_EQ(scenes.size(), whole.scenes.size());
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    EXPECT_EQ(scenes[k].stamp, whole.scenes[k].stamp);
    ASSERT_EQ(scenes[k].objects.size(), k == 2 ? 0u : 1u);
    if (k != 2) {
      EXPECT_EQ(scenes[k].objects[0].id, k + 1);
    }
  }
}

TEST(TrackedRunReader, AFaultIsFoundWhereItIsReached) {
  const TemporaryFolder folder;
  writeScenes(folder.path());
  std::string text = readText(folder / "tracks.csv");
  text.resize(text.rfind('\n', text.size() - 2) + 1);
  writeText(folder / "tracks.csv", text);
  TrackedRunReader reader(folder.path());
  EXPECT_EQ(reader.next(4).size(), 4u);
  EXPECT_THROW(reader.next(), DataError);
}

TEST(TrackedRunReader, TheOutlineKnowsAllStamps) {
  const TemporaryFolder folder;
  writeScenes(folder.path());
  const TrackedRun whole = readTrackedRun(folder.path());
  const RunOutline outline = readRunOutline(folder.path());
  EXPECT_EQ(outline.first_stamp, whole.first_stamp);
  EXPECT_EQ(outline.class_names, whole.class_names);
  ASSERT_EQ(outline.stamps.size(), whole.scenes.size());
  for (std::size_t k = 0; k < outline.stamps.size(); ++k)
    EXPECT_EQ(outline.stamps[k], whole.scenes[k].stamp);
}

}  // namespace
}  // namespace perception
