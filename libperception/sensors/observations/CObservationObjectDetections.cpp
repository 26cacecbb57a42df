#include "libperception/sensors/observations/CObservationObjectDetections.h"

#include <fmt/format.h>

#include <ostream>
#include <stdexcept>
#include <string>

#include "libperception/measurement/CArchiveGuards.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

IMPLEMENTS_SERIALIZABLE(CObservationObjectDetections, CObservation, perception)

namespace {

using mrpt::serialization::CArchive;

constexpr std::uint32_t kMostDetections = 100000;
constexpr std::uint32_t kMostScores = 1000;

void writeDetection(CArchive& out, const ObjectDetection& d) {
  out << d.label << d.score;
  out.WriteAs<std::uint32_t>(d.class_scores.size());
  for (const auto& [name, score] : d.class_scores) out << name << score;
  out << d.image_box.has_value();
  if (d.image_box) out << d.image_box->x1 << d.image_box->y1 << d.image_box->x2 << d.image_box->y2;
  out << d.space_box.has_value();
  if (d.space_box) {
    const auto& b = *d.space_box;
    out << b.bottom_center.x() << b.bottom_center.y() << b.bottom_center.z() << b.yaw << b.length
        << b.width << b.height;
  }
  out << d.heading.has_value();
  if (d.heading) out << *d.heading;
}

ObjectDetection readDetection(CArchive& in) {
  ObjectDetection d;
  d.label = archive::readText(in);
  in >> d.score;
  for (auto left = archive::readCount(in, kMostScores, "class scores"); left > 0; --left) {
    auto& [name, score] = d.class_scores.emplace_back();
    name = archive::readText(in);
    in >> score;
  }
  if (archive::readFlag(in)) {
    auto& b = *(d.image_box = ObjectDetection::ImageBox{});
    in >> b.x1 >> b.y1 >> b.x2 >> b.y2;
  }
  if (archive::readFlag(in)) {
    auto& b = *(d.space_box = ObjectDetection::SpaceBox{});
    in >> b.bottom_center.x() >> b.bottom_center.y() >> b.bottom_center.z() >> b.yaw >> b.length >>
        b.width >> b.height;
  }
  if (archive::readFlag(in)) d.heading = in.ReadAs<double>();
  return d;
}

CameraModel::Projection readProjection(CArchive& in) {
  const auto byte = in.ReadAs<std::uint8_t>();
  if (byte > static_cast<std::uint8_t>(CameraModel::Projection::kEquirectangular))
    throw std::runtime_error("an unknown projection of a camera: " + std::to_string(byte));
  return static_cast<CameraModel::Projection>(byte);
}

}  // namespace

uint8_t CObservationObjectDetections::serializeGetVersion() const {
  // Version 1 adds the projection; pinhole cameras are written as version 0 for older programs.
  return detections.camera.projection == CameraModel::Projection::kPinhole ? 0 : 1;
}

void CObservationObjectDetections::serializeTo(CArchive& out) const {
  const CameraModel& c = detections.camera;
  out << timestamp << sensorLabel << sensor_pose;
  out.WriteAs<std::int32_t>(c.width).WriteAs<std::int32_t>(c.height);
  out << c.fx << c.fy << c.cx << c.cy;
  if (serializeGetVersion() > 0) out.WriteAs<std::uint8_t>(static_cast<std::uint8_t>(c.projection));
  out << detections.T_ego_camera.has_value();
  if (detections.T_ego_camera) out << toMrpt(*detections.T_ego_camera);
  out.WriteAs<std::uint32_t>(detections.objects.size());
  for (const auto& d : detections.objects) writeDetection(out, d);
}

void CObservationObjectDetections::serializeFrom(CArchive& in, uint8_t version) {
  if (version > 1) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  CameraModel& c = detections.camera;
  in >> timestamp;
  sensorLabel = archive::readText(in);
  in >> sensor_pose;
  c.width = in.ReadAs<std::int32_t>();
  c.height = in.ReadAs<std::int32_t>();
  in >> c.fx >> c.fy >> c.cx >> c.cy;
  c.projection = version > 0 ? readProjection(in) : CameraModel::Projection::kPinhole;
  detections.T_ego_camera.reset();
  if (archive::readFlag(in)) {
    mrpt::poses::CPose3D pose;
    in >> pose;
    detections.T_ego_camera = toPose3(pose);
  }
  detections.objects.clear();
  for (auto left = archive::readCount(in, kMostDetections, "detections"); left > 0; --left) {
    detections.objects.push_back(readDetection(in));
  }
}

void CObservationObjectDetections::getDescriptionAsText(std::ostream& out) const {
  CObservation::getDescriptionAsText(out);
  const CameraModel& c = detections.camera;
  out << fmt::format(
      "Detections: {}\nCamera: {} x {} px, fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}, {}\n",
      detections.objects.size(), c.width, c.height, c.fx, c.fy, c.cx, c.cy,
      c.projection == CameraModel::Projection::kPinhole ? "pinhole" : "equirectangular");
  out << "Sensor pose: " << sensor_pose << '\n';
  for (const auto& d : detections.objects) {
    out << fmt::format("  {} score {:.4f}", d.label, d.score);
    if (d.image_box) {
      out << fmt::format("  image ({:.1f}, {:.1f}) ({:.1f}, {:.1f}) px", d.image_box->x1,
                         d.image_box->y1, d.image_box->x2, d.image_box->y2);
    }
    if (d.space_box) {
      const auto& b = *d.space_box;
      out << fmt::format(
          "  box at ({:.2f}, {:.2f}, {:.2f}) m yaw {:.1f} deg, {:.2f} x {:.2f} x {:.2f} m",
          b.bottom_center.x(), b.bottom_center.y(), b.bottom_center.z(), degrees(b.yaw), b.length,
          b.width, b.height);
    }
    if (d.heading) out << fmt::format("  alpha {:.1f} deg", degrees(*d.heading));
    out << '\n';
  }
}

std::string CObservationObjectDetections::exportTxtHeader() const {
  return "count [label score x1 y1 x2 y2 x y z yaw length width height alpha]*  (nan: not given)";
}

std::string CObservationObjectDetections::exportTxtDataRow() const {
  std::string row = fmt::format("{}", detections.objects.size());
  for (const auto& d : detections.objects) {
    row += fmt::format(" {} {:.4f}", d.label.empty() ? "-" : d.label, d.score);
    if (d.image_box) {
      row += fmt::format(" {:.2f} {:.2f} {:.2f} {:.2f}", d.image_box->x1, d.image_box->y1,
                         d.image_box->x2, d.image_box->y2);
    } else {
      row += " nan nan nan nan";
    }
    if (d.space_box) {
      const auto& b = *d.space_box;
      row +=
          fmt::format(" {:.3f} {:.3f} {:.3f} {:.4f} {:.3f} {:.3f} {:.3f}", b.bottom_center.x(),
                      b.bottom_center.y(), b.bottom_center.z(), b.yaw, b.length, b.width, b.height);
    } else {
      row += " nan nan nan nan nan nan nan";
    }
    row += d.heading ? fmt::format(" {:.4f}", *d.heading) : " nan";
  }
  return row;
}

}  // namespace perception
