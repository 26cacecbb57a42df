#include "libperception/app/show/SnapshotApp.h"

#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>
#include <mrpt/obs/CObservationImage.h>
#include <octomap/OcTree.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "tests/gui-offscreen/PictureColors.h"

namespace perception {
namespace {

using namespace test;

namespace fs = std::filesystem;

constexpr int kSnapshotScenes = 30;

// A run of three seconds of the demo log with one car, that did finish.
class SnapshotAppTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "snapshot app " +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_ + "/run");
    ClassTable classes;
    for (const char* c : {"pedestrian", "car"}) {
      classes.classes.emplace_back();
      classes.classes.back().name = c;
    }
    TrackedRunWriter writer(dir_ + "/run", classes, Stamp::fromSeconds(kDemoFirstStamp));
    for (int k = 0; k < kSnapshotScenes; ++k) writer.write(sceneAt(k));
    writer.close();
    RunRecord record;
    record.input = "demo.rawlog";
    record.simulated = true;
    writeRunRecord(dir_ + "/run/done.json", record);
  }
  void TearDown() override { fs::remove_all(dir_); }

  static Scene sceneAt(int k) {
    Scene scene;
    scene.stamp = Stamp::fromSeconds(kDemoFirstStamp) + 0.1 * k;
    scene.ego.stamp = scene.stamp;
    scene.frame = k;
    SceneObject car;
    car.id = 1;
    car.class_id = 1;
    car.class_probability = {0.02, 0.98};
    car.existence = 0.99;
    car.position = Vector3(15 - 0.1 * k, 2, 0);
    car.length = 4;
    car.width = 2;
    car.height = 1.5;
    scene.objects = {car};
    return scene;
  }

  int run(std::vector<std::string> options) {
    options.insert(options.begin(), {"perception-snapshot", "-r", dir_ + "/run"});
    std::vector<const char*> argv;
    for (const std::string& option : options) argv.push_back(option.c_str());
    app_ = std::make_unique<SnapshotApp>();
    return runApp(*app_, static_cast<int>(argv.size()), argv.data());
  }

  std::string dir_;
  std::unique_ptr<SnapshotApp> app_;
};

TEST_F(SnapshotAppTest, DrawsOneInstantWithoutLog) {
  testing::internal::CaptureStdout();
  ASSERT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/new folder/a.png"}), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), dir_ + "/new folder/a.png\n");
  EXPECT_GT(fs::file_size(dir_ + "/new folder/a.png"), 5000U);
  EXPECT_EQ(app_->out_picture.width, 1280);
  EXPECT_EQ(app_->out_picture.height, 720);
  EXPECT_GT(colorsOf(app_->out_picture), 100U);
}

TEST_F(SnapshotAppTest, TheEndingOfTheNameIsTheFormat) {
  const auto firstBytes = [this](const std::string& name) {
    std::string bytes(4, ' ');
    std::ifstream(dir_ + "/" + name, std::ios::binary).read(bytes.data(), 4);
    return bytes;
  };
  ASSERT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/a.jpg"}), 0);
  EXPECT_EQ(firstBytes("a.jpg").substr(0, 3), "\xff\xd8\xff");
  ASSERT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/a.PNG"}), 0);
  EXPECT_EQ(firstBytes("a.PNG"), "\x89PNG");
  EXPECT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/a.tiff"}), 64);
  EXPECT_EQ(run({"--video", dir_ + "/a.avi"}), 64);
  EXPECT_FALSE(fs::exists(dir_ + "/a.tiff") || fs::exists(dir_ + "/a.avi"));
}

TEST_F(SnapshotAppTest, LogAndTruthAddToThePicture) {
  ASSERT_EQ(run({"--frame", "20", "--view", "top", "-o", dir_ + "/a.png"}), 0);
  const Picture bare = app_->out_picture;
  ASSERT_EQ(run({"--frame", "20", "--view", "top", "-i", kDemoLog, "-t", kDemoTruth, "-o",
                 dir_ + "/b.png"}),
            0);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < bare.rgb.size(); ++i) {
    changed += bare.rgb[i] != app_->out_picture.rgb[i];
  }
  EXPECT_GT(changed, 5000U);
}

TEST_F(SnapshotAppTest, BothGridBackEndsDraw) {
  for (const char* back_end : {"octomap", "mrpt2d"}) {
    EXPECT_EQ(run({"--time", "2", "-i", kDemoLog, "--set", std::string("grid.back_end=") + back_end,
                   "-o", dir_ + "/a.png"}),
              0);
  }
}

TEST_F(SnapshotAppTest, EveryMakesAFolderOfPicturesAndASheet) {
  ASSERT_EQ(run({"--every", "1", "--view", "driver", "-o", dir_ + "/out"}), 0);
  EXPECT_EQ(app_->out_files.size(), 4U);
  EXPECT_TRUE(fs::exists(dir_ + "/out/t000000000ms.png"));
  EXPECT_TRUE(fs::exists(dir_ + "/out/t000002000ms.png"));
  EXPECT_TRUE(fs::exists(dir_ + "/out/contact.png"));
}

TEST_F(SnapshotAppTest, ContactMakesOneSheet) {
  ASSERT_EQ(run({"--contact", "4", "--view", "top", "-o", dir_ + "/sheet.png"}), 0);
  EXPECT_EQ(app_->out_files, std::vector<std::string>{dir_ + "/sheet.png"});
  EXPECT_GT(app_->out_picture.width, 1280);
}

TEST_F(SnapshotAppTest, SaysWhatIsWrongByExitCode) {
  const std::string out = dir_ + "/a.png";
  EXPECT_EQ(run({"--time", "100", "-o", out}), 64) << "outside of the run";
  EXPECT_EQ(run({"--frame", "1000", "-o", out}), 64);
  EXPECT_EQ(run({"-o", out}), 64) << "no instant";
  EXPECT_EQ(run({"--time", "1", "--frame", "1", "-o", out}), 64) << "two instants";
  EXPECT_EQ(run({"--time", "1", "-i", dir_ + "/missing.rawlog", "-o", out}), 66);
  EXPECT_EQ(run({"--time", "1", "-t", dir_ + "/missing.csv", "-o", out}), 66);
  EXPECT_EQ(run({"--time", "1", "--set", "grid.back_end=balltree", "-o", out}), 78);
  EXPECT_EQ(run({"--time", "1", "-o", dir_ + "/run/done.json/a.png"}), 73);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(SnapshotAppTest, UnfinishedRunIsDrawnWithAWarning) {
  fs::remove(dir_ + "/run/done.json");
  EXPECT_EQ(run({"--time", "1", "-o", dir_ + "/a.png"}), 3);
}

TEST_F(SnapshotAppTest, TornLogIsDrawnWithAWarning) {
  fs::copy_file(kDemoLog, dir_ + "/torn.rawlog");
  fs::resize_file(dir_ + "/torn.rawlog", fs::file_size(kDemoLog) / 8);
  EXPECT_EQ(run({"--time", "2.9", "-i", dir_ + "/torn.rawlog", "-o", dir_ + "/a.png"}), 3);
}

TEST_F(SnapshotAppTest, VideoPlaysAtTheLogsRate) {
  if (std::system("command -v ffmpeg > /dev/null") != 0) {
    EXPECT_EQ(run({"--video", dir_ + "/a.mp4", "--view", "top"}), 69);
    GTEST_SKIP() << "missing tool: ffmpeg";
  }
  ASSERT_EQ(run({"--video", dir_ + "/films/a.mp4", "--view", "top", "--from", "1", "--to", "1.6"}),
            0);
  EXPECT_EQ(app_->out_files, std::vector<std::string>{dir_ + "/films/a.mp4"});
  EXPECT_GT(fs::file_size(dir_ + "/films/a.mp4"), 5000U);
  EXPECT_FALSE(fs::exists(dir_ + "/films/a.mp4.part"));
  if (std::system("command -v ffprobe > /dev/null") != 0)
    GTEST_SKIP() << "missing tool: ffprobe (package ffmpeg)";
  const std::string ask =
      "ffprobe -v error -show_entries stream=r_frame_rate,nb_frames -of csv=p=0 '" + dir_ +
      "/films/a.mp4' > '" + dir_ + "/said.txt'";
  ASSERT_EQ(std::system(ask.c_str()), 0);
  std::string said;
  std::getline(std::ifstream(dir_ + "/said.txt"), said);
  EXPECT_EQ(said, "10/1,7");
}

TEST_F(SnapshotAppTest, EveryProductSaysOfWhichRunItIs) {
  const std::string mark = markOfRuns({dir_ + "/run"});
  const auto marked = [&](const std::string& name) { return runMark(markedRunsOf(dir_ + name)); };
  ASSERT_EQ(run({"--frame", "20", "--view", "top", "-i", kDemoLog, "-o", dir_ + "/a.png", "--scene",
                 dir_ + "/a.3Dscene", "--grid", dir_ + "/g.ot", "--grid", dir_ + "/g.bt", "--grid",
                 dir_ + "/g.gridmap.gz", "--grid", dir_ + "/g.png"}),
            0);
  for (const char* name : {"/a.png", "/a.3Dscene", "/g.ot", "/g.bt", "/g.gridmap.gz", "/g.png"})
    EXPECT_EQ(marked(name), mark) << name;
  ASSERT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/a.jpg"}), 0);
  EXPECT_EQ(marked("/a.jpg"), mark);
  for (const char* name : {"/a.png", "/a.jpg", "/g.png"}) {
    mrpt::img::CImage image;
    ASSERT_TRUE(image.loadFromFile(dir_ + name)) << name;
    EXPECT_GT(image.getWidth(), 100u);
  }
  octomap::OcTree binary(0.1);
  EXPECT_TRUE(binary.readBinary(dir_ + "/g.bt"));
  const std::unique_ptr<octomap::AbstractOcTree> tree(
      octomap::AbstractOcTree::read(dir_ + "/g.ot"));
  EXPECT_TRUE(tree != nullptr);
  if (std::system("command -v ffmpeg > /dev/null") != 0) GTEST_SKIP() << "missing tool: ffmpeg";
  RunRecord other;
  other.input = "demo.rawlog";
  other.hash = std::string(64, 'b');
  fs::copy(dir_ + "/run", dir_ + "/other");
  writeRunRecord(dir_ + "/other/done.json", other);
  ASSERT_EQ(
      run({"-r", dir_ + "/other", "--video", dir_ + "/both.mp4", "--view", "top", "--to", "0.3"}),
      0);
  EXPECT_EQ(marked("/both.mp4"), markOfRuns({dir_ + "/run", dir_ + "/other"}));
}

TEST_F(SnapshotAppTest, WithoutFfmpegSaysWhatIsMissing) {
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nonexistent", 1);
  const int code = run({"--video", dir_ + "/a.mp4", "--view", "top"});
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(code, 69);
  EXPECT_FALSE(fs::exists(dir_ + "/a.mp4"));
}

TEST_F(SnapshotAppTest, TwoRunsStandSideBySide) {
  fs::copy(dir_ + "/run", dir_ + "/other");
  ASSERT_EQ(run({"-r", dir_ + "/other", "--time", "1", "--view", "top", "-o", dir_ + "/a.png"}), 0);
  const int beside = app_->out_picture.width;
  ASSERT_EQ(run({"--time", "1", "--view", "top", "-o", dir_ + "/a.png"}), 0);
  EXPECT_GT(beside, app_->out_picture.width + 900);
}

TEST_F(SnapshotAppTest, CameraViewShowsTheDetectorsViewOfALogWithoutImages) {
  ASSERT_EQ(run({"--frame", "20", "--view", "camera", "-i", kDemoLog, "-o", dir_ + "/a.png"}), 0);
  EXPECT_GT(colorsOf(app_->out_picture), 100U);
  EXPECT_EQ(run({"--frame", "20", "--view", "camera", "-o", dir_ + "/a.png"}), 64) << "no log";
  EXPECT_EQ(run({"--frame", "20", "--view", "camera", "--camera", "REAR", "-i", kDemoLog, "-o",
                 dir_ + "/a.png"}),
            64);
  EXPECT_EQ(run({"--frame", "20", "--view", "side", "-o", dir_ + "/a.png"}), 64);
}

TEST_F(SnapshotAppTest, CameraViewShowsThePanoramasOfALog) {
  const std::string log = PERCEPTION_SOURCE_DIR "/rawlogs/camera.rawlog";
  ASSERT_EQ(run({"--time", "2", "--view", "camera", "-i", log, "-o", dir_ + "/a.png"}), 0);
  const Picture& picture = app_->out_picture;
  const auto at = [&](double x, double y) {  // of the picture, as shares
    const auto i = 3 * (static_cast<std::size_t>(y * picture.height) *
                            static_cast<std::size_t>(picture.width) +
                        static_cast<std::size_t>(x * picture.width));
    return std::array<int, 3>{picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]};
  };
  EXPECT_GT(at(.4, .15)[2], at(.4, .15)[0] + 30) << "sky";
  EXPECT_NEAR(at(.3, .9)[2], at(.3, .9)[0], 15) << "road";
  EXPECT_LT(at(.3, .9)[2], 180);
  EXPECT_GT(colorsOf(picture), 5000U);
}

TEST_F(SnapshotAppTest, SiteSettingsDecideWhichReturnsAreDrawn) {
  // The run's own INI, with a lidar that looks no farther than ten meters.
  std::ofstream(dir_ + "/near.ini") << "include = " PERCEPTION_SOURCE_DIR
                                       "/ini/demo.ini\n"
                                       "[sensor.LIDAR_TOP.points]\nrange_max = 10\n";
  const std::vector<std::string> how = {"--frame", "20",     "--view", "top",
                                        "-i",      kDemoLog, "-o",     dir_ + "/a.png"};
  ASSERT_EQ(run(how), 0);
  const Picture all = app_->out_picture;
  std::vector<std::string> near = how;
  near.insert(near.end(), {"-c", dir_ + "/near.ini"});
  ASSERT_EQ(run(near), 0);
  const Picture by_option = app_->out_picture;
  EXPECT_NE(all.rgb, by_option.rgb);
  fs::copy_file(dir_ + "/near.ini", dir_ + "/run/effective.ini");
  ASSERT_EQ(run(how), 0);
  EXPECT_EQ(app_->out_picture.rgb, by_option.rgb);
}

TEST_F(SnapshotAppTest, DetailsAddMeasurementsAndNumbersOfThings) {
  const std::vector<std::string> plain = {
      "--frame", "20",           "-i", kDemoLog, "-c", PERCEPTION_SOURCE_DIR "/ini/demo.ini",
      "-o",      dir_ + "/a.png"};
  const auto purple = [&](std::vector<std::string> words) {
    EXPECT_EQ(run(words), 0);
    const std::vector<std::uint8_t>& rgb = app_->out_picture.rgb;
    int count = 0;
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
      count += rgb[i] > rgb[i + 1] + 40 && rgb[i + 2] > rgb[i] + 40;
    return count;
  };
  std::vector<std::string> details = plain;
  details.push_back("--details");
  EXPECT_LT(purple(plain) + 300, purple(details));
}

TEST_F(SnapshotAppTest, SceneFileIsThatOfOneInstant) {
  ASSERT_EQ(
      run({"--time", "1", "--view", "top", "-o", dir_ + "/a.png", "--scene", dir_ + "/a.3Dscene"}),
      0);
  EXPECT_GT(fs::file_size(dir_ + "/a.3Dscene"), 1000U);
  EXPECT_EQ(run({"--every", "1", "-o", dir_ + "/x", "--scene", dir_ + "/a.3Dscene"}), 64);
}

TEST_F(SnapshotAppTest, GridIsWrittenByTheEndingsOfItsFiles) {
  const std::vector<std::string> how = {"--frame", "20", "--view", "top", "-o", dir_ + "/a.png"};
  std::vector<std::string> with_grid = how;
  with_grid.insert(with_grid.end(), {"-i", kDemoLog, "--set", "grid.back_end=rolling"});
  const std::vector<std::string> endings = {".ot", ".bt", ".gridmap.gz", ".png"};
  for (const std::string& ending : endings)
    with_grid.insert(with_grid.end(), {"--grid", dir_ + "/grid" + ending});
  ASSERT_EQ(run(with_grid), 0);
  for (const std::string& ending : endings)
    EXPECT_GT(fs::file_size(dir_ + "/grid" + ending), 200U) << ending;
  std::vector<std::string> without_log = how;
  without_log.insert(without_log.end(), {"--grid", dir_ + "/b.png"});
  EXPECT_EQ(run(without_log), 64);
  with_grid.back() = dir_ + "/grid.pcd";
  EXPECT_EQ(run(with_grid), 64);
}

// One image a second of the run, in the log or beside it; the first is missing.
void writeImageLog(const std::string& path, bool embedded) {
  const std::string folder = path.substr(0, path.rfind('.')) + "_Images";
  fs::create_directories(folder);
  RawlogWriter log(path, 0);
  for (int k = 0; k < 3; ++k) {
    mrpt::obs::CObservationImage image;
    image.sensorLabel = "CAMERA_LEFT";
    image.timestamp = fromStamp(Stamp::fromSeconds(kDemoFirstStamp) + k);
    image.cameraParams.ncols = 200;
    image.cameraParams.nrows = 100;
    image.cameraParams.setIntrinsicParamsFromValues(150, 150, 100, 50);
    // Optical axes: x right, y down, z forward.
    image.cameraPose = mrpt::poses::CPose3D(0, 0, 1.5, -kPi / 2, 0, -kPi / 2);
    mrpt::img::CImage pixels(200, 100, mrpt::img::CH_RGB);
    pixels.filledRectangle(0, 0, 199, 99, mrpt::img::TColor(200, 30, 60));
    const std::string name = "left" + std::to_string(k) + ".png";
    if (embedded) {
      image.image = pixels;
    } else {
      if (k > 0) {
        EXPECT_TRUE(pixels.saveToFile(folder + "/" + name));
      }
      image.image.setExternalStorage(name);
    }
    log.write(image);
  }
  log.close();
}

TEST_F(SnapshotAppTest, ImagesInTheLogAndBesideItLieBelowTheBoxes) {
  const auto redPixels = [&] {
    int count = 0;
    for (int y = 0; y < app_->out_picture.height; ++y) {
      for (int x = 0; x < app_->out_picture.width; ++x) {
        const std::uint8_t* p = app_->out_picture.at(x, y);
        count += p[0] > 180 && p[1] < 50 && p[2] < 80;
      }
    }
    return count;
  };
  for (const bool embedded : {true, false}) {
    const std::string log = dir_ + (embedded ? "/in.rawlog" : "/beside.rawlog");
    writeImageLog(log, embedded);
    ASSERT_EQ(run({"--frame", "20", "--view", "camera", "-i", log, "-o", dir_ + "/a.png"}), 0);
    EXPECT_GT(redPixels(), 100000) << embedded;
    EXPECT_EQ(run({"--frame", "1", "--view", "camera", "-i", log, "-o", dir_ + "/a.png"}),
              embedded ? 0 : 3);
    EXPECT_EQ(redPixels() > 100000, embedded) << "a missing image is a warning";
  }
}

}  // namespace
}  // namespace perception
