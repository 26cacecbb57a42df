#include "libperception/importers/weather_sets/BoreasFiles.h"

#include <fmt/format.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/sensors/images/ImageFile.h"

namespace perception {
namespace {

/// The numbers of a file of rows of four.
std::vector<std::vector<double>> rowsOfFour(const std::string& path) {
  std::vector<std::vector<double>> rows;
  forEachRow(path, kSpaces, [&](const TextRow& row) {
    row.expect(row.size() == 4, "4");
    auto& numbers = rows.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) numbers.push_back(row.real(i));
  });
  if (rows.size() < 3)
    throw DataError(fmt::format("{}: {} rows, expected 3 or 4 of 4 numbers", path, rows.size()));
  return rows;
}

}  // namespace

Stamp stampOfBoreas(const FrameFile& file) {
  std::int64_t us = 0;
  const char* const end = file.stem.data() + file.stem.size();
  constexpr std::int64_t kLast = 9'000'000'000'000'000;  // the year 2255
  const auto read = std::from_chars(file.stem.data(), end, us);
  if (read.ec != std::errc() || read.ptr != end || us <= 0 || us > kLast)
    throw DataError(file.path + ": expected a name of microseconds since 1970");
  return {us * 1000};
}

std::vector<StampedPose> readBoreasPoses(const std::string& path) {
  std::vector<StampedPose> poses;
  bool names = true;
  forEachRow(path, kCommas, [&](const TextRow& row) {
    if (names && !row.isNumber(0)) return;
    names = false;
    row.expect(row.size() >= 10, "10 or more: t x y z vx vy vz r p y");
    const double us = row.real(0);
    if (us < 1e12 || us > 9e15) row.fail(0, "microseconds since 1970");
    StampedPose& pose = poses.emplace_back();
    pose.stamp = {static_cast<std::int64_t>(us) * 1000};
    pose.pose.linear() = (Eigen::AngleAxisd(-row.real(7), Vector3::UnitX()) *
                          Eigen::AngleAxisd(-row.real(8), Vector3::UnitY()) *
                          Eigen::AngleAxisd(-row.real(9), Vector3::UnitZ()))
                             .toRotationMatrix();
    pose.pose.translation() = Vector3(row.real(1), row.real(2), row.real(3));
    if (poses.size() > 1 && pose.stamp <= poses[poses.size() - 2].stamp)
      row.failLine("not after the line before");
  });
  if (poses.empty()) throw DataError(path + ": no pose in it");
  return poses;
}

Pose3 readBoreasTransform(const std::string& path) {
  const auto rows = rowsOfFour(path);
  Pose3 pose = Pose3::Identity();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k)
      pose.matrix()(i, k) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  const Eigen::Matrix3d R = pose.linear();
  if (!(R * R.transpose()).isIdentity(1e-2) || R.determinant() < 0)
    throw DataError(path + ": the 3x3 part is no rotation");
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return pose;
}

CameraModel readBoreasCamera(const std::string& path) {
  const auto rows = rowsOfFour(path);
  CameraModel camera;
  camera.fx = rows[0][0], camera.fy = rows[1][1];
  camera.cx = rows[0][2], camera.cy = rows[1][2];
  if (!(camera.fx > 0) || !(camera.fy > 0)) throw DataError(path + ": no focal length");
  return camera;
}

BoreasRadar readBoreasRadar(const std::string& path) {
  constexpr std::size_t kEncoder = 8, kHead = 11;
  constexpr double kPerHalfTurn = 2800;
  const cv::Mat picture = readImageFile(path, cv::IMREAD_GRAYSCALE);
  if (picture.empty() || static_cast<std::size_t>(picture.cols) <= kHead)
    throw DataError(path +
                    ": expected an image whose rows begin with 11 bytes of time and encoder");
  BoreasRadar radar;
  radar.power.channels = 1;
  radar.power.height = picture.rows;
  radar.power.width = picture.cols - static_cast<int>(kHead);
  for (int row = 0; row < picture.rows; ++row) {
    const auto* const bytes = picture.ptr<std::uint8_t>(row);
    const std::string_view head(reinterpret_cast<const char*>(bytes), kHead);
    radar.azimuths.push_back(static_cast<double>(littleEndian(head, kEncoder, 2)) * kPi /
                             kPerHalfTurn);
    radar.power.pixels.insert(radar.power.pixels.end(), bytes + kHead, bytes + picture.cols);
  }
  return radar;
}

}  // namespace perception
