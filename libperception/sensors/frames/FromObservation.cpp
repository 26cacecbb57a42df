#include "libperception/sensors/frames/FromObservation.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "libperception/sensors/frames/RangeClouds.h"
#include "libperception/sensors/frames/VelodyneCloud.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/CObservationRadarScan.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

using mrpt::obs::CObservation;
using Data = decltype(SensorFrame::data);

/// Scales the intensities of an MRPT cloud to [0, 1]. They are given in [0, 1] or as integers of
/// one or two bytes; the largest value of the cloud decides.
void scaleIntensity(std::vector<float>& intensity) {
  const auto fine = [](float value) { return value >= 0 && value <= 1; };
  if (std::all_of(intensity.begin(), intensity.end(), fine)) return;
  float highest = 0;
  for (float& value : intensity) {
    if (!std::isfinite(value) || value < 0) value = 0;
    highest = std::max(highest, value);
  }
  const float scale = highest > 255 ? 1.F / 65535 : highest > 1 ? 1.F / 255 : 1.F;
  for (float& value : intensity) value = std::min(1.F, value * scale);
}

bool arraysAgree(const LidarCloud& c) {
  const auto fits = [n = c.size()](const auto& values) {
    return values.empty() || values.size() == n;
  };
  return c.y.size() == c.size() && c.z.size() == c.size() && fits(c.intensity) && fits(c.ring) &&
         fits(c.time_offset) && fits(c.echo) && fits(c.pulse_width) && fits(c.label);
}

Data cleaned(LidarCloud cloud, DecodeCounts& counts) {
  scaleIntensity(cloud.intensity);
  dropBadPoints(cloud, counts);
  return cloud;
}

std::optional<Data> decode(const CObservationLidarScan& scan, DecodeCounts& counts) {
  if (!arraysAgree(scan.cloud)) {
    ++counts.rejected;
    return {};
  }
  return cleaned(scan.cloud, counts);
}

std::optional<Data> decode(const mrpt::obs::CObservationPointCloud& observation,
                           DecodeCounts& counts) {
  if (!observation.pointcloud) {
    ++counts.rejected;
    return {};
  }
  const mrpt::maps::CPointsMap& points = *observation.pointcloud;
  const auto& x = points.getPointsBufferRef_x();
  const auto& y = points.getPointsBufferRef_y();
  const auto& z = points.getPointsBufferRef_z();
  LidarCloud cloud;
  cloud.x.assign(x.begin(), x.end());
  cloud.y.assign(y.begin(), y.end());
  cloud.z.assign(z.begin(), z.end());
  if (const auto* with_intensity = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(&points)) {
    cloud.intensity.resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud.intensity[i] = with_intensity->getPointIntensity_fast(i);
  }
  return cleaned(std::move(cloud), counts);
}

std::optional<Data> decode(const mrpt::obs::CObservationVelodyneScan& scan, DecodeCounts& counts) {
  VelodyneCounts velodyne;
  auto cloud = velodyneCloud(scan, &velodyne);
  counts.no_range += velodyne.too_near;
  if (!cloud) {
    ++counts.rejected;
    return {};
  }
  dropBadPoints(*cloud, counts);  // intensities are in [0, 1] already
  return std::move(*cloud);
}

std::optional<Data> decode(const mrpt::obs::CObservation2DRangeScan& scan, DecodeCounts& counts) {
  return cleaned(planarCloud(scan, counts.no_range), counts);
}

std::optional<Data> decode(const mrpt::obs::CObservation3DRangeScan& scan, DecodeCounts& counts) {
  auto cloud = rangeImageCloud(scan, counts.no_range);
  if (cloud) return cleaned(std::move(*cloud), counts);
  ++counts.rejected;
  return {};
}

std::optional<Data> decode(const mrpt::obs::CObservationRotatingScan& scan, DecodeCounts& counts) {
  auto cloud = rotatingCloud(scan, counts.no_range);
  if (cloud) return cleaned(std::move(*cloud), counts);
  ++counts.rejected;
  return {};
}

bool usable(const ObjectDetection& d) {
  if (!std::isfinite(d.score)) return false;
  if (d.image_box) {
    const auto& b = *d.image_box;
    if (!std::isfinite(b.x1 + b.y1 + b.x2 + b.y2) || !(b.x2 > b.x1) || !(b.y2 > b.y1)) return false;
  }
  if (d.space_box) {
    const auto& b = *d.space_box;
    if (!b.bottom_center.allFinite() || !std::isfinite(b.yaw + b.length + b.width + b.height))
      return false;
    if (!(b.length > 0) || !(b.width > 0) || !(b.height > 0)) return false;
  }
  return !d.heading || std::isfinite(*d.heading);
}

std::optional<Data> decode(const CObservationObjectDetections& observation, DecodeCounts& counts) {
  ObjectDetections detections = observation.detections;
  auto& objects = detections.objects;
  const auto bad =
      std::remove_if(objects.begin(), objects.end(), [](const auto& d) { return !usable(d); });
  counts.bad_boxes += static_cast<std::uint64_t>(objects.end() - bad);
  objects.erase(bad, objects.end());
  return detections;
}

bool usable(const RadarReturn& r) {
  return std::isfinite(r.range + r.bearing + r.amplitude) && r.range > 0 &&
         (!r.has_rate || std::isfinite(r.range_rate)) &&
         (!r.elevation || std::isfinite(*r.elevation));
}

std::optional<Data> decode(const CObservationRadarScan& observation, DecodeCounts& counts) {
  RadarReturns scan = observation.scan;
  auto& returns = scan.returns;
  const auto bad =
      std::remove_if(returns.begin(), returns.end(), [](const auto& r) { return !usable(r); });
  counts.bad_returns += static_cast<std::uint64_t>(returns.end() - bad);
  returns.erase(bad, returns.end());
  return scan;
}

std::optional<Data> decodeImage(const mrpt::obs::CObservationImage& observation,
                                DecodeCounts& counts, const std::string& images) {
  CameraImage image = cameraImage(observation, images);
  std::error_code fault;
  const bool missing = observation.image.isExternallyStored()
                           ? !std::filesystem::is_regular_file(image.source, fault)
                           : observation.image.isEmpty();
  counts.missing_images += missing ? 1 : 0;
  return image;
}

/// Decoder of one observation class; a new class needs its decode function and a row.
struct Decoder {
  bool (*knows)(const CObservation&);
  std::optional<Data> (*decode)(const CObservation&, DecodeCounts&, const std::string& images);
};

template <class Class>
constexpr Decoder decoderOf() {
  return {[](const CObservation& o) { return dynamic_cast<const Class*>(&o) != nullptr; },
          [](const CObservation& o, DecodeCounts& counts, const std::string& images) {
            if constexpr (std::is_same_v<Class, mrpt::obs::CObservationImage>) {
              return decodeImage(dynamic_cast<const Class&>(o), counts, images);
            } else {
              static_cast<void>(images);
              return perception::decode(dynamic_cast<const Class&>(o), counts);
            }
          }};
}

constexpr Decoder kDecoders[] = {
    decoderOf<CObservationLidarScan>(),
    decoderOf<mrpt::obs::CObservationPointCloud>(),
    decoderOf<CObservationObjectDetections>(),
    decoderOf<CObservationRadarScan>(),
    decoderOf<mrpt::obs::CObservationImage>(),
    decoderOf<mrpt::obs::CObservationVelodyneScan>(),
    decoderOf<mrpt::obs::CObservation2DRangeScan>(),
    decoderOf<mrpt::obs::CObservation3DRangeScan>(),
    decoderOf<mrpt::obs::CObservationRotatingScan>(),
};

const Decoder* decoderFor(const CObservation& observation) {
  for (const Decoder& decoder : kDecoders) {
    if (decoder.knows(observation)) return &decoder;
  }
  return nullptr;
}

}  // namespace

bool isSensorData(const CObservation& observation) { return decoderFor(observation) != nullptr; }

bool isImage(const CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr;
}

std::optional<SensorFrame> frameFromObservation(const CObservation& observation,
                                                DecodeCounts* counts, const std::string& images) {
  DecodeCounts local;
  DecodeCounts& c = counts != nullptr ? *counts : local;
  const Decoder* decoder = decoderFor(observation);
  if (decoder == nullptr) return {};
  const auto stamp = toStamp(observation.timestamp);
  if (!stamp) {
    ++c.rejected_stamps;
    return {};
  }
  auto data = decoder->decode(observation, c, images);
  if (!data) return {};
  SensorFrame frame;
  frame.sensor = observation.sensorLabel;
  frame.stamp = *stamp;
  mrpt::poses::CPose3D pose;
  observation.getSensorPose(pose);
  frame.T_ego_sensor = toPose3(pose);
  frame.data = std::move(*data);
  return frame;
}

std::optional<SensorFrame> frameFromObservation(CObservation&& observation, DecodeCounts& counts) {
  LidarCloud cloud;
  auto* scan = dynamic_cast<CObservationLidarScan*>(&observation);
  if (scan != nullptr && arraysAgree(scan->cloud)) std::swap(cloud, scan->cloud);
  auto frame = frameFromObservation(std::as_const(observation), &counts);
  if (frame && scan != nullptr) frame->data = cleaned(std::move(cloud), counts);
  return frame;
}

std::optional<std::int64_t> frameNumber(const CObservation& observation) {
  const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation);
  constexpr std::string_view kWord = "frame ";
  if (comment == nullptr || comment->text.compare(0, kWord.size(), kWord) != 0) return {};
  std::int64_t number = 0;
  const char* end = comment->text.data() + comment->text.size();
  const auto result = std::from_chars(comment->text.data() + kWord.size(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return {};
  return number;
}

}  // namespace perception
