#include "libperception/dds/RosTopics.h"

#include <dds/dds.h>

#include <algorithm>
#include <deque>
#include <utility>
#include <variant>

#include <messages.h>  // of messages.idl
#include "libperception/interop/RosScene.h"
#include "libperception/interop/RosSensors.h"

namespace perception {
namespace {

// ROS 2 puts "rt" before the names of its topics.
constexpr char kTracks[] = "rt/tracks", kTransforms[] = "rt/tf", kStatic[] = "rt/tf_static";

/// Messages as the structures of C that Cyclone DDS writes. Texts and sequences point into the
/// message, or into what is held here.
class CMessages {
 public:
  std_msgs_msg_dds__Header_ of(const ros::Header& header) const {
    constexpr std::int64_t kSecond = 1'000'000'000;
    std_msgs_msg_dds__Header_ m{};
    m.stamp.sec = static_cast<std::int32_t>(header.stamp.ns / kSecond);
    m.stamp.nanosec = static_cast<std::uint32_t>(header.stamp.ns % kSecond);
    m.frame_id = text(header.frame_id);
    return m;
  }

  geometry_msgs_msg_dds__Pose_ of(const ros::Pose& pose) const {
    const auto& q = pose.orientation;
    return {{pose.position[0], pose.position[1], pose.position[2]}, {q.x, q.y, q.z, q.w}};
  }

  vision_msgs_msg_dds__Detection3DArray_ of(const ros::Detection3DArray& array) {
    vision_msgs_msg_dds__Detection3DArray_ m{};
    m.header = of(array.header);
    detections_.clear();
    hypotheses_.clear();
    for (const ros::Detection3D& d : array.detections) detections_.push_back(of(d));
    setSequence(m.detections, detections_);
    return m;
  }

  tf2_msgs_msg_dds__TFMessage_ of(const ros::TFMessage& message) {
    transforms_.clear();
    for (const ros::TransformStamped& t : message.transforms) {
      const auto pose = of(t.transform);
      transforms_.push_back(
          {of(t.header),
           text(t.child_frame_id),
           {{pose.position.x, pose.position.y, pose.position.z}, pose.orientation}});
    }
    tf2_msgs_msg_dds__TFMessage_ m{};
    setSequence(m.transforms, transforms_);
    return m;
  }

  sensor_msgs_msg_dds__PointCloud2_ of(const ros::PointCloud2& cloud) {
    fields_.clear();
    for (const ros::PointField& f : cloud.point_fields)
      fields_.push_back({text(f.name), f.offset, f.datatype, f.count});
    sensor_msgs_msg_dds__PointCloud2_ m{};
    m.header = of(cloud.header);
    m.height = cloud.height, m.width = cloud.width;
    setSequence(m.fields, fields_);
    m.is_bigendian = cloud.is_bigendian != 0;
    m.point_step = cloud.point_step, m.row_step = cloud.row_step;
    m.data._buffer = reinterpret_cast<std::uint8_t*>(const_cast<char*>(cloud.data.data()));
    m.data._length = m.data._maximum = static_cast<std::uint32_t>(cloud.data.size());
    m.is_dense = cloud.is_dense != 0;
    return m;
  }

 private:
  vision_msgs_msg_dds__Detection3D_ of(const ros::Detection3D& d) {
    auto& hypotheses = hypotheses_.emplace_back();
    for (const ros::ObjectHypothesis& h : d.results) {
      auto& m = hypotheses.emplace_back();
      m.hypothesis = {text(h.class_id), h.score};
      m.pose.pose = of(h.pose);
      std::copy(h.covariance.begin(), h.covariance.end(), m.pose.covariance);
    }
    vision_msgs_msg_dds__Detection3D_ m{};
    m.header = of(d.header);
    setSequence(m.results, hypotheses);
    m.bbox = {of(d.center), {d.size[0], d.size[1], d.size[2]}};
    m.id = text(d.id);
    return m;
  }

  static char* text(const std::string& text) { return const_cast<char*>(text.c_str()); }

  template <class Sequence, class Items>
  static void setSequence(Sequence& sequence, Items& items) {
    sequence._buffer = items.data();
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(items.size());
  }

  std::vector<vision_msgs_msg_dds__Detection3D_> detections_;
  std::deque<std::vector<vision_msgs_msg_dds__ObjectHypothesisWithPose_>> hypotheses_;
  std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms_;
  std::vector<sensor_msgs_msg_dds__PointField_> fields_;
};

}  // namespace

RosTopics::RosTopics(const NetworkName& name, std::vector<std::string> class_names)
    : network_(Network::join(name)),
      class_names_(std::move(class_names)),
      tracks_(network_->writer(vision_msgs_msg_dds__Detection3DArray__desc, kTracks)),
      transforms_(network_->writer(tf2_msgs_msg_dds__TFMessage__desc, kTransforms)),
      static_transforms_(network_->writer(tf2_msgs_msg_dds__TFMessage__desc, kStatic,
                                          Network::History::kLatched)) {}

void RosTopics::publish(const Scene& scene) {
  publishTransforms(transforms_, scene.stamp, ros::kWorld,
                    {{ros::kVehicle, scene.ego.T_world_ego}});
  const ros::Detection3DArray array = ros::messageOf(scene, class_names_);
  CMessages messages;
  const auto message = messages.of(array);
  dds_write(tracks_, &message);
}

void RosTopics::publish(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return;
  auto known = clouds_.find(frame.sensor);
  if (known == clouds_.end()) {
    const int writer =
        network_->writer(sensor_msgs_msg_dds__PointCloud2__desc, "rt/" + frame.sensor);
    known = clouds_.emplace(frame.sensor, writer).first;
  }
  const auto [mounted, is_new] = mounted_.try_emplace(frame.sensor, frame.T_ego_sensor);
  if (is_new || !mounted->second.isApprox(frame.T_ego_sensor, 1e-12)) {
    mounted->second = frame.T_ego_sensor;
    publishTransforms(static_transforms_, frame.stamp, ros::kVehicle, mounted_);
  }
  std::string data;
  const ros::PointCloud2 whole =
      ros::messageOf(*cloud, ros::Header{frame.stamp, frame.sensor}, data);
  CMessages messages;
  const auto message = messages.of(whole);
  dds_write(known->second, &message);
}

void RosTopics::publishTransforms(int writer, Stamp stamp, const std::string& parent,
                                  const std::map<std::string, Pose3>& children) {
  ros::TFMessage all;
  for (const auto& [child, T] : children)
    all.transforms.push_back({{stamp, parent}, child, ros::messageOf(T)});
  CMessages messages;
  const auto message = messages.of(all);
  dds_write(writer, &message);
}

}  // namespace perception
