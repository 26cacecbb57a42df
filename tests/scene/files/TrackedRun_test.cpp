#include "libperception/scene/files/TrackedRun.h"

#include <gtest/gtest.h>

#include <clocale>
#include <limits>

#include "libperception/core/Error.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

using namespace test;

std::uint64_t writeRun(const std::string& dir, const std::vector<Scene>& scenes) {
  TrackedRunWriter writer(dir, pedestrianAndCar(), kFirstStamp);
  for (const Scene& scene : scenes) writer.write(scene);
  writer.close();
  return writer.notFinite();
}

std::vector<Scene> threeScenes() {
  SceneObject walker = someCar(2);
  walker.class_id = 0;
  walker.classified = false;
  walker.class_probability = {0.75, 0.25};
  walker.has_yaw = false;
  walker.last_hit = {{Modality::kCamera, kFirstStamp},
                     {Modality::kRadar, Stamp{kFirstStamp.ns + 5}}};
  return {someScene(0, {someCar(1), walker}), someScene(1, {}), someScene(7, {walker})};
}

template <class Function>
std::string messageOf(Function&& function) {
  try {
    function();
  } catch (const Error& e) {
    return e.what();
  }
  return "(no error)";
}

TEST(TrackedRun, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  const auto scenes = threeScenes();
  EXPECT_EQ(writeRun(folder.path(), scenes), 0u);
  const TrackedRun run = readTrackedRun(folder.path());
  EXPECT_EQ(run.first_stamp, kFirstStamp);
  EXPECT_EQ(run.class_names, (std::vector<std::string>{"pedestrian", "car"}));
  ASSERT_EQ(run.scenes.size(), scenes.size());
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene &a = scenes[i], &b = run.scenes[i];
    EXPECT_EQ(a.stamp, b.stamp);
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_TRUE(a.ego.T_world_ego.isApprox(b.ego.T_world_ego, 1e-6));
    EXPECT_EQ(a.ego.velocity, b.ego.velocity);
    EXPECT_EQ(a.ego.yaw_rate, b.ego.yaw_rate);
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t k = 0; k < a.objects.size(); ++k) {
      const SceneObject &o = a.objects[k], &p = b.objects[k];
      EXPECT_EQ(o.id, p.id);
      EXPECT_EQ(o.class_id, p.class_id);
      EXPECT_EQ(o.classified, p.classified);
      EXPECT_EQ(o.class_probability, p.class_probability);
      EXPECT_EQ(o.existence, p.existence);
      EXPECT_EQ(o.position, p.position);
      EXPECT_EQ(o.yaw, p.yaw);
      EXPECT_EQ(o.has_yaw, p.has_yaw);
      EXPECT_EQ(o.p_front, p.p_front);
      EXPECT_EQ(o.velocity, p.velocity);
      EXPECT_EQ(o.speed, p.speed);
      EXPECT_EQ(o.length, p.length);
      EXPECT_EQ(o.width, p.width);
      EXPECT_EQ(o.height, p.height);
      EXPECT_EQ(o.sd_x, p.sd_x);
      EXPECT_EQ(o.sd_y, p.sd_y);
      EXPECT_EQ(o.sd_yaw, p.sd_yaw);
      EXPECT_EQ(o.sd_speed, p.sd_speed);
      EXPECT_EQ(o.last_hit, p.last_hit);
    }
  }
}

TEST(TrackedRun, TellsTheWayAheadWhereThereIsAGrid) {
  const TemporaryFolder folder;
  std::vector<Scene> scenes = {someScene(0, {}), someScene(1, {}), someScene(2, {}),
                               someScene(3, {})};
  scenes[1].path = FreePath{47.2, 47.2, false, false, 17.25};
  scenes[2].path = FreePath{9.4, 9.4, true, true, 5.5, true};
  scenes[3].path = FreePath{12, 12, true, false, 6.25, false, 7, FreePath::Cause::kObject, 43, 12};
  writeRun(folder.path(), scenes);
  const TrackedRun run = readTrackedRun(folder.path());
  EXPECT_FALSE(run.scenes[0].path);
  for (std::size_t i = 1; i < scenes.size(); ++i) {
    ASSERT_TRUE(run.scenes[i].path);
    EXPECT_EQ(run.scenes[i].path->distance, scenes[i].path->distance);
    EXPECT_EQ(run.scenes[i].path->seen, scenes[i].path->seen);
    EXPECT_EQ(run.scenes[i].path->blocked, scenes[i].path->blocked);
    EXPECT_EQ(run.scenes[i].path->stop, scenes[i].path->stop);
    EXPECT_EQ(run.scenes[i].path->owner, scenes[i].path->owner);
    EXPECT_EQ(run.scenes[i].path->cause, scenes[i].path->cause);
    EXPECT_EQ(run.scenes[i].path->safe_speed, scenes[i].path->safe_speed);
    EXPECT_EQ(run.scenes[i].path->too_fast, scenes[i].path->too_fast);
    EXPECT_EQ(run.scenes[i].path->returns, scenes[i].path->returns);
    EXPECT_EQ(run.scenes[i].path->overruled, scenes[i].path->overruled);
  }
}

TEST(TrackedRun, HasTheColumnsOfTheFormat) {
  const TemporaryFolder folder;
  writeRun(folder.path(), {someScene(1, {someCar(3)})});
  EXPECT_EQ(
      readText(folder / "tracks.csv"),
      "frame,t,stamp,id,class,classified,p_pedestrian,p_car,existence,x,y,z,yaw,has_yaw,p_front,vx,"
      "vy,"
      "speed,length,width,"
      "height,sd_x,sd_y,sd_yaw,sd_speed,last_hit_C,last_hit_L,last_hit_R\n"
      "1,0.103519669,1700000000.226976458,3,car,1,0.012300,0.987700,0.987654,12.3456,-7.0001,0."
      "2500,-3.141592,1,0.875000,"
      "-5.5000,0.1250,-5.5014,4.5000,1.8000,1.5000,0.1000,0.2000,0.030000,0.4000,,0.000000001,\n");
  EXPECT_EQ(readText(folder / "scenes.csv"),
            "frame,t,stamp,x,y,z,yaw,pitch,roll,vx,vy,yaw_rate,objects,free_distance,free_seen,"
            "stop,obstacle,cause,returns,overruled,safe_speed,too_fast\n"
            "1,0.103519669,1700000000.226976458,100.5000,-3.2500,0.1250,2.500000,0.010000,-0."
            "020000,3.0000,4.0000,"
            "0.100000,1,,,,,,,,,\n");
}

TEST(TrackedRun, WritesTheSameBytesInALocaleWithDecimalComma) {
  const TemporaryFolder plain, comma;
  writeRun(plain.path(), threeScenes());
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (!std::setlocale(LC_ALL, "de_DE.UTF-8"))
    GTEST_SKIP() << "missing tool: locale de_DE.UTF-8 (package locales)";
  writeRun(comma.path(), threeScenes());
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(readText(plain / "tracks.csv"), readText(comma / "tracks.csv"));
}

TEST(TrackedRun, NeverWritesANumberThatIsNotFinite) {
  const TemporaryFolder folder;
  SceneObject nan = someCar(1), infinite = someCar(2);
  nan.velocity.x() = std::numeric_limits<double>::quiet_NaN();
  infinite.sd_yaw = std::numeric_limits<double>::infinity();
  EXPECT_EQ(writeRun(folder.path(), {someScene(0, {nan, infinite, someCar(3)})}), 2u);
  const TrackedRun run = readTrackedRun(folder.path());
  ASSERT_EQ(run.scenes.at(0).objects.size(), 1u);
  EXPECT_EQ(run.scenes[0].objects[0].id, 3u);
}

TEST(TrackedRun, FindsACutTracksFile) {
  const TemporaryFolder folder;
  writeRun(folder.path(), threeScenes());
  std::string text = readText(folder / "tracks.csv");
  text.resize(text.rfind('\n', text.size() - 2) + 1);
  writeText(folder / "tracks.csv", text);
  EXPECT_EQ(messageOf([&] { readTrackedRun(folder.path()); }),
            folder / "scenes.csv" +
                ":4: column 'objects': found '1', expected 1 fewer: tracks.csv ends before (was it "
                "cut?)");
}

TEST(TrackedRun, FindsALineOfNoScene) {
  const TemporaryFolder folder;
  writeRun(folder.path(), threeScenes());
  std::string text = readText(folder / "scenes.csv");
  text.resize(text.rfind('\n', text.size() - 2) + 1);
  writeText(folder / "scenes.csv", text);
  EXPECT_NE(messageOf([&] { readTrackedRun(folder.path()); }).find("tracks.csv:4: column 'stamp'"),
            std::string::npos);
}

TEST(TrackedRun, NamesFileLineAndColumnOfABadField) {
  const TemporaryFolder folder;
  writeRun(folder.path(), {someScene(0, {someCar(1)})});
  std::string text = readText(folder / "tracks.csv");
  text.replace(text.find(",car,1,"), 7, ",tank,1,");
  writeText(folder / "tracks.csv", text);
  EXPECT_EQ(messageOf([&] { readTrackedRun(folder.path()); }),
            folder / "tracks.csv" +
                ":2: column 'class': found 'tank', expected the name of a column p_NAME");
}

TEST(TrackedRun, SaysThatTheFolderHoldsNoRun) {
  const TemporaryFolder folder;
  try {
    readTrackedRun(folder.path());
    FAIL() << "an empty folder was read as a run";
  } catch (const DataError& e) {
    EXPECT_EQ(e.code(), ExitCode::kNoInput);
  }
}

TEST(TrackedRun, SaysThatTheFolderToWriteIsMissing) {
  const TemporaryFolder folder;
  try {
    writeRun(folder / "missing", {});
    FAIL() << "wrote into a folder that is not there";
  } catch (const OutputError& e) {
    EXPECT_EQ(e.code(), ExitCode::kCannotCreate);
    EXPECT_NE(std::string(e.what()).find("missing/tracks.csv"), std::string::npos);
  }
}

TEST(TrackedRun, AFullDiskIsAnError) {
  for (const std::string name : {"tracks.csv", "scenes.csv"}) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / name);
    try {
      writeRun(folder.path(), threeScenes());
      FAIL() << "a full disk was not noticed in " << name;
    } catch (const OutputError& e) {
      EXPECT_EQ(e.code(), ExitCode::kIoError);
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
      EXPECT_NE(std::string(e.what()).find("bytes free"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace perception
