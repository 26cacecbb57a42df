#include "libperception/importers/kitti/KittiRawFiles.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/StampText.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// R and T of a file.
Pose3 transformIn(const std::string& path) {
  std::optional<Pose3> rotation;
  std::optional<Vector3> place;
  forEachRow(path, " \t\r:", [&](const TextRow& row) {
    if (row.text(0) == "R") rotation = row.rotation33(1);
    if (row.text(0) == "T") {
      row.expect(row.size() == 4, "three numbers");
      place = Vector3(row.real(1), row.real(2), row.real(3));
    }
  });
  if (!rotation || !place) throw DataError(path + ": expected lines R and T");
  rotation->translation() = *place;
  return *rotation;
}

using Element = tinyxml2::XMLElement;

[[noreturn]] void failAt(const std::string& path, const Element& element, const char* expected) {
  throw DataError(
      fmt::format("{}:{}: {}: expected {}", path, element.GetLineNum(), element.Name(), expected));
}

const Element& childOf(const std::string& path, const Element& parent, const char* name) {
  const Element* const child = parent.FirstChildElement(name);
  if (child == nullptr) failAt(path, parent, fmt::format("an element {}", name).c_str());
  return *child;
}

double realIn(const std::string& path, const Element& parent, const char* name) {
  const Element& child = childOf(path, parent, name);
  double value = 0;
  if (child.QueryDoubleText(&value) != tinyxml2::XML_SUCCESS || !std::isfinite(value))
    failAt(path, child, "a number");
  return value;
}

int wholeIn(const std::string& path, const Element& parent, const char* name) {
  const Element* const child = parent.FirstChildElement(name);
  int value = -1;  // the development kit's word for "not set"
  if (child != nullptr && child->QueryIntText(&value) != tinyxml2::XML_SUCCESS)
    failAt(path, *child, "a whole number");
  return value;
}

KittiTracklet trackletAt(const std::string& path, const Element& pose, const KittiTracklet& of) {
  constexpr int kUnknownOcclusion = 3, kLargelyOccluded = 2, kOutside = 2;
  KittiTracklet at = of;
  at.box.bottom_center = {realIn(path, pose, "tx"), realIn(path, pose, "ty"),
                          realIn(path, pose, "tz")};
  at.box.yaw = realIn(path, pose, "rz");
  const int occlusion = wholeIn(path, pose, "occlusion");
  at.occluded = occlusion < 0 || occlusion > kLargelyOccluded ? kUnknownOcclusion : occlusion;
  const int truncation = wholeIn(path, pose, "truncation");
  at.cut = truncation == 1, at.outside = truncation == kOutside;
  return at;
}

}  // namespace

KittiCalibration readKittiRawCalibration(const std::string& folder) {
  const auto file = [&](const char* name) { return (fs::path(folder) / name).string(); };
  const std::string cameras = file("calib_cam_to_cam.txt");
  std::optional<Pose3> rectification;
  std::optional<Eigen::Matrix<double, 3, 4>> P;
  forEachRow(cameras, " \t\r:", [&](const TextRow& row) {
    if (row.text(0) == "R_rect_00") rectification = row.rotation33(1);
    if (row.text(0) == "P_rect_02") P = row.matrix34(1);
  });
  if (!rectification || !P) throw DataError(cameras + ": expected lines R_rect_00 and P_rect_02");
  KittiCalibration calibration;
  calibration.T_cam0_velo = *rectification * transformIn(file("calib_velo_to_cam.txt"));
  calibration.T_velo_imu = transformIn(file("calib_imu_to_velo.txt"));
  if (!setKittiCamera(*P, calibration))
    throw DataError(cameras + ": P_rect_02 is not K [I | t] of a camera");
  return calibration;
}

std::vector<Stamp> readKittiRawStamps(const std::string& path) {
  std::vector<Stamp> stamps;
  forEachRow(path, kSpaces, [&](const TextRow& row) {
    const auto stamp =
        row.size() == 2 ? stampOfDate(row.text(0) + " " + row.text(1)) : std::nullopt;
    if (!stamp) row.failLine("expected 2011-09-26 13:02:25.951199337");
    stamps.push_back(*stamp);
  });
  return stamps;
}

std::multimap<std::int64_t, KittiTracklet> readKittiTracklets(const std::string& path) {
  const std::string text = readBytes(path);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw DataError(fmt::format("{}:{}: {}", path, document.ErrorLineNum(), document.ErrorName()));
  const Element* const root = document.FirstChildElement("boost_serialization");
  const Element* const list = root == nullptr ? nullptr : root->FirstChildElement("tracklets");
  if (list == nullptr)
    throw DataError(path + ": expected boost_serialization with tracklets: KITTI's tracklets");
  std::multimap<std::int64_t, KittiTracklet> boxes;
  std::int64_t id = 0;
  for (const Element* item = list->FirstChildElement("item"); item != nullptr;
       item = item->NextSiblingElement("item")) {
    KittiTracklet of;
    of.id = id++;
    const char* const type = childOf(path, *item, "objectType").GetText();
    of.type = type == nullptr ? "" : type;
    of.box.height = realIn(path, *item, "h"), of.box.width = realIn(path, *item, "w");
    of.box.length = realIn(path, *item, "l");
    std::int64_t frame = std::llround(realIn(path, *item, "first_frame"));
    const Element& poses = childOf(path, *item, "poses");
    for (const Element* pose = poses.FirstChildElement("item"); pose != nullptr;
         pose = pose->NextSiblingElement("item"))
      boxes.emplace(frame++, trackletAt(path, *pose, of));
  }
  return boxes;
}

KittiRawSeries readKittiRawSeries(const std::string& folder,
                                  const std::vector<std::string>& endings) {
  const std::string times = (fs::path(folder) / "timestamps.txt").string();
  const std::vector<Stamp> all = readKittiRawStamps(times);
  KittiRawSeries found;
  for (const FrameFile& file : frameFiles((fs::path(folder) / "data").string(), endings)) {
    if (file.number >= static_cast<std::int64_t>(all.size()))
      throw DataError(
          fmt::format("{}: {} stamps, expected one for {}", times, all.size(), file.path));
    found.files.push_back(file);
    found.stamps.push_back(all[static_cast<std::size_t>(file.number)]);
  }
  return found;
}

}  // namespace perception
