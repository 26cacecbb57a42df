#include "libperception/importers/weather_sets/RadiateFiles.h"

#include <fmt/format.h>
#include <mrpt/containers/yaml.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/positions/ImportClock.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

/// RADIATE's class names in KITTI's terms; others are kept as they are.
std::string typeOf(const std::string& name) {
  static const std::map<std::string, std::string> kTypes = {{"car", "Car"},
                                                            {"van", "Van"},
                                                            {"truck", "Truck"},
                                                            {"bus", "Bus"},
                                                            {"bicycle", "Cyclist"},
                                                            {"pedestrian", "Pedestrian"},
                                                            {"motorbike", "Motorbike"}};
  const auto row = kTypes.find(name);
  return row == kTypes.end() ? name : row->second;
}

}  // namespace

FrameTimes readRadiateTimes(const fs::path& path) {
  FrameTimes times;
  const std::string name = path.string();
  forEachRow(name, kSpaces, [&](const TextRow& row) {
    row.expect(row.size() == 4, "4: Frame: N Time: SECONDS");
    const auto stamp = stampOfSeconds(row.text(3));
    if (!stamp) row.fail(3, "seconds since 1970");
    times[row.frame(1)] = *stamp;
  });
  if (times.empty()) throw DataError(name + ": no time in it");
  return times;
}

std::map<std::int64_t, std::vector<RadiateAnnotation>> readRadiateAnnotations(
    const std::string& path) {
  const auto fault = [&](const std::string& what) { throw DataError(path + ": " + what); };
  const auto json = nlohmann::json::parse(readBytes(path), nullptr, false);
  if (!json.is_array()) fault("no JSON list of objects");
  std::map<std::int64_t, std::vector<RadiateAnnotation>> by_frame;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const auto& object = json[i];
    const std::string place = fmt::format("object {}", i);
    if (!object.is_object() || !object.contains("id") || !object["id"].is_number_integer() ||
        !object.contains("class_name") || !object["class_name"].is_string() ||
        !object.contains("bboxes") || !object["bboxes"].is_array())
      fault(place + ": expected id, class_name and bboxes");
    for (std::size_t k = 0; k < object["bboxes"].size(); ++k) {
      const auto& box = object["bboxes"][k];
      if (box.is_array() && box.empty()) continue;  // not there in this frame
      const bool good = box.is_object() && box.contains("position") && box["position"].is_array() &&
                        box["position"].size() == 4 && box.contains("rotation") &&
                        box["rotation"].is_number() &&
                        std::all_of(box["position"].begin(), box["position"].end(),
                                    [](const auto& v) { return v.is_number(); });
      if (!good)
        fault(fmt::format("{}, box {}: expected position [x, y, w, h] and rotation", place, k));
      const auto& p = box["position"];
      by_frame[static_cast<std::int64_t>(k) + 1].push_back(
          {object["id"].get<std::int64_t>(), typeOf(object["class_name"].get<std::string>()),
           p[0].get<double>(), p[1].get<double>(), p[2].get<double>(), p[3].get<double>(),
           box["rotation"].get<double>()});
    }
  }
  return by_frame;
}

RadiateCalibration readRadiateCalibration(const std::string& path) {
  if (!fs::exists(path)) throw DataError(path + ": no such file", ExitCode::kNoInput);
  RadiateCalibration c;
  try {
    const auto yaml = mrpt::containers::yaml::FromFile(path);
    const auto place = [&](const char* name) {
      const auto t = yaml[name]["T"];
      return Vector3(t(0).as<double>(), t(1).as<double>(), t(2).as<double>());
    };
    c.lidar = place("lidar_calib");
    c.camera = place("left_cam_calib");
    const auto camera = yaml["left_cam_calib"];
    c.model.fx = camera["fx"].as<double>(), c.model.fy = camera["fy"].as<double>();
    c.model.cx = camera["cx"].as<double>(), c.model.cy = camera["cy"].as<double>();
    for (const char* name : {"k1", "k2", "p1", "p2", "k3"})
      c.distortion.push_back(camera[name].as<double>());
  } catch (const std::exception& e) {
    std::string what = e.what();
    throw DataError(fmt::format("{}: expected lidar_calib and left_cam_calib with T, fx ...: {}",
                                path, what.substr(0, what.find('\n'))));
  }
  return c;
}

std::vector<TimedFile> timedFiles(const std::filesystem::path& folder,
                                  const std::vector<std::string>& endings, const FrameTimes& times,
                                  bool wanted, ImportLog& log) {
  const std::string dir = folder.string();
  std::vector<TimedFile> timed;
  std::vector<std::int64_t> untimed;
  for (const FrameFile& file : frameFiles(dir, endings)) {
    if (wanted && !log.wants(file.number)) continue;
    const auto time = times.find(file.number);
    if (time == times.end()) {
      untimed.push_back(file.number);
    } else {
      timed.push_back({file, time->second});
    }
  }
  if (!untimed.empty()) {
    log.warn(fmt::format("{}: no time in {}.txt for {} frames (first: {}): left out", dir, dir,
                         untimed.size(), untimed.front()));
  }
  return timed;
}

LidarCloud readRadiateScan(const std::string& path) {
  CloudFormat format;
  format.columns = {"x", "y", "z", "intensity", "ring"};
  format.intensity_max = 255;
  format.max_range = 100;  // [m] HDL-32E, data sheet
  return readCloudFile(path, format);
}

std::vector<GpsFix> readRadiateFixes(const fs::path& dir, std::size_t& dropped) {
  const FrameTimes times = readRadiateTimes(dir / "GPS_IMU_Twist.txt");
  const CsvTable gps = CsvTable::fromFile((dir / "gps.csv").string());
  std::vector<GpsFix> all;
  for (std::size_t i = 0; i < gps.rows(); ++i) {
    const auto time = times.find(gps.integer(i, gps.column("frame")));
    if (time == times.end()) continue;
    all.push_back({time->second, gps.real(i, gps.column("lat_deg")),
                   gps.real(i, gps.column("lon_deg")), gps.real(i, gps.column("alt_m"))});
  }
  std::vector<GpsFix> fixes = steadyFixes(all, dropped);
  if (fixes.empty()) throw DataError((dir / "gps.csv").string() + ": no fix with a time");
  return fixes;
}

std::string radiateAnnotationFile(const fs::path& dir) {
  for (const char* name :
       {"annotations_18frames.json", "annotations/annotations.json", "annotations.json"}) {
    if (fs::exists(dir / name)) return (dir / name).string();
  }
  return {};
}

}  // namespace perception
