#pragma once
#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosMessages.h"

namespace perception {

// Readings of the vehicle's own place or motion: BagType::observe. All functions throw
// std::runtime_error.

/// sensor_msgs/NavSatFix; null: no fix.
BagObservation observeFix(const BagMessage&, double shift, ros::Header&);
/// sensor_msgs/Imu; absent parts (a covariance that begins with -1) stay absent.
BagObservation observeImu(const BagMessage&, double shift, ros::Header&);
/// Place by latitude, longitude and height, of receivers' own messages (novatel_gps_msgs,
/// novatel_oem7_msgs): lat or latitude, lon or longitude, height or hgt with undulation; of an
/// INSPVA that is aligned also velocity and attitude. Null: no solution.
BagObservation observeFixByFields(const BagMessage&, double shift, ros::Header&);
/// oxts_msgs/Ncom: a packet (Ncom.h) in the message's only list of bytes. Null: not locked.
BagObservation observeNcom(const BagMessage&, double shift, ros::Header&);
/// geometry_msgs/TwistStamped and TwistWithCovarianceStamped, as a reading of wheels.
BagObservation observeSpeed(const BagMessage&, double shift, ros::Header&);

/// Transforms of tf: frames that move, and those that do not. Throws std::runtime_error.
void noteTransforms(const BagMessage&, BagContents&);

}  // namespace perception
