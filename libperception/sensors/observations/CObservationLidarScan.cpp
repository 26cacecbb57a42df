#include "libperception/sensors/observations/CObservationLidarScan.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <ostream>
#include <stdexcept>

#include "libperception/measurement/CArchiveGuards.h"

namespace perception {

IMPLEMENTS_SERIALIZABLE(CObservationLidarScan, CObservation, perception)

namespace {

using mrpt::serialization::CArchive;

/// More than any scanner returns in one turn (128 beams x 3600 azimuths x 3 echoes is 1.4 million).
constexpr std::uint32_t kMostPoints = 1U << 26;

/// Calls visit(bit, array) for each optional array; the bits are part of the file format.
template <class Cloud, class Visit>
void forEachOptional(Cloud& cloud, const Visit& visit) {
  visit(0, cloud.intensity);
  visit(1, cloud.ring);
  visit(2, cloud.time_offset);
  visit(3, cloud.echo);
  visit(4, cloud.pulse_width);
  visit(5, cloud.label);
}
constexpr std::uint8_t kKnownArrays = 0x3f;
constexpr std::array<const char*, 6> kArrayNames = {"intensity", "ring",        "time_offset",
                                                    "echo",      "pulse_width", "label"};

/// Nearest and farthest return and the number of returns with a range.
struct RangeSummary {
  double nearest = 0, farthest = 0;  ///< [m]
  std::size_t valid = 0;
};

RangeSummary summarize(const LidarCloud& cloud) {
  RangeSummary s;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!(range > 0) || !std::isfinite(range)) continue;
    s.nearest = s.valid == 0 ? range : std::min(s.nearest, range);
    s.farthest = std::max(s.farthest, range);
    ++s.valid;
  }
  return s;
}

}  // namespace

uint8_t CObservationLidarScan::serializeGetVersion() const { return 0; }

void CObservationLidarScan::serializeTo(CArchive& out) const {
  const std::size_t n = cloud.size();
  if (n > kMostPoints || cloud.y.size() != n || cloud.z.size() != n) {
    throw std::runtime_error("CObservationLidarScan: x, y and z differ in size or are too many");
  }
  std::uint8_t arrays = 0;
  forEachOptional(cloud, [&](int bit, const auto& values) {
    if (!values.empty() && values.size() != n) {
      throw std::runtime_error(
          "CObservationLidarScan: an optional array does not have one value per point");
    }
    if (!values.empty()) arrays = static_cast<std::uint8_t>(arrays | 1U << bit);
  });
  out << timestamp << sensorLabel << sensor_pose << cloud.max_range;
  out.WriteAs<std::uint32_t>(n);
  out << arrays;
  archive::writeBlock(out, cloud.x);
  archive::writeBlock(out, cloud.y);
  archive::writeBlock(out, cloud.z);
  forEachOptional(cloud, [&](int, const auto& values) { archive::writeBlock(out, values); });
}

void CObservationLidarScan::serializeFrom(CArchive& in, uint8_t version) {
  if (version != 0) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  in >> timestamp;
  sensorLabel = archive::readText(in);
  in >> sensor_pose >> cloud.max_range;
  const std::size_t n = archive::readCount(in, kMostPoints, "points");
  const auto arrays = in.ReadAs<std::uint8_t>();
  if ((arrays & ~kKnownArrays) != 0)
    throw std::runtime_error("CObservationLidarScan: unknown arrays");
  archive::readBlock(in, cloud.x, n);
  archive::readBlock(in, cloud.y, n);
  archive::readBlock(in, cloud.z, n);
  forEachOptional(cloud, [&](int bit, auto& values) {
    archive::readBlock(in, values, arrays >> bit & 1 ? n : 0);
  });
}

void CObservationLidarScan::getDescriptionAsText(std::ostream& out) const {
  CObservation::getDescriptionAsText(out);
  const RangeSummary s = summarize(cloud);
  out << fmt::format(
      "Lidar scan: {} points, {} with a range, {:.2f} to {:.2f} m, instrument's range {:.1f} m\n",
      cloud.size(), s.valid, s.nearest, s.farthest, cloud.max_range);
  out << "Arrays: x y z";
  forEachOptional(cloud, [&](int bit, const auto& values) {
    if (!values.empty()) out << ' ' << kArrayNames[static_cast<std::size_t>(bit)];
  });
  out << "\nSensor pose: " << sensor_pose << '\n';
}

std::string CObservationLidarScan::exportTxtHeader() const {
  return "points points_with_range nearest_m farthest_m instrument_range_m";
}

std::string CObservationLidarScan::exportTxtDataRow() const {
  const RangeSummary s = summarize(cloud);
  return fmt::format("{} {} {:.3f} {:.3f} {:.1f}", cloud.size(), s.valid, s.nearest, s.farthest,
                     cloud.max_range);
}

}  // namespace perception
