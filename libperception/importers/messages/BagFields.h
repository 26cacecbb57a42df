#pragma once
#include <vector>

#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

// Messages that are read by the names of their fields (MessageFields.h). All functions throw
// std::runtime_error.

/// What a message of a type that no row names may be, by its definition: a cloud (PointCloud2's
/// fields, or a list of points that have more than x, y and z), an image (Image's or
/// CompressedImage's fields), or a pose (position and orientation); of the message or of a message
/// in it, and with a header first. kOther: none of these.
enum class FieldsKind { kOther, kCloud, kImage, kPose };
FieldsKind kindByFields(const BagTopic& topic);

ros::Header measureCloudByFields(const BagMessage&, const BagTopicParams&, SensorFrame&);
ros::Header measureImageByFields(const BagMessage&, const BagTopicParams&, SensorFrame&);
void notePoseByFields(const BagMessage&, BagContents&);

/// sensor_msgs/PointCloud, of before ROS 1 had PointCloud2.
ros::Header measureOldCloud(const BagMessage&, const BagTopicParams&, SensorFrame&);
/// Lists of a radar's clusters or objects (ars_40X, conti_radar): a return each, by its place and
/// the part of its velocity along the line of sight.
ros::Header measureRadarList(const BagMessage&, const BagTopicParams&, SensorFrame&);
/// autoware_perception_msgs and autoware_auto_perception_msgs: DetectedObjects, TrackedObjects.
ros::Header measureAutoware(const BagMessage&, const BagTopicParams&, SensorFrame&);
/// derived_object_msgs/ObjectArray and ObjectWithCovarianceArray.
ros::Header measureDerivedObjects(const BagMessage&, const BagTopicParams&, SensorFrame&);
/// vision_msgs/Detection2DArray, of all its layouts.
ros::Header measureImageBoxes(const BagMessage&, const BagTopicParams&, SensorFrame&);

/// delphi_esr_msgs/EsrTrack as the frames of the radar's CAN bus; a scan begins with track 1.
ros::Header unpackEsrTrack(const BagMessage&, std::vector<BagPacket>&);

}  // namespace perception
