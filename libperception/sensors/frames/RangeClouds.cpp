#include "libperception/sensors/frames/RangeClouds.h"

#include <mrpt/obs/VelodyneCalibration.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

#include "libperception/core/math/Angle.h"

namespace perception {

namespace {

void addPoint(LidarCloud& cloud, double x, double y, double z) {
  cloud.x.push_back(static_cast<float>(x));
  cloud.y.push_back(static_cast<float>(y));
  cloud.z.push_back(static_cast<float>(z));
}

/// PointLabel by the name in the observation.
PointLabel labelNamed(const std::string& name) {
  static constexpr std::array<const char*, 5> kNames = {"unknown", "object", "rain", "ground",
                                                        "dirt"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<PointLabel>(i);
  }
  return PointLabel::kUnknown;
}

PointLabel labelAt(const mrpt::obs::TPixelLabelInfoBase& labels, int row, int column) {
  for (const auto& [index, name] : labels.pixelLabelNames) {
    if (labels.checkLabel(row, column, static_cast<std::uint8_t>(index))) return labelNamed(name);
  }
  return PointLabel::kUnknown;
}

LidarCloud unproject(const mrpt::obs::CObservation3DRangeScan& scan, std::uint64_t& no_range) {
  LidarCloud cloud;
  const auto& ranges = scan.rangeImage;
  const auto& camera = scan.cameraParams;
  const bool labeled = scan.hasPixelLabels();
  const bool lit = scan.hasIntensityImage && !scan.intensityImage.isExternallyStored() &&
                   scan.intensityImage.getChannelCount() == 1 &&
                   static_cast<int>(scan.intensityImage.getHeight()) == ranges.rows() &&
                   static_cast<int>(scan.intensityImage.getWidth()) == ranges.cols();
  for (int r = 0; r < ranges.rows(); ++r) {
    for (int c = 0; c < ranges.cols(); ++c) {
      if (ranges(r, c) == 0) {
        ++no_range;
        continue;
      }
      const double left = (camera.cx() - c) / camera.fx(), up = (camera.cy() - r) / camera.fy();
      const double range = ranges(r, c) * static_cast<double>(scan.rangeUnits);
      const double depth =
          scan.range_is_depth ? range : range / std::sqrt(1 + left * left + up * up);
      addPoint(cloud, depth, left * depth, up * depth);
      if (lit) {
        cloud.intensity.push_back(scan.intensityImage.at<std::uint8_t>(static_cast<unsigned>(c),
                                                                       static_cast<unsigned>(r)));
      }
      if (labeled)
        cloud.label.push_back(static_cast<std::uint8_t>(labelAt(*scan.pixelLabels, r, c)));
    }
  }
  return cloud;
}

/// MRPT 2.5.8 allocates sixteen times too many columns for Velodyne packets; the span of azimuths
/// is that of the filled ones.
int columnsInUse(const mrpt::obs::CObservationRotatingScan& scan) {
  constexpr int kTooMany = 16;
  const auto& ranges = scan.rangeImage;
  int used = ranges.cols();
  const auto empty = [&](int column) {
    for (int row = 0; row < ranges.rows(); ++row) {
      if (ranges(row, column) != 0) return false;
    }
    return true;
  };
  while (used > 1 && empty(used - 1)) --used;
  return used <= ranges.cols() / kTooMany ? ranges.cols() / kTooMany : ranges.cols();
}

/// Elevations [rad] of the rows of a range image; empty for unknown models.
std::vector<double> elevationsOf(const mrpt::obs::CObservationRotatingScan& scan) {
  if (scan.rowCount == 1) return {0};
  std::string model;
  for (const char c : scan.lidarModel) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      model += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  const char* known = model.rfind("VLP16", 0) == 0   ? "VLP16"
                      : model.rfind("HDL32", 0) == 0 ? "HDL32"
                                                     : nullptr;
  if (known == nullptr) return {};
  try {
    const auto& lasers =
        mrpt::obs::VelodyneCalibration::LoadDefaultCalibration(known).laser_corrections;
    std::vector<double> elevations;
    for (const auto& laser : lasers) elevations.push_back(radians(laser.verticalCorrection));
    return elevations;
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace

LidarCloud planarCloud(const mrpt::obs::CObservation2DRangeScan& scan, std::uint64_t& no_range) {
  LidarCloud cloud;
  cloud.max_range = static_cast<double>(scan.maxRange);
  const std::size_t count = scan.getScanSize();
  const double step = count > 1 ? 1 / static_cast<double>(count - 1) : 0;
  const double side = scan.rightToLeft ? 1 : -1;
  for (std::size_t i = 0; i < count; ++i) {
    if (!scan.getScanRangeValidity(i)) continue;
    const double range = static_cast<double>(scan.getScanRange(i));
    if (range <= 0) {
      ++no_range;
      continue;
    }
    const double share = static_cast<double>(i) * step;
    const double bearing = side * static_cast<double>(scan.aperture) * (share - 0.5);
    // A tilting scanner starts at its pose and ends deltaPitch lower.
    const double pitch = scan.deltaPitch * share, ahead = range * std::cos(bearing);
    addPoint(cloud, ahead * std::cos(pitch), range * std::sin(bearing), -ahead * std::sin(pitch));
    if (scan.hasIntensity())
      cloud.intensity.push_back(static_cast<float>(scan.getScanIntensity(i)));
  }
  return cloud;
}

std::optional<LidarCloud> rangeImageCloud(const mrpt::obs::CObservation3DRangeScan& scan,
                                          std::uint64_t& no_range) {
  try {
    scan.load();
  } catch (const std::exception&) {  // an external file is missing
    return {};
  }
  LidarCloud cloud;
  if (scan.hasRangeImage && scan.rangeImage.size() > 0) {
    if (!(scan.cameraParams.fx() > 0) || !(scan.cameraParams.fy() > 0)) return {};
    cloud = unproject(scan, no_range);
  } else if (scan.hasPoints3D) {
    if (scan.points3D_y.size() != scan.points3D_x.size() ||
        scan.points3D_z.size() != scan.points3D_x.size())
      return {};
    cloud.x = scan.points3D_x, cloud.y = scan.points3D_y, cloud.z = scan.points3D_z;
  } else {
    return {};
  }
  cloud.max_range = static_cast<double>(scan.maxRange);
  return cloud;
}

std::optional<LidarCloud> rotatingCloud(const mrpt::obs::CObservationRotatingScan& scan,
                                        std::uint64_t& no_range) {
  const auto elevations = elevationsOf(scan);
  const auto& ranges = scan.rangeImage;
  const bool lit = scan.intensityImage.size() > 0;
  if (elevations.size() != scan.rowCount || ranges.rows() != scan.rowCount ||
      ranges.cols() != scan.columnCount ||
      (lit && (scan.intensityImage.rows() != ranges.rows() ||
               scan.intensityImage.cols() != ranges.cols())))
    return {};
  std::vector<std::size_t> order(elevations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return elevations[a] < elevations[b]; });
  LidarCloud cloud;
  cloud.max_range = scan.maxRange;
  const double columns = std::max(1, columnsInUse(scan) - 1);
  const double turn = scan.rowCount == 1 ? 1 : -1;  // fromVelodyne() keeps the clockwise azimuth
  for (std::size_t ring = 0; ring < order.size(); ++ring) {
    const int row = static_cast<int>(order[ring]);
    const double up = std::sin(elevations[order[ring]]), flat = std::cos(elevations[order[ring]]);
    for (int column = 0; column < ranges.cols(); ++column) {
      const double range = ranges(row, column) * scan.rangeResolution;
      if (ranges(row, column) == 0) continue;  // no echo
      if (range < scan.minRange) {
        ++no_range;
        continue;
      }
      const double share = column / columns;
      const double azimuth = turn * (scan.startAzimuth + scan.azimuthSpan * share);
      addPoint(cloud, range * flat * std::cos(azimuth), range * flat * std::sin(azimuth),
               range * up);
      if (lit) cloud.intensity.push_back(scan.intensityImage(row, column));
      cloud.ring.push_back(static_cast<std::uint16_t>(ring));
      cloud.time_offset.push_back(static_cast<float>(scan.sweepDuration * share));
    }
  }
  return cloud;
}

}  // namespace perception
