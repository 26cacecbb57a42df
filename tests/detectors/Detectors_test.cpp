#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/detectors/DetectionQuality.h"
#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/ImageDetector.h"
#include "libperception/detectors/Suppression.h"
#include "libperception/detectors/VisionSimd.h"
#include "libperception/detectors/networks/OnnxOutput.h"
#include "tests/support/DpmText.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

ObjectDetection car(double x, double score, std::optional<double> heading = {}) {
  ObjectDetection o;
  o.label = "Car";
  o.score = score;
  o.image_box = ObjectDetection::ImageBox{x, 100, x + 100, 160};
  o.heading = heading;
  return o;
}

LabeledBox truth(double x, const std::string& label = "Car") {
  LabeledBox l;
  l.label = label;
  l.box = {x, 100, x + 100, 160};
  l.heading = 0;
  return l;
}

TEST(DetectionQuality, AveragePrecisionIsTheAreaUnderTheCurve) {
  DetectionQuality quality(0.5, 25);
  // Best first: right, wrong, right; the third car is missed. Precision 1 up to recall 1/3, then
  // 2/3.
  quality.add({truth(0), truth(300), truth(600)}, {car(2, 3), car(150, 2), car(305, 1)});
  const auto q = quality.results();
  ASSERT_EQ(q.size(), 1U);
  EXPECT_EQ(q[0].right, 2);
  EXPECT_EQ(q[0].wrong, 1);
  EXPECT_NEAR(q[0].recall, 2.0 / 3, 1e-12);
  EXPECT_NEAR(q[0].average_precision, 1.0 / 3 + 2.0 / 9, 1e-12);
}

TEST(DetectionQuality, IgnoredLabelsCountForNothing) {
  LabeledBox hidden = truth(0), area;
  hidden.ignore = true;
  area.area = true;
  area.box = {200, 0, 400, 300};
  ObjectDetection small = car(600, 1);
  small.image_box->y2 = small.image_box->y1 + 20;
  DetectionQuality quality(0.5, 25);
  quality.add({hidden, area}, {car(0, 5), car(250, 4), small});
  EXPECT_TRUE(quality.judged("Car").empty());
  // A second box on one car is wrong, and a hidden pedestrian excuses no car.
  LabeledBox person = truth(0, "Pedestrian");
  person.ignore = true;
  quality.add({truth(300), person}, {car(300, 3), car(310, 2), car(0, 1)});
  const auto q = quality.results();
  EXPECT_EQ(q[0].right, 1);
  EXPECT_EQ(q[0].wrong, 2);
}

TEST(DetectionQuality, FlipsAreCountedAndTurnedBack) {
  DetectionQuality quality(0.5, 25);
  quality.add({truth(0), truth(300), truth(600)},
              {car(0, 3, radians(5)), car(300, 2, radians(-170)), car(600, 1, radians(-20))});
  const auto q = quality.results()[0];
  EXPECT_EQ(q.flips, 1);
  EXPECT_NEAR(degrees(q.heading_median), 10, 1e-9);
  EXPECT_NEAR(degrees(q.heading_rms), std::sqrt((25 + 100 + 400) / 3.0), 1e-9);
}

TEST(ScoreCalibration, RecoversTheLogisticThatMadeTheScores) {
  std::mt19937 random(1);
  std::vector<JudgedBox> boxes;
  constexpr double kSlope = 3, kEven = 0.4;
  for (int i = 0; i < 20000; ++i) {
    const double score = -1 + 3 * (static_cast<double>(random()) / 4294967296.0);
    const double p = 1 / (1 + std::exp(-kSlope * (score - kEven)));
    boxes.push_back({score, static_cast<double>(random()) / 4294967296.0 < p, 40, {}});
  }
  const auto fit = fitLogistic(boxes);
  ASSERT_TRUE(fit);
  // Standard deviations by Fisher information: about .045 and .011; four of them.
  EXPECT_NEAR(fit->slope, kSlope, 0.18);
  EXPECT_NEAR(fit->even_score, kEven, 0.045);
  EXPECT_FALSE(fitLogistic({{1, true, 40, {}}, {2, true, 40, {}}}));
}

TEST(ScoreCalibration, ScoresBecomeLogOddsOfTheirModel) {
  DetectorSetup setup;
  DetectorModelParams m;
  m.label = "Car";
  m.slope = 4;
  m.even_score = 0.5;
  setup.models = {{"car", m}};
  ObjectDetection person = car(0, 0.7);
  person.label = "Pedestrian";
  std::vector<ObjectDetection> objects{car(0, 1), person};
  EXPECT_EQ(calibrateScores(setup, objects), 1U);
  EXPECT_NEAR(objects[0].score, 2, 1e-12);
  EXPECT_EQ(objects[1].score, 0.7);
}

TEST(GroundGate, AdmitsWhatIsAsHighAsItShouldBe) {
  CameraModel camera;
  camera.width = camera.height = 512;
  camera.fx = camera.fy = 256;
  camera.cx = camera.cy = 255.5;
  Pose3 pose = Pose3::Identity();  // optical axis along x, level, 2.5 m up
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() = Vector3(0, 0, 2.5);
  const auto gate = groundGate(camera, pose, {}, radians(0.5));
  ASSERT_TRUE(gate);
  EXPECT_NEAR(gate->horizon, 255.5, 1e-9);
  for (const double range : {6.0, 12.0, 25.0}) {
    const double foot = 255.5 + 256 * 2.5 / range, pixels = 256 * 1.5 / range;
    EXPECT_TRUE(gate->admits(foot - pixels, foot, 1.2, 2));
    EXPECT_FALSE(gate->admits(foot - 3 * pixels, foot, 1.2, 2)) << range;
  }
  pose.translation().z() = 0;
  EXPECT_FALSE(groundGate(camera, pose, {}, 0.01));
}

TEST(OnnxOutput, LayoutsAreToldByTheirShapes) {
  EXPECT_EQ(guessOnnxLayout({3549, 85}, 416), OnnxLayout::kYolox);
  EXPECT_EQ(guessOnnxLayout({25200, 85}, 640), OnnxLayout::kYolov5);
  EXPECT_EQ(guessOnnxLayout({84, 8400}, 640), OnnxLayout::kYolov8);
  EXPECT_EQ(guessOnnxLayout({3, 3}, 640), OnnxLayout::kUnknown);
}

TEST(OnnxOutput, EveryLayoutGivesTheSameBox) {
  constexpr int kSide = 64, kClasses = 3;      // 64 + 16 + 4 cells
  constexpr int kCells = 84, kPlace = 64 + 5;  // stride 16, row 1, column 1
  const auto expectBox = [](const std::vector<OnnxBox>& boxes) {
    ASSERT_EQ(boxes.size(), 1U);
    EXPECT_EQ(boxes[0].index, 2);
    EXPECT_NEAR(boxes[0].score, 0.72, 1e-6);
    EXPECT_NEAR(boxes[0].box.x1, 24 - 16, 1e-4);
    EXPECT_NEAR(boxes[0].box.x2, 24 + 16, 1e-4);
    EXPECT_NEAR(boxes[0].box.y1, 28 - 8, 1e-4);
    EXPECT_NEAR(boxes[0].box.y2, 28 + 8, 1e-4);
  };
  std::vector<float> x(kCells * (5 + kClasses), 0.F);
  float* cell = &x[kPlace * (5 + kClasses)];
  cell[0] = 0.5F, cell[1] = 0.75F, cell[2] = std::log(2.F), cell[3] = 0, cell[4] = 0.9F;
  cell[7] = 0.8F;
  expectBox(decodeOnnxOutput(x.data(), {kCells, 5 + kClasses}, OnnxLayout::kYolox, kSide, 0.1));
  cell[0] = 24, cell[1] = 28, cell[2] = 32, cell[3] = 16;
  expectBox(decodeOnnxOutput(x.data(), {kCells, 5 + kClasses}, OnnxLayout::kYolov5, kSide, 0.1));
  std::vector<float> v8((4 + kClasses) * kCells, 0.F);
  const float values[7] = {24, 28, 32, 16, 0, 0, 0.72F};
  for (int k = 0; k < 7; ++k) v8[static_cast<std::size_t>(k * kCells + kPlace)] = values[k];
  expectBox(decodeOnnxOutput(v8.data(), {4 + kClasses, kCells}, OnnxLayout::kYolov8, kSide, 0.1));
}

TEST(DetectorSetup, ModelsAreInItsFolderOrWhereTheEnvironmentSays) {
  const TemporaryFolder here, elsewhere;
  DetectorSetup setup;
  setup.folder = here / "";
  DetectorModelParams model;
  model.file = "a.xml";
  ::setenv("PERCEPTION_MODELS", (elsewhere / "").c_str(), 1);
  EXPECT_THROW(setup.pathOf(model), DataError);
  std::ofstream(elsewhere / "a.xml") << "of the environment";
  EXPECT_EQ(setup.pathOf(model), elsewhere / "a.xml");
  std::ofstream(here / "a.xml") << "of the folder";
  EXPECT_EQ(setup.pathOf(model), here / "a.xml");
  ::unsetenv("PERCEPTION_MODELS");
}

TEST(OnnxDetector, RefusesWhatIsNoNetwork) {
  const TemporaryFolder folder;
  DetectorSetup setup;
  setup.backend = 1;
  DetectorModelParams model;
  model.file = folder / "no.onnx";
  model.names = {"2=Car"};
  setup.models = {{"net", model}};
  EXPECT_THROW(makeDetector(setup), DataError);  // there is no such file
  std::ofstream(folder / "no.onnx") << "this is no network";
  EXPECT_THROW(makeDetector(setup), DataError);
}

TEST(OnnxDetector, RefusesAnInputSizeThatTheNetworkCannotTake) {
  const std::string shared = PERCEPTION_SHARED_DATA;
  DetectorModelParams net;
  net.file = shared + "/models/yolox_nano.onnx";
  net.names = {"2=Car"};
  if (!std::filesystem::exists(net.file)) GTEST_SKIP() << "no " << net.file;
  DetectorSetup setup;
  setup.backend = 1;
  setup.models = {{"net", net}};
  setup.onnx.input = 100;  // it takes 416, or another multiple of its stride
  try {
    makeDetector(setup);
    FAIL() << "another size was accepted";
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("input"), std::string::npos) << e.what();
  }
}

// A long street, 1242 x 375, shown to a network of 416 x 416.
TEST(OnnxDetector, WindowsShowALongImageAtItsOwnScale) {
  const std::string shared = PERCEPTION_SHARED_DATA;
  const std::string file = shared + "/data/kitti_object13/image_2/000008.png";
  DetectorModelParams net;
  net.file = shared + "/models/yolox_nano.onnx";
  net.names = {"2=Car"};
  net.threshold = 0.3;
  const cv::Mat pixels = cv::imread(file);
  if (pixels.empty() || !std::filesystem::exists(net.file)) GTEST_SKIP() << "no " << file;
  const Raster image{pixels.cols, pixels.rows, 3, {pixels.datastart, pixels.dataend}};
  const auto boxesOf = [&](bool windows, double overlap) {
    DetectorSetup setup;
    setup.backend = 1;
    setup.models = {{"net", net}};
    setup.onnx.windows = windows;
    setup.onnx.window_overlap = overlap;
    return makeDetector(setup)->detect(image, {});
  };
  const auto whole = boxesOf(false, 0.5), cut = boxesOf(true, 0.5);
  EXPECT_GT(cut.size(), whole.size());
  EXPECT_GE(cut.size(), 5U);  // six cars, one of them far
  // No car is there twice, wherever the windows end.
  for (const auto& boxes : {cut, boxesOf(true, 0.3)}) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_LT(overlapOf(*boxes[i].image_box, *boxes[k].image_box), 0.46);
  }
}

Raster plain(int width, int height) {
  Raster r;
  r.width = width;
  r.height = height;
  std::mt19937 random(3);
  for (int i = 0; i < width * height * 3; ++i)
    r.pixels.push_back(static_cast<std::uint8_t>(120 + random() % 4));
  return r;
}

void paint(Raster& r, int x, int y, int value) {
  x = ((x % r.width) + r.width) % r.width;
  for (int c = 0; c < 3; ++c)
    r.pixels[static_cast<std::size_t>((y * r.width + x) * 3 + c)] =
        static_cast<std::uint8_t>(value);
}

// A board of black and white fields, no two rows alike; columns wrap.
void paintBoard(Raster& r, int x0, int y0, int width, int height) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      paint(r, x0 + x, y0 + y,
            ((x * 5 / width + (y * 4 / height) * (y * 4 / height)) % 2) ? 230 : 20);
}

#ifdef PERCEPTION_DPM
TEST(ImageDetector, AnObjectOnTheSeamOfAPanoramaIsOne) {
  constexpr int kWidth = 1024, kBoardWidth = 64, kBoardHeight = 48;
  // The template is the board as the tile ahead shows it.
  Raster ahead = plain(kWidth, kWidth / 2);
  paintBoard(ahead, kWidth / 2 - kBoardWidth / 2, 260, kBoardWidth, kBoardHeight);
  const Panorama sphere(kWidth);
  const Raster tile = sphere.tile(ahead, 0);
  const auto maps =
      hogFeatures(planarImage(tile), {{8, {10, 22}, {14, 24}}}, visionKernels(simdLevel()));
  // Board in the tile: about 50 pixels either side of the middle, rows from the horizon down.
  DpmComponent c;
  c.width = c.root.width = 8;
  c.height = c.root.height = 6;
  const int x0 = 12, y0 = 16;
  double mean = 0, square = 0;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x)
      for (int k = 0; k < 32; ++k) c.root.weights.push_back(maps[0].cell(x0 + x, y0 + y)[k]);
  for (const float w : c.root.weights) mean += static_cast<double>(w);
  mean /= static_cast<double>(c.root.weights.size());
  for (float& w : c.root.weights) {
    w -= static_cast<float>(mean);
    square += static_cast<double>(w * w);
  }
  c.offset = -0.7 * square;
  DpmModel model;
  model.class_name = "Board";
  model.components = {c};
  const TemporaryFolder folder;
  std::ofstream(folder / "board.txt") << test::dpmModelText(model);
  DetectorSetup setup;
  setup.folder = folder.path();
  DetectorModelParams params;
  params.file = "board.txt";
  params.threshold = 0;
  setup.models = {{"board", params}};
  const ImageDetector detector(setup);

  const auto found = detector.detect(ahead, sphere.camera(), {});
  ASSERT_EQ(found.objects.size(), 1U);
  const auto& there = *found.objects[0].image_box;
  Raster behind = plain(kWidth, kWidth / 2);
  paintBoard(behind, kWidth - kBoardWidth / 2, 260, kBoardWidth, kBoardHeight);
  const auto seam = detector.detect(behind, sphere.camera(), {});
  ASSERT_EQ(seam.objects.size(), 1U);
  const auto& here = *seam.objects[0].image_box;
  // The same box half a turn on.
  EXPECT_NEAR(wrapAngle(((here.x1 + here.x2) - (there.x1 + there.x2)) / 2 / kWidth * kTwoPi - kPi),
              0, radians(0.5));
  EXPECT_NEAR(here.y2, there.y2, 1);
  EXPECT_GT(here.x2, kWidth);
}
#else
TEST(Detector, ABackEndThatIsNotBuiltIsAConfigurationFault) {
  EXPECT_THROW(makeDetector(DetectorSetup()), ConfigError);  // dpm
  Config config = Config::fromText("[detector]\nbackend = dpm\n[model.board]\nfile = board.txt\n");
  DetectorSetup::read(config);
  EXPECT_THROW(config.finish(), ConfigError);
}
#endif

}  // namespace
}  // namespace perception::test
