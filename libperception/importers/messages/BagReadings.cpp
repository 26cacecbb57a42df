#include "libperception/importers/messages/BagReadings.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "libperception/importers/messages/MessageFields.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/importers/positions/Ncom.h"
#include "libperception/interop/ros/RosDefinition.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

using ros::RosValue;

namespace {

/// The others of its message are used; a frame's first one that cannot be is said.
std::optional<Pose3> transformIn(const ros::TransformStamped& t, BagContents& contents) {
  try {
    return poseOf(t.transform);
  } catch (const std::runtime_error& e) {
    const std::string child = frameName(t.child_frame_id);
    if (contents.bad_transforms.insert(child).second)
      contents.faults.push_back(
          fmt::format("transforms of \"{}\": left out where they are {}", child, e.what()));
    return {};
  }
}

}  // namespace

void noteTransforms(const BagMessage& m, BagContents& contents) {
  constexpr std::string_view kFixed = "tf_static";
  const std::string& topic = m.topic->name;
  const bool fixed = topic.size() >= kFixed.size() &&
                     topic.compare(topic.size() - kFixed.size(), kFixed.size(), kFixed) == 0;
  for (const auto& t : ros::decoded<ros::TFMessage>(m.bytes, m.topic->encoding).transforms) {
    const std::string parent = frameName(t.header.frame_id), child = frameName(t.child_frame_id);
    const auto given = transformIn(t, contents);
    if (!given) continue;
    const Pose3& pose = *given;
    BagContents::Transforms& to = contents.transforms[child];
    if (fixed || to.fixed || to.parent != parent) to = {parent, fixed, {}, {}};
    to.poses.add(t.header.stamp, pose);
    if (!fixed) to.times.push_back({t.header.stamp, m.stamp});
  }
}

BagObservation observeFix(const BagMessage& m, double shift, ros::Header& header) {
  const auto fix = ros::decoded<ros::NavSatFix>(m.bytes, m.topic->encoding);
  header = fix.header;
  if (fix.status < 0 || !std::isfinite(fix.latitude + fix.longitude)) return nullptr;
  return gpsObservation({header.stamp + shift, fix.latitude, fix.longitude,
                         std::isfinite(fix.altitude) ? fix.altitude : 0});
}

BagObservation observeImu(const BagMessage& m, double shift, ros::Header& header) {
  using namespace mrpt::obs;
  const auto imu = ros::decoded<ros::Imu>(m.bytes, m.topic->encoding);
  header = imu.header;
  auto out = std::make_shared<CObservationIMU>();
  out->timestamp = fromStamp(header.stamp + shift);
  if (imu.rates_covariance[0] >= 0) {
    out->set(IMU_WX, imu.rates[0]);
    out->set(IMU_WY, imu.rates[1]);
    out->set(IMU_WZ, imu.rates[2]);
  }
  if (imu.force_covariance[0] >= 0) {
    out->set(IMU_X_ACC, imu.force[0]);
    out->set(IMU_Y_ACC, imu.force[1]);
    out->set(IMU_Z_ACC, imu.force[2]);
  }
  return out;
}

BagObservation observeFixByFields(const BagMessage& m, double shift, ros::Header& header) {
  const MessageFields fields = fieldsIn(m);
  header = fields.header;
  const RosValue& value = fields.value;
  const std::string status = value.text("solution_status");
  if ((!status.empty() && status != "SOL_COMPUTED") || value.number("sol_status.status") > 0)
    return nullptr;
  const double latitude = firstNumber(value, {"lat", "latitude"});
  const double longitude = firstNumber(value, {"lon", "longitude"});
  const double height = firstNumber(value, {"height", "hgt", "altitude"});
  const double undulation = value.number("undulation");
  const double altitude = height + (std::isfinite(undulation) ? undulation : 0);
  if (!std::isfinite(latitude + longitude + height))
    throw std::runtime_error("no latitude, longitude and height in it");
  const NcomState moving{latitude,
                         longitude,
                         altitude,
                         value.number("north_velocity"),
                         value.number("east_velocity"),
                         -value.number("up_velocity"),
                         value.number("azimuth"),
                         value.number("pitch"),
                         value.number("roll")};
  constexpr double kSolutionGood = 3;
  const bool aligned =
      value.text("status") == "INS_SOLUTION_GOOD" || value.number("status.status") == kSolutionGood;
  if (aligned && std::isfinite(moving.north + moving.east + moving.down + moving.heading +
                               moving.pitch + moving.roll))
    return ncomObservation(header.stamp + shift, moving);
  return gpsObservation({header.stamp + shift, latitude, longitude, altitude});
}

BagObservation observeNcom(const BagMessage& m, double shift, ros::Header& header) {
  const MessageFields fields = fieldsIn(m);
  header = fields.header;
  const auto& items = fields.value.items;
  const auto packet = std::find_if(items.begin(), items.end(), [](const RosValue& item) {
    return item.part == nullptr && !item.bytes.empty();
  });
  if (packet == items.end()) throw std::runtime_error("no packet in it");
  const auto state = ncomState(packet->bytes);
  return state ? ncomObservation(header.stamp + shift, *state) : nullptr;
}

BagObservation observeSpeed(const BagMessage& m, double shift, ros::Header& header) {
  const MessageFields fields = fieldsIn(m);
  header = fields.header;
  const RosValue* const twist = firstOf(fields.value, {"twist.twist", "twist"});
  const double ahead = twist == nullptr ? std::nan("") : twist->number("linear.x");
  const double turn = twist == nullptr ? std::nan("") : twist->number("angular.z");
  if (!std::isfinite(ahead + turn)) throw std::runtime_error("no speed and yaw rate in it");
  auto out = std::make_shared<mrpt::obs::CObservationOdometry>();
  out->timestamp = fromStamp(header.stamp + shift);
  out->hasVelocities = true;
  out->velocityLocal = {ahead, 0, turn};
  return out;
}

}  // namespace perception
