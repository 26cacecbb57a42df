// The engine of part models: a tile of 512 pixels and a whole panorama of 2048 x 1024 with 16 car
// and 8 pedestrian orientations, against cv::dpm in the same run; what each shortcut costs in
// average precision. The models and labeled images lie beside the project
// (PERCEPTION_SHARED_DATA).
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/dpm.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "libperception/detection/DetectLabels.h"
#include "libperception/detectors/ImageDetector.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/simd/Simd.h"

namespace {

using namespace perception;
namespace fs = std::filesystem;

const std::string kData = PERCEPTION_SHARED_DATA "/data/";
constexpr int kRepeats = 7;

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Raster rasterOf(const cv::Mat& image) {
  Raster out{image.cols, image.rows, 3, {}};
  for (int y = 0; y < image.rows; ++y)
    out.pixels.insert(out.pixels.end(), image.ptr<std::uint8_t>(y),
                      image.ptr<std::uint8_t>(y) + image.cols * 3);
  return out;
}

// Streets all around: two of KITTI's images, stretched.
Raster panorama() {
  cv::Mat all(1024, 2048, CV_8UC3);
  const char* names[2] = {"000008.png", "000010.png"};
  for (int i = 0; i < 2; ++i) {
    cv::Mat half = all.colRange(1024 * i, 1024 * (i + 1));
    cv::resize(cv::imread(kData + "kitti_object13/image_2/" + names[i]), half, half.size());
  }
  return rasterOf(all);
}

Raster tile() {
  cv::Mat out;
  const cv::Mat image = cv::imread(kData + "kitti_object13/image_2/000008.png");
  cv::resize(image.colRange(300, 812), out, {512, 512});
  return rasterOf(out);
}

/// Median CPU and wall seconds on a number of threads.
struct Cost {
  double cpu = 0, wall = 0;
};
Cost costOf(int threads, int repeats, const std::function<void()>& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  cv::setNumThreads(threads);
  work();
  std::vector<double> cpu, wall;
  for (int i = 0; i < repeats; ++i) {
    const double c = cpuSeconds(), w = wallSeconds();
    work();
    cpu.push_back(cpuSeconds() - c);
    wall.push_back(wallSeconds() - w);
  }
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  return {median(cpu), median(wall)};
}

DetectorSetup bank(bool people) {
  DetectorSetup setup;
  setup.folder = kData + "kitti_dpm_models";
  DetectorModelParams car;
  car.file = "car_orient16.txt.gz";
  car.label = "Car";
  car.threshold = -0.6;
  car.low = 1.1;
  car.high = 2.4;
  setup.models.emplace_back("car", car);
  if (people) {
    DetectorModelParams person = car;
    person.file = "pedestrian_orient8.txt.gz";
    person.label = "Pedestrian";
    person.low = 1.0;
    person.high = 2.1;
    setup.models.emplace_back("pedestrian", person);
  }
  return setup;
}

/// The peer: star cascades of OpenCV's contributed modules.
cv::Ptr<cv::dpm::DPMDetector> cascades() {
  const std::string folder = PERCEPTION_SHARED_DATA "/models/";
  return cv::dpm::DPMDetector::create({folder + "car_voc2007.xml", folder + "person_voc2007.xml"},
                                      {"Car", "Pedestrian"});
}

Pose3 roofCamera(double height) {
  Pose3 pose = Pose3::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() = Vector3(0, 0, height);
  return pose;
}

std::string memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM", 0) == 0) return line.substr(line.find_first_not_of(": \tVmHWM"));
  }
  return "?";
}

void print(const std::string& what, const Cost& one, const Cost& all) {
  fmt::print("{:58} {:7.0f} {:9.0f} {:9.0f}\n", what, 1e3 * one.cpu, 1e3 * all.cpu, 1e3 * all.wall);
}

bool same(const ObjectDetections& a, const ObjectDetections& b) {
  if (a.objects.size() != b.objects.size()) return false;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    if (a.objects[i].score != b.objects[i].score ||
        a.objects[i].image_box->x1 != b.objects[i].image_box->x1)
      return false;
  }
  return true;
}

void costs(int threads) {
  const Raster small = tile(), whole = panorama();
  const Panorama sphere(whole.width);
  const std::optional<Pose3> roof = roofCamera(2.5);
  fmt::print("\n{:58} {:>7} {:>9} {:>9}\n", "milliseconds (median)", "CPU, 1", "CPU, all",
             "wall, all");
  struct Row {
    const char* name;
    DetectorSetup setup;
    bool gate;
  };
  std::vector<Row> rows;
  rows.push_back({"car 16 + pedestrian 8, whole image", bank(true), false});
  rows.push_back({"car 16 + pedestrian 8, ground gate", bank(true), true});
  rows.push_back({"ground gate, enlarged twice", bank(true), true});
  rows.back().setup.dpm.options.enlarge = 2;
  rows.push_back({"not enlarged, ground gate, 10 levels an octave", bank(true), true});
  rows.back().setup.dpm.options.levels_per_octave = 10;
  rows.push_back({"car 16 alone, whole image", bank(false), false});
  for (const Row& row : rows) {
    const ImageDetector detector(row.setup);
    const std::optional<Pose3> pose = row.gate ? roof : std::nullopt;
    ObjectDetections one, all;
    for (const bool wide : {false, true}) {
      const auto work = [&](ObjectDetections& out) {
        out = wide ? detector.detect(whole, sphere.camera(), pose)
                   : detector.detect(small, sphere.tileCamera(), pose);
      };
      const Cost alone = costOf(1, kRepeats, [&] { work(one); });
      const Cost together = costOf(threads, kRepeats, [&] { work(all); });
      print(fmt::format("{} {}{}", wide ? "panorama 2k:" : "tile 512:   ", row.name,
                        same(one, all) ? "" : "  DIFFERS BY THREADS"),
            alone, together);
    }
  }
  fmt::print("peak memory so far {}\n", memory());
  const cv::Ptr<cv::dpm::DPMDetector> peer = cascades();
  const cv::Mat pixels(small.height, small.width, CV_8UC3,
                       const_cast<std::uint8_t*>(small.pixels.data()));
  const auto peer_tile = [&] {
    cv::Mat copy = pixels.clone();  // cv::dpm changes its input
    std::vector<cv::dpm::DPMDetector::ObjectDetection> found;
    peer->detect(copy, found);
  };
  const Cost alone = costOf(1, 3, peer_tile), together = costOf(threads, 3, peer_tile);
  print("tile 512:    cv::dpm, 6 car + 6 person components, no heading", alone, together);
  fmt::print("peak memory with cv::dpm {}\n", memory());
}

/// Average precision and headings of the labeled images, CPU seconds an image on one core.
void quality(const std::string& what, const DetectorSetup& setup) {
  const std::string folder = kData + "kitti_object13/";
  const ImageLabels labels(folder + "label_2", LabelRules{});
  DetectionQuality judge(0.5, 25);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const ImageDetector detector(setup);
  double cpu = 0;
  int images = 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder + "image_2"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const Raster image = rasterOf(cv::imread(file.string()));
    const CameraModel camera =
        readKittiCalibration(folder + "calib/" + file.stem().string() + ".txt").camera;
    const double start = cpuSeconds();
    const auto found = detector.detect(image, camera, roofCamera(1.65));
    cpu += cpuSeconds() - start;
    ++images;
    judge.add(labels.of(file.filename().string()), found.objects);
  }
  for (const LabelQuality& q : judge.results()) {
    if (q.label != "Car") continue;
    int strong = 0;  // wrong boxes above the makers' threshold for ordinary use
    for (const JudgedBox& b : judge.judged("Car")) strong += !b.right && b.score > 0;
    fmt::print("{:46} {:6.3f} {:6.3f} {:7d} {:9.1f} {:6d} {:9.0f}\n", what, q.average_precision,
               q.recall, strong, degrees(q.heading_median), q.flips, 1e3 * cpu / images);
  }
}

void shortcuts() {
  fmt::print(
      "\n21 clear cars of 13 images, 1242 x 375   AP     recall   wrong>0  median deg  flips  "
      "CPU ms\n");
  const auto exact = [] {
    DetectorSetup s = bank(false);
    s.ground_gate = false;
    s.dpm.options.levels_per_octave = 10;
    s.dpm.options.enlarge = 2;
    s.dpm.options.outside = 1;
    s.dpm.options.window = 10;
    return s;
  };
  DetectorSetup s = exact();
  quality("none: 10 levels, window 10, all outside, x2", s);
  s = exact(), s.dpm.options.window = 4;
  quality("window 4 (voc-release5)", s);
  s = exact(), s.dpm.options.outside = 0.4;
  quality("objects at most 40 % outside the image", s);
  s = exact(), s.dpm.options.levels_per_octave = 5;
  quality("5 levels an octave", s);
  s = exact(), s.ground_gate = true;
  quality("ground gate", s);
  s = exact(), s.dpm.options.enlarge = 1;
  quality("not enlarged", s);
  s = bank(false), s.dpm.options.enlarge = 2;
  quality("all but the last: as shipped", s);
  s.dpm.options.levels_per_octave = 4;
  quality("the same with 4 levels an octave", s);
  s.dpm.options.levels_per_octave = 3;
  quality("the same with 3 levels an octave", s);
}

}  // namespace

int main() {
  if (!fs::exists(kData + "kitti_dpm_models")) {
    fmt::print("no models in {}: nothing to measure\n", kData);
    return 0;
  }
  const int threads = tbb::info::default_concurrency();
  fmt::print("part models, {} ({}), {} threads\n", nameOf(simdLevel()), CV_VERSION, threads);
  costs(threads);
  shortcuts();
  return 0;
}
