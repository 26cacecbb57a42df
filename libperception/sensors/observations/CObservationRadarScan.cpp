#include "libperception/sensors/observations/CObservationRadarScan.h"

#include <fmt/format.h>

#include <ostream>

#include "libperception/measurement/CArchiveGuards.h"

namespace perception {

IMPLEMENTS_SERIALIZABLE(CObservationRadarScan, CObservation, perception)

namespace {

using mrpt::serialization::CArchive;

constexpr std::uint32_t kMostReturns = 1000000;

}  // namespace

uint8_t CObservationRadarScan::serializeGetVersion() const { return 0; }

void CObservationRadarScan::serializeTo(CArchive& out) const {
  out << timestamp << sensorLabel << sensor_pose << scan.max_range;
  out.WriteAs<std::uint32_t>(scan.returns.size());
  for (const RadarReturn& r : scan.returns) {
    out << r.range << r.bearing << r.range_rate << r.has_rate << r.amplitude
        << r.elevation.has_value();
    if (r.elevation) out << *r.elevation;
    out.WriteAs<std::int32_t>(r.id);
  }
}

void CObservationRadarScan::serializeFrom(CArchive& in, uint8_t version) {
  if (version != 0) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  in >> timestamp;
  sensorLabel = archive::readText(in);
  in >> sensor_pose >> scan.max_range;
  scan.returns.clear();
  for (auto left = archive::readCount(in, kMostReturns, "radar returns"); left > 0; --left) {
    RadarReturn r;
    in >> r.range >> r.bearing >> r.range_rate;
    r.has_rate = archive::readFlag(in);
    in >> r.amplitude;
    if (archive::readFlag(in)) r.elevation = in.ReadAs<double>();
    r.id = in.ReadAs<std::int32_t>();
    scan.returns.push_back(r);
  }
}

void CObservationRadarScan::getDescriptionAsText(std::ostream& out) const {
  CObservation::getDescriptionAsText(out);
  out << fmt::format("Radar returns: {}, range of the instrument: {:.1f} m\n", scan.returns.size(),
                     scan.max_range);
  out << "Sensor pose: " << sensor_pose << '\n';
  for (const RadarReturn& r : scan.returns) {
    out << fmt::format("  {:.2f} m, {:.1f} deg", r.range, degrees(r.bearing));
    if (r.has_rate) out << fmt::format(", {:.2f} m/s", r.range_rate);
    out << fmt::format(", amplitude {:.1f} dB", r.amplitude);
    if (r.elevation) out << fmt::format(", elevation {:.1f} deg", degrees(*r.elevation));
    if (r.id >= 0) out << fmt::format(", target {}", r.id);
    out << '\n';
  }
}

std::string CObservationRadarScan::exportTxtHeader() const {
  return "count [range bearing range_rate amplitude elevation id]*  (nan: not given)";
}

std::string CObservationRadarScan::exportTxtDataRow() const {
  std::string row = fmt::format("{}", scan.returns.size());
  for (const RadarReturn& r : scan.returns) {
    row += fmt::format(" {:.3f} {:.5f} ", r.range, r.bearing);
    row += r.has_rate ? fmt::format("{:.3f}", r.range_rate) : "nan";
    row += fmt::format(" {:.2f} ", r.amplitude);
    row += r.elevation ? fmt::format("{:.5f}", *r.elevation) : "nan";
    row += fmt::format(" {}", r.id);
  }
  return row;
}

}  // namespace perception
