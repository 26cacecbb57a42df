// A drive as data sets lay it out: each writer fills a folder of its own with the same scans, poses
// and boxes.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libperception/importers/truth/LabeledBoxes.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

inline constexpr double kDriveLidarHeight = 1.73;           // [m] of KITTI's vehicle
inline constexpr std::int64_t kDriveBegin = 1'611'678'137;  // [s]
inline constexpr double kEarthRadius = 6378137;             // [m] along the equator, WGS84

/// What a lidar at kDriveLidarHeight above the ego origin saw ten times a second, and where from.
struct LayoutDrive {
  struct Box {
    DataSetBox of_lidar;  ///< in the lidar's frame
    TruthObject object;   ///< in the world's frame
  };
  struct Scan {
    LidarCloud cloud;
    Pose3 T_world_ego = Pose3::Identity();
    std::vector<Box> boxes;
  };
  std::vector<Scan> scans;

  static Pose3 mount() { return makePose(0, 0, kDriveLidarHeight, 0); }
  static Stamp stamp(std::size_t k) {
    return Stamp{kDriveBegin * 1'000'000'000 + static_cast<std::int64_t>(k) * 100'000'000};
  }
  /// "2021-01-26 16:22:17.100000000"
  static std::string textStamp(std::size_t k) {
    return fmt::format("2021-01-26 16:{:02}:{:02}.{}00000000", 22 + k / 400, 17 + k / 10, k % 10);
  }
};

/// Keeps a file: its name below the folder, its bytes.
using KeepFile = std::function<void(const std::string&, const std::string&)>;

inline std::string scanBytes(const LidarCloud& cloud, float intensity_scale,
                             const std::vector<float>& more) {
  std::string bytes;
  const auto add = [&](float v) { bytes.append(reinterpret_cast<const char*>(&v), sizeof(v)); };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    add(cloud.x[i]), add(cloud.y[i]), add(cloud.z[i]), add(intensity_scale * cloud.intensity[i]);
    for (const float v : more) add(v);
  }
  return bytes;
}

inline std::string poseMembers(const Pose3& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Vector3 t = pose.translation();
  return fmt::format(R"("translation": [{}, {}, {}], "rotation": [{}, {}, {}, {}])", t.x(), t.y(),
                     t.z(), q.w(), q.x(), q.y(), q.z());
}

/// Tables of nuScenes in which every scan is one of a key frame. Two sweeps of its own lidar lie
/// .05 s apart; here they lie .1 s apart.
inline void layOutNuscenes(const LayoutDrive& drive, const KeepFile& keep) {
  const Pose3 T_global_world = makePose(1010, 612, 0, 1);
  std::map<std::string, std::string> rows;
  const auto add = [&](const char* table, const std::string& row) {
    std::string& all = rows[table];
    all += (all.empty() ? "[{" : ",\n{") + row + "}";
  };
  std::map<std::string, bool> instances;
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    const std::int64_t us = LayoutDrive::stamp(k).ns / 1000;
    const std::string file = fmt::format("samples/LIDAR_TOP/n-{}.pcd.bin", us);
    keep(file, scanBytes(scan.cloud, 255, {0}));
    add("sample", fmt::format(R"("token": "k{}", "timestamp": {}, "scene_token": "s")", k, us));
    add("sample_data",
        fmt::format(R"("token": "d{0}", "sample_token": "k{0}", "ego_pose_token": "p{0}", )"
                    R"("calibrated_sensor_token": "c", "timestamp": {1}, "is_key_frame": true, )"
                    R"("filename": "{2}")",
                    k, us, file));
    add("ego_pose", fmt::format(R"("token": "p{}", "timestamp": {}, {})", k, us,
                                poseMembers(T_global_world * scan.T_world_ego)));
    for (const LayoutDrive::Box& box : scan.boxes) {
      const TruthObject& o = box.object;
      const Pose3 center =
          makePose(o.position.x(), o.position.y(), o.position.z() + o.height / 2, o.yaw);
      const std::string category = o.type == "Car"          ? "car"
                                   : o.type == "Pedestrian" ? "walker"
                                                            : "cycle";
      if (!std::exchange(instances[box.of_lidar.id], true))
        add("instance",
            fmt::format(R"("token": "{}", "category_token": "{}")", box.of_lidar.id, category));
      add("sample_annotation",
          fmt::format(R"("sample_token": "k{}", "instance_token": "{}", "size": [{}, {}, {}], )"
                      R"("attribute_tokens": [{}], "num_lidar_pts": {}, "num_radar_pts": 0, {})",
                      k, box.of_lidar.id, o.width, o.length, o.height,
                      category == "cycle" ? "\"ridden\"" : "", o.lidar_points,
                      poseMembers(T_global_world * center)));
    }
  }
  add("scene", fmt::format(R"("token": "s", "name": "scene-0001", "description": "simulated", )"
                           R"("nbr_samples": {})",
                           drive.scans.size()));
  add("sensor", R"("token": "l", "channel": "LIDAR_TOP", "modality": "lidar")");
  add("calibrated_sensor", R"("token": "c", "sensor_token": "l", "camera_intrinsic": [], )" +
                               poseMembers(LayoutDrive::mount()));
  add("category", R"("token": "car", "name": "vehicle.car")");
  add("category", R"("token": "walker", "name": "human.pedestrian.adult")");
  add("category", R"("token": "cycle", "name": "vehicle.bicycle")");
  add("attribute", R"("token": "ridden", "name": "cycle.with_rider")");
  for (const auto& [table, text] : rows) keep("v1.0-mini/" + table + ".json", text + "]");
}

/// A drive of KITTI's raw data along the equator; the GPS/IMU is where the lidar is.
inline void layOutKittiRaw(const LayoutDrive& drive, const KeepFile& keep) {
  keep("calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -0.27\n");
  keep("calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  keep("calib_cam_to_cam.txt",
       "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 721.5 0 609.6 44.86 0 721.5 172.9 0.2 0 0 1 0\n");
  std::string stamps, items;
  struct Tracklet {
    std::size_t first = 0, count = 0;
    std::string head, poses;
  };
  std::map<std::string, Tracklet> open;
  const auto close = [&](const Tracklet& t) {
    if (t.count == 0) return;
    items += fmt::format(
        "<item>{}<first_frame>{}</first_frame><poses><count>{}</count><item_version>2"
        "</item_version>{}</poses><finished>1</finished></item>\n",
        t.head, t.first, t.count, t.poses);
  };
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    const Pose3 lidar = scan.T_world_ego * LayoutDrive::mount();
    const Vector3 at = lidar.translation();
    stamps += LayoutDrive::textStamp(k) + "\n";
    keep(fmt::format("drive/velodyne_points/data/{:010}.bin", k), scanBytes(scan.cloud, 1, {}));
    std::string oxts = fmt::format("{:.14f} {:.14f} {} 0 0 {}", degrees(at.y() / kEarthRadius),
                                   degrees(at.x() / kEarthRadius), at.z(), yawOf(lidar));
    for (int i = 6; i < 30; ++i) oxts += " 0";
    keep(fmt::format("drive/oxts/data/{:010}.txt", k), oxts + "\n");
    for (const LayoutDrive::Box& labeled : scan.boxes) {
      const auto& box = labeled.of_lidar.box;
      Tracklet& t = open[labeled.of_lidar.id];
      if (t.first + t.count != k) close(std::exchange(t, {}));
      if (t.count++ == 0) t.first = k;
      t.head = fmt::format("<objectType>{}</objectType><h>{}</h><w>{}</w><l>{}</l>",
                           labeled.of_lidar.type, box.height, box.width, box.length);
      t.poses += fmt::format(
          "<item><tx>{}</tx><ty>{}</ty><tz>{}</tz><rx>0</rx><ry>0</ry><rz>{}</rz><state>2</state>"
          "<occlusion>0</occlusion><occlusion_kf>0</occlusion_kf><truncation>0</truncation></item>",
          box.bottom_center.x(), box.bottom_center.y(), box.bottom_center.z(), box.yaw);
    }
  }
  for (const auto& [id, tracklet] : open) close(tracklet);
  keep("drive/velodyne_points/timestamps.txt", stamps);
  keep("drive/oxts/timestamps.txt", stamps);
  keep("drive/tracklet_labels.xml",
       "<?xml version=\"1.0\"?>\n<boost_serialization><tracklets class_id=\"0\"><count>1</count>"
       "<item_version>1</item_version>" +
           items + "</tracklets></boost_serialization>\n");
}

/// A sequence of SemanticKITTI. Labels of objects are those of the returns in their boxes.
inline void layOutSemanticKitti(const LayoutDrive& drive, const KeepFile& keep) {
  keep("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  Pose3 T_cam_lidar = Pose3::Identity();
  T_cam_lidar.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::string poses, times;
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    keep(fmt::format("velodyne/{:06}.bin", k), scanBytes(scan.cloud, 1, {}));
    const Pose3 lidar = LayoutDrive::mount().inverse() * scan.T_world_ego * LayoutDrive::mount();
    const Pose3 camera = T_cam_lidar * lidar * T_cam_lidar.inverse();
    for (int i = 0; i < 12; ++i)
      poses += fmt::format("{}{}", camera(i / 4, i % 4), i < 11 ? " " : "\n");
    times += fmt::format("{:e}\n", 0.1 * static_cast<double>(k));
    std::string labels;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      std::uint32_t label = 40;  // road
      for (const LayoutDrive::Box& box : scan.boxes) {
        LidarCloud one;
        one.x = {scan.cloud.x[i]}, one.y = {scan.cloud.y[i]}, one.z = {scan.cloud.z[i]};
        const std::string& type = box.of_lidar.type;
        if (returnsInside(box.of_lidar.box, one) > 0)
          label = (type == "Car"          ? 10U
                   : type == "Pedestrian" ? 30U
                                          : 31U) |
                  static_cast<std::uint32_t>(box.object.id) << 16;
      }
      labels.append(reinterpret_cast<const char*>(&label), sizeof(label));
    }
    keep(fmt::format("labels/{:06}.label", k), labels);
  }
  keep("poses.txt", poses), keep("times.txt", times);
}

/// A sequence of CADC along the equator; the GPS/IMU is where the lidar is.
inline void layOutCadc(const LayoutDrive& drive, const KeepFile& keep) {
  constexpr double kPolar = kEarthRadius * (1 - 0.00669437999014);  // [m] of WGS84
  std::string stamps, frames;
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    const Pose3 lidar = scan.T_world_ego * LayoutDrive::mount();
    const Vector3 at = lidar.translation();
    stamps += LayoutDrive::textStamp(k) + "\n";
    keep(fmt::format("0001/labeled/lidar_points/data/{:010}.bin", k),
         scanBytes(scan.cloud, 255, {}));
    keep(fmt::format("0001/labeled/novatel/data/{:010}.txt", k),
         fmt::format("{:.14f} {:.14f} {} -36 0.01 0.01 0.02 0 0 {} 0 0 0\n",
                     degrees(at.y() / kPolar), degrees(at.x() / kEarthRadius), at.z(),
                     90 - degrees(yawOf(lidar))));
    std::string cuboids;
    for (const LayoutDrive::Box& labeled : scan.boxes) {
      const auto& box = labeled.of_lidar.box;
      const Vector3 at_lidar = box.bottom_center + Vector3(0, 0, box.height / 2);
      cuboids += fmt::format(R"({}{{"uuid":"{}","label":"{}","position":{{"x":{},"y":{},"z":{}}},)"
                             R"("dimensions":{{"x":{},"y":{},"z":{}}},"yaw":{}}})",
                             cuboids.empty() ? "" : ",", labeled.of_lidar.id, labeled.of_lidar.type,
                             at_lidar.x(), at_lidar.y(), at_lidar.z(), box.width, box.length,
                             box.height, box.yaw);
    }
    frames += fmt::format(R"({}{{"cuboids":[{}]}})", k > 0 ? "," : "", cuboids);
  }
  keep("0001/labeled/lidar_points/timestamps.txt", stamps);
  keep("0001/labeled/novatel/timestamps.txt", stamps);
  keep("0001/3d_ann.json", "[" + frames + "]");
  keep("calib/extrinsics.yaml",
       "T_LIDAR_GPSIMU:\n- [1.0, 0.0, 0.0, 0.0]\n- [0.0, 1.0, 0.0, 0.0]\n- [0.0, 0.0, 1.0, 0.0]\n"
       "- [0.0, 0.0, 0.0, 1.0]\n");
}

/// A drive of Boreas whose lidar looks ahead.
inline void layOutBoreas(const LayoutDrive& drive, const KeepFile& keep) {
  std::string poses =
      "GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,"
      "heading,angvel_z,angvel_y,angvel_x\n";
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    const std::int64_t us = LayoutDrive::stamp(k).ns / 1000;
    const Pose3 lidar = scan.T_world_ego * LayoutDrive::mount();
    const Vector3 at = lidar.translation();
    keep(fmt::format("lidar/{}.bin", us), scanBytes(scan.cloud, 255, {0, 0}));
    poses += fmt::format("{},{},{},{},0,0,0,0,0,{},0,0,0\n", us, at.x() + 620, at.y() + 4850,
                         at.z(), -yawOf(lidar));
    std::string boxes;
    for (const LayoutDrive::Box& labeled : scan.boxes) {
      const auto& box = labeled.of_lidar.box;
      boxes +=
          fmt::format("{} {} {} {} {} {} {} {} {} 9\n", labeled.of_lidar.id, labeled.of_lidar.type,
                      box.length, box.width, box.height, box.bottom_center.x(),
                      box.bottom_center.y(), box.bottom_center.z() + box.height / 2, box.yaw);
    }
    keep(fmt::format("labels_tracking/{}.txt", us), boxes);
  }
  keep("applanix/lidar_poses.csv", poses);
}

/// A scene of SemanticSpray++; every return is background.
inline void layOutSpray(const LayoutDrive& drive, const KeepFile& keep) {
  std::string poses;
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const LayoutDrive::Scan& scan = drive.scans[k];
    keep(fmt::format("velodyne/{:06}.bin", k), scanBytes(scan.cloud, 255, {0}));
    keep(fmt::format("labels/{:06}.label", k), std::string(4 * scan.cloud.size(), '\0'));
    const Pose3 lidar = LayoutDrive::mount().inverse() * scan.T_world_ego * LayoutDrive::mount();
    for (int i = 0; i < 12; ++i)
      poses += fmt::format("{}{}", lidar(i / 4, i % 4), i < 11 ? " " : "\n");
    std::string boxes;
    for (const LayoutDrive::Box& labeled : scan.boxes) {
      const auto& box = labeled.of_lidar.box;
      boxes += fmt::format(
          R"({}{{"id":"{}","class":"{}","contour":{{"center3D":{{"x":{},"y":{},"z":{}}},)"
          R"("size3D":{{"x":{},"y":{},"z":{}}},"rotation3D":{{"x":0,"y":0,"z":{}}}}}}})",
          boxes.empty() ? "" : ",", labeled.of_lidar.id, labeled.of_lidar.type,
          box.bottom_center.x(), box.bottom_center.y(), box.bottom_center.z() + box.height / 2,
          box.length, box.width, box.height, degrees(box.yaw));
    }
    keep(fmt::format("object_labels/lidar/{:06}.json", k), R"([{"instances":[)" + boxes + "]}]");
  }
  keep("poses.txt", poses);
}

}  // namespace perception::test
