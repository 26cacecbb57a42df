#include "libperception/app/detect/DetectApp.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationImage.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libperception/core/Csv.h"
#include "libperception/core/math/Angle.h"
#include "libperception/detection/DetectLabels.h"
#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/VisionSimd.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "tests/support/DpmText.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

constexpr int kWidth = 320, kHeight = 160, kX = 96, kY = 64;  // [px] of the object

// A board on gray: what the detector of these tests looks for.
cv::Mat picture(int shift) {
  cv::Mat image(kHeight, kWidth, CV_8UC3);
  cv::RNG random(5);
  random.fill(image, cv::RNG::UNIFORM, 118, 122);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      image.at<cv::Vec3b>(kY + y, kX + shift + x) =
          cv::Vec3b::all(((x / 13 + (y / 12) * (y / 12)) % 2) ? 230 : 20);
  return image;
}

// Writes a bank whose only component is the board, and the INI of a detector that takes it.
void writeDetector(const test::TemporaryFolder& folder) {
  const cv::Mat image = picture(0);
  Raster raster{image.cols, image.rows, 3, {image.datastart, image.dataend}};
  const auto maps =
      hogFeatures(planarImage(raster), {{8, {12, 20}, {8, 14}}}, visionKernels(simdLevel()));
  DpmComponent c;
  c.width = c.root.width = 8;
  c.height = c.root.height = 6;
  c.heading = 1;
  c.root.weights.assign(maps[0].values.data(), maps[0].values.data() + 8 * 6 * 32);
  double mean = 0, square = 0;
  for (const float w : c.root.weights) mean += static_cast<double>(w) / (8 * 6 * 32);
  for (float& w : c.root.weights) {
    w -= static_cast<float>(mean);
    square += static_cast<double>(w * w);
  }
  c.offset = -0.8 * square;
  DpmModel model;
  model.class_name = "board";
  model.components = {c};
  std::ofstream(folder / "board.txt") << test::dpmModelText(model);
  std::ofstream(folder / "detector.ini")
      << "[detector]\nbackend = dpm\nfolder = .\n[model.board]\nfile = board.txt\nlabel = Car\n"
         "threshold = -2\nslope = 2\neven_score = -0.5\n";
}

int detect(DetectApp& app, const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"perception-detect"};
  for (const std::string& a : arguments) argv.push_back(a.c_str());
  return runApp(app, static_cast<int>(argv.size()), argv.data());
}

TEST(DetectApp, ImagesGiveBoxesPicturesAndPrecision) {
  const test::TemporaryFolder folder;
  writeDetector(folder);
  std::filesystem::create_directories(folder / "images");
  std::filesystem::create_directories(folder / "labels");
  for (int i = 0; i < 3; ++i) {
    cv::imwrite(folder / ("images/" + std::to_string(i) + ".png"), picture(24 * i));
    std::ofstream(folder / ("labels/" + std::to_string(i) + ".txt"))
        << "Car 0 0 1.1 " << kX + 24 * i << ' ' << kY << ' ' << kX + 24 * i + 64 << ' ' << kY + 48
        << " 1.5 1.6 4 0 1.6 10 1.1\n";
  }
  std::ofstream(folder / "images/3.png") << "no picture";
  std::ofstream(folder / "labels/3.txt") << "";
  DetectApp app;
  EXPECT_EQ(detect(app, {"-c", folder / "detector.ini", "-i", folder / "images", "--labels",
                         folder / "labels", "--pictures", "-o", folder / "out"}),
            3);  // one image could not be read
  EXPECT_EQ(app.out.images, 3);
  EXPECT_EQ(app.out.unreadable, 1);
  ASSERT_EQ(app.out.quality.size(), 1U);
  EXPECT_EQ(app.out.quality[0].right, 3);
  EXPECT_NEAR(app.out.quality[0].average_precision, 1, 1e-9);
  EXPECT_NEAR(degrees(app.out.quality[0].heading_median), degrees(0.1), 1e-6);
  const CsvTable boxes = CsvTable::fromFile(folder / "out/detections.csv");
  ASSERT_GE(boxes.rows(), 3U);
  EXPECT_EQ(boxes.text(0, boxes.column("image")), "0.png");
  EXPECT_NEAR(boxes.real(0, boxes.column("x1")), kX, 1e-6);
  EXPECT_NEAR(boxes.real(0, boxes.column("probability")),
              1 / (1 + std::exp(-2 * (boxes.real(0, boxes.column("score")) + 0.5))), 1e-3);
  const cv::Mat drawn = cv::imread(folder / "out/pictures/1.png");
  ASSERT_EQ(drawn.cols, kWidth);
  EXPECT_GT(cv::norm(drawn, picture(24), cv::NORM_L1), 0);
}

TEST(DetectApp, BoxesGoIntoTheLogBehindTheirImages) {
  const test::TemporaryFolder folder;
  writeDetector(folder);
  {
    RawlogWriter log(folder / "in.rawlog");
    for (int i = 0; i < 4; ++i) {
      mrpt::obs::CObservationImage image;
      image.timestamp = fromStamp(Stamp{1317038400000000000LL + i * 100000000LL});
      image.sensorLabel = i % 2 ? "OTHER" : "CAMERA";
      image.image = mrpt::img::CImage(picture(16 * i), mrpt::img::DEEP_COPY);
      image.cameraParams.ncols = kWidth;
      image.cameraParams.nrows = kHeight;
      image.cameraParams.setIntrinsicParamsFromValues(200, 200, 160, 80);
      log.write(image);
    }
    log.close();
  }
  DetectApp app;
  EXPECT_EQ(detect(app, {"-c", folder / "detector.ini", "-i", folder / "in.rawlog", "-o",
                         folder / "out.rawlog", "--camera", "CAMERA", "--label", "BOARDS", "--set",
                         "detector.ground_gate=false"}),
            0);
  EXPECT_EQ(app.out.images, 2);
  RawlogReader reader(folder / "out.rawlog");
  std::vector<std::string> order;
  double last_x = -1;
  while (const auto observation = reader.next()) {
    order.push_back(observation->sensorLabel);
    const auto* boxes = dynamic_cast<const CObservationObjectDetections*>(observation.get());
    if (boxes == nullptr) continue;
    ASSERT_FALSE(boxes->detections.objects.empty());
    const auto& best = boxes->detections.objects[0];
    EXPECT_EQ(best.label, "Car");
    EXPECT_EQ(boxes->detections.camera.width, kWidth);
    EXPECT_EQ(boxes->detections.camera.fx, 200);
    last_x = best.image_box->x1;
  }
  EXPECT_EQ(order,
            (std::vector<std::string>{"CAMERA", "BOARDS", "OTHER", "CAMERA", "BOARDS", "OTHER"}));
  EXPECT_NEAR(last_x, kX + 32, 1e-6);
}

/// What a pinhole of `focal` [px] at `yaw` [rad, to the right] sees, painted into a panorama.
void paint(const cv::Mat& image, double fx, double cx, double cy, double yaw, double occlusion,
           cv::Mat& panorama) {
  const double f = panorama.cols / kTwoPi, middle = 0.5 * panorama.cols - 0.5;
  for (int v = 0; v < panorama.rows; ++v) {
    for (int u = 0; u < panorama.cols; ++u) {
      const double right = wrapAngle((u - middle) / f - yaw);
      if (std::abs(right) > radians(44)) continue;
      const int x = cvRound(fx * std::tan(right) + cx);
      const int y = cvRound(fx * std::tan((v - occlusion) / f) / std::cos(right) + cy);
      if (x >= 0 && y >= 0 && x < image.cols && y < image.rows)
        panorama.at<cv::Vec3b>(v, u) = image.at<cv::Vec3b>(y, x);
    }
  }
}

double overlapOf(const CsvTable& t, std::size_t row, double x1, double y1, double x2, double y2) {
  const auto at = [&](const char* name) { return t.real(row, t.column(name)); };
  const double w = std::min(x2, at("x2")) - std::max(x1, at("x1"));
  const double h = std::min(y2, at("y2")) - std::max(y1, at("y1"));
  if (w <= 0 || h <= 0) return 0;
  const double own = (at("x2") - at("x1")) * (at("y2") - at("y1"));
  return w * h / (own + (x2 - x1) * (y2 - y1) - w * h);
}

TEST(DetectApp, AnyPictureOfTheFullCircleIsAPanorama) {
  const test::TemporaryFolder folder;
  writeDetector(folder);
  // 1501 columns are no multiple of 8, 420 rows a part of the sphere, the horizon off their middle.
  constexpr double kHorizon = 190, kFocal = 1501 / kTwoPi;
  cv::Mat panorama(420, 1501, CV_8UC3, cv::Scalar::all(120));
  const std::vector<double> yaws{0, radians(90), radians(180)};  // the last one over the seam
  for (const double yaw : yaws)
    paint(picture(0), kFocal, kX + 31.5, kY + 23.5, yaw, kHorizon, panorama);
  cv::imwrite(folder / "circle.jpg", panorama);
  DetectApp app;
  EXPECT_EQ(detect(app, {"-c", folder / "detector.ini", "-i", folder / "circle.jpg", "--set",
                         "camera.panorama=yes", "--set", "camera.horizon=190", "--set",
                         "dpm.enlarge=2", "--pictures", "-o", folder / "out"}),
            0);
  const CsvTable boxes = CsvTable::fromFile(folder / "out/detections.csv");
  for (const double yaw : yaws) {
    double u = 750 + yaw * kFocal, best = 0;
    for (std::size_t row = 0; row < boxes.rows(); ++row)
      best = std::max(best, overlapOf(boxes, row, u - 32, kHorizon - 24, u + 32, kHorizon + 24));
    EXPECT_GT(best, 0.6) << yaw;
  }
  const cv::Mat drawn = cv::imread(folder / "out/pictures/circle.png");
  EXPECT_EQ(drawn.cols, 1501);
  // Without the key it is an ordinary picture, as it is not twice as wide as high.
  EXPECT_EQ(detect(app, {"-c", folder / "detector.ini", "-i", folder / "circle.jpg"}), 0);
  // And no picture that is too high for a circle is a panorama.
  cv::imwrite(folder / "high.jpg", cv::Mat(420, 600, CV_8UC3, cv::Scalar::all(120)));
  EXPECT_EQ(detect(app, {"-c", folder / "detector.ini", "-i", folder / "high.jpg", "--set",
                         "camera.panorama=yes"}),
            65);
}

TEST(DetectApp, CarsOfRealPicturesAreFoundInAPanoramaOfThem) {
  const std::string shared = PERCEPTION_SHARED_DATA;
  const std::string data = shared + "/data/kitti_object13/";
  if (!std::filesystem::exists(data) || !std::filesystem::exists(shared + "/data/kitti_dpm_models"))
    GTEST_SKIP() << "no images or models in " << shared << "/data";
  // The four images with most clear cars, a quarter of the circle each; the first lies on the seam.
  const std::vector<std::string> names{"000008", "000010", "000003", "000004"};
  constexpr double kHorizon = 200, kFocal = 2600 / kTwoPi;
  cv::Mat panorama(460, 2600, CV_8UC3, cv::Scalar::all(120));
  struct Car {
    double x1, y1, x2, y2;
  };
  std::vector<Car> cars;
  const ImageLabels labels(data + "label_2", LabelRules{40, 0.3, 1});
  for (std::size_t i = 0; i < names.size(); ++i) {
    const CameraModel c = readKittiCalibration(data + "calib/" + names[i] + ".txt").camera;
    const double yaw = radians(180) + static_cast<double>(i) * radians(90);
    paint(cv::imread(data + "image_2/" + names[i] + ".png"), c.fx, c.cx, c.cy, yaw, kHorizon,
          panorama);
    for (const LabeledBox& l : labels.of(names[i] + ".png")) {
      if (l.label != "Car" || l.ignore || l.area) continue;
      const auto right = [&](double x) { return std::atan((x - c.cx) / c.fx); };
      const double middle = std::cos(0.5 * (right(l.box.x1) + right(l.box.x2)));
      const auto row = [&](double y) {
        return kHorizon + kFocal * std::atan((y - c.cy) / c.fy * middle);
      };
      const double left = 1299.5 + kFocal * (yaw + right(l.box.x1));
      const double shift = std::floor(left / 2600) * 2600;
      cars.push_back({left - shift, row(l.box.y1),
                      left - shift + kFocal * (right(l.box.x2) - right(l.box.x1)), row(l.box.y2)});
    }
  }
  ASSERT_GE(cars.size(), 7U);
  const test::TemporaryFolder folder;
  cv::imwrite(folder / "circle.jpg", panorama);
  DetectApp app;
  ASSERT_EQ(detect(app, {"-c", PERCEPTION_SOURCE_DIR "/ini/detectors/kitti_bank.ini", "--set",
                         "detector.folder=" + shared + "/data/kitti_dpm_models", "--set",
                         "camera.panorama=yes", "--set", "camera.horizon=200", "-i",
                         folder / "circle.jpg", "-o", folder / "out"}),
            0);
  const CsvTable boxes = CsvTable::fromFile(folder / "out/detections.csv");
  std::size_t found = 0;
  for (const Car& car : cars) {
    double best = 0;
    for (std::size_t row = 0; row < boxes.rows(); ++row) {
      if (boxes.text(row, boxes.column("label")) == "Car")
        best = std::max(best, overlapOf(boxes, row, car.x1, car.y1, car.x2, car.y2));
    }
    found += best > 0.5;
  }
  EXPECT_GE(found, cars.size() - cars.size() / 4) << "of " << cars.size();
}

TEST(DetectApp, SaysWhatIsMissing) {
  const test::TemporaryFolder folder;
  writeDetector(folder);
  cv::imwrite(folder / "a.png", picture(0));
  const std::string ini = folder / "detector.ini", image = folder / "a.png";
  const auto run = [](const std::vector<std::string>& arguments) {
    DetectApp app;
    return detect(app, arguments);
  };
  EXPECT_EQ(run({"-c", ini, "-i", folder / "b.png"}), 66);
  EXPECT_EQ(run({"-c", ini}), 64);
  EXPECT_EQ(run({"-c", ini, "-i", image, "--set", "model.board.file=none.txt"}), 66);
  EXPECT_EQ(run({"-c", ini, "-i", image, "--set", "detector.backend=eyes"}), 78);
  EXPECT_EQ(run({"-c", ini, "-i", image, "--labels", folder / "nowhere"}), 66);
}

// The figures of the README: 21 clear cars of KITTI's object benchmark.
TEST(DetectApp, BankOfSixteenFindsCarsAndTheirHeadings) {
  const std::string shared = PERCEPTION_SHARED_DATA;
  const std::string images = shared + "/data/kitti_object13/";
  if (!std::filesystem::exists(images) ||
      !std::filesystem::exists(shared + "/data/kitti_dpm_models"))
    GTEST_SKIP() << "no images or models in " << shared << "/data";
  DetectApp app;
  EXPECT_EQ(
      detect(app, {"-c", PERCEPTION_SOURCE_DIR "/ini/detectors/kitti_bank.ini", "--set",
                   "detector.folder=" + shared + "/data/kitti_dpm_models", "-i", images + "image_2",
                   "--calib", images + "calib", "--labels", images + "label_2"}),
      0);
  const auto car = std::find_if(app.out.quality.begin(), app.out.quality.end(),
                                [](const LabelQuality& q) { return q.label == "Car"; });
  ASSERT_NE(car, app.out.quality.end());
  EXPECT_EQ(car->labeled, 21);
  EXPECT_GE(car->average_precision, 0.88);
  EXPECT_LE(degrees(car->heading_median), 6);
  EXPECT_LE(car->flips, 2);
}

}  // namespace
}  // namespace perception
