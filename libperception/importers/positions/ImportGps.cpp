#include "libperception/importers/positions/ImportGps.h"

#include <mrpt/obs/CObservationGPS.h>

#include <cmath>
#include <optional>

#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/satellites/PositionTrack.h"

namespace perception {

namespace {

constexpr std::int64_t kDayNs = 86400LL * 1'000'000'000;
/// [s] Longest time over which a course is computed.
constexpr double kCourseTime = 5;

}  // namespace

std::shared_ptr<mrpt::obs::CObservation> gpsObservation(const GpsFix& fix,
                                                        const std::string& label) {
  mrpt::obs::gnss::Message_NMEA_GGA gga;
  const std::int64_t of_day = fix.stamp.ns % kDayNs;
  const std::int64_t seconds = of_day / 1'000'000'000;
  gga.fields.UTCTime.hour = static_cast<std::uint8_t>(seconds / 3600);
  gga.fields.UTCTime.minute = static_cast<std::uint8_t>(seconds / 60 % 60);
  gga.fields.UTCTime.sec =
      static_cast<double>(seconds % 60) + static_cast<double>(of_day % 1'000'000'000) * 1e-9;
  gga.fields.latitude_degrees = fix.latitude;
  gga.fields.longitude_degrees = fix.longitude;
  gga.fields.altitude_meters = fix.altitude;
  gga.fields.fix_quality = 1;
  auto out = std::make_shared<mrpt::obs::CObservationGPS>();
  out->timestamp = fromStamp(fix.stamp);
  out->originalReceivedTimestamp = out->timestamp;
  out->has_satellite_timestamp = true;
  out->sensorLabel = label;
  out->setMsg(gga);
  return out;
}

std::vector<Vector2> localPositions(const std::vector<GpsFix>& fixes) {
  PositionTrack track;
  for (const GpsFix& fix : fixes)
    track.fixes.push_back({fix.stamp.seconds(), fix.latitude, fix.longitude});
  return track.local();
}

std::vector<StampedPose> posesOfFixes(const std::vector<GpsFix>& fixes, double course_distance) {
  const std::vector<Vector2> places = localPositions(fixes);
  std::vector<StampedPose> poses(fixes.size());
  std::optional<double> course, first;
  std::vector<std::optional<double>> courses(fixes.size());
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    std::size_t a = i, b = i;  // extends on both sides until the distance suffices for a course
    const auto near = [&](std::size_t k) {
      return std::abs(fixes[k].stamp - fixes[i].stamp) <= kCourseTime;
    };
    while ((places[b] - places[a]).norm() < course_distance) {
      const bool back = a > 0 && near(a - 1), on = b + 1 < fixes.size() && near(b + 1);
      if (!back && !on) break;
      if (back) --a;
      if (on) ++b;
    }
    const Vector2 way = places[b] - places[a];
    if (way.norm() >= course_distance) course = std::atan2(way.y(), way.x());
    courses[i] = course;
    if (course && !first) first = course;
  }
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    poses[i].stamp = fixes[i].stamp;
    poses[i].pose =
        makePose(places[i].x(), places[i].y(), 0, courses[i] ? *courses[i] : first.value_or(0));
  }
  return poses;
}

}  // namespace perception
