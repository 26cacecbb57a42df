#include "libperception/importers/messages/BagFields.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "libperception/importers/messages/MessageFields.h"
#include "libperception/interop/ros/RosDefinition.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception {
namespace {

using ros::MessageField;
using ros::MessagePart;
using ros::PointCloud2;
using ros::PointField;
using ros::RosValue;

bool hasAll(const MessagePart& part, std::initializer_list<const char*> names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const char* name) { return part.find(name) != nullptr; });
}

/// The path of the first message, itself or within it but in no list, that `is` holds of.
std::optional<std::string> pathOf(const MessagePart& part,
                                  const std::function<bool(const MessagePart&)>& is) {
  if (is(part)) return "";
  for (const MessageField& field : part.fields) {
    if (field.part == nullptr || field.list != MessageField::List::kOne) continue;
    if (const auto below = pathOf(*field.part, is))
      return below->empty() ? field.name : field.name + "." + *below;
  }
  return {};
}

bool isCloudPart(const MessagePart& part) {
  return hasAll(part, {"width", "height", "fields", "point_step", "row_step", "data"});
}
bool isRawImagePart(const MessagePart& part) {
  return hasAll(part, {"width", "height", "encoding", "step", "data"});
}
bool isImagePart(const MessagePart& part) {
  return isRawImagePart(part) || hasAll(part, {"format", "data"});
}
bool isPosePart(const MessagePart& part) {
  const auto has = [&](const char* name, std::initializer_list<const char*> numbers) {
    const MessageField* const field = part.find(name);
    return field != nullptr && field->part != nullptr && hasAll(*field->part, numbers);
  };
  return has("position", {"x", "y", "z"}) && has("orientation", {"x", "y", "z", "w"});
}

/// What a point of a scanner has beside its place.
constexpr std::array<const char*, 12> kBesidePlaces = {
    "intensity",   "reflectivity", "ring",        "channel", "line",  "t",
    "offset_time", "time",         "time_offset", "doppler", "speed", "velocity"};

const MessageField* pointsIn(const MessagePart& part) {
  for (const MessageField& field : part.fields) {
    if (field.part == nullptr || field.list == MessageField::List::kOne) continue;
    const MessagePart& point = *field.part;
    const bool more = std::any_of(kBesidePlaces.begin(), kBesidePlaces.end(), [&](const char* n) {
      const MessageField* const beside = point.find(n);
      return beside != nullptr && beside->isNumber();
    });
    const bool place = hasAll(point, {"x", "y", "z"}) && point.find("x")->isNumber();
    if (place && more) return &field;
  }
  return nullptr;
}

PointCloud2 cloudIn(const RosValue& value, const ros::Header& header) {
  PointCloud2 cloud;
  cloud.header = header;
  cloud.width = wholeAt<std::uint32_t>(value, "width");
  cloud.height = wholeAt<std::uint32_t>(value, "height");
  cloud.point_step = wholeAt<std::uint32_t>(value, "point_step");
  cloud.row_step = wholeAt<std::uint32_t>(value, "row_step");
  cloud.data = bytesAt(value, "data");
  cloud.is_bigendian = value.number("is_bigendian") > 0 ? 1 : 0;
  for (const RosValue& field : value.find("fields")->items) {
    const double count = field.number("count");
    cloud.point_fields.push_back({field.text("name"), wholeAt<std::uint32_t>(field, "offset"),
                                  wholeAt<std::uint8_t>(field, "datatype"),
                                  count >= 1 ? static_cast<std::uint32_t>(count) : 1});
  }
  return cloud;
}

/// Columns of points: those that are bytes stay bytes, for these have a largest intensity.
class PointColumns {
 public:
  PointColumns(std::size_t points, const ros::Header& header) {
    cloud_.header = header;
    cloud_.width = static_cast<std::uint32_t>(points);
  }
  void add(const std::string& name, bool byte, std::function<double(std::size_t)> value) {
    cloud_.point_fields.push_back(
        {name, cloud_.point_step, byte ? PointField::kU8 : PointField::kF64, 1});
    cloud_.point_step += static_cast<std::uint32_t>(byte ? 1 : sizeof(double));
    values_.push_back(std::move(value));
  }
  /// Valid as long as this.
  const PointCloud2& cloud() {
    for (std::size_t i = 0; i < cloud_.width; ++i) {
      for (std::size_t c = 0; c < values_.size(); ++c) {
        const double value = values_[c](i);
        if (cloud_.point_fields[c].datatype == PointField::kU8)
          data_ += static_cast<char>(static_cast<std::uint8_t>(value));
        else
          data_.append(reinterpret_cast<const char*>(&value), sizeof(value));
      }
    }
    cloud_.row_step = cloud_.width * cloud_.point_step;
    cloud_.data = data_;
    return cloud_;
  }

 private:
  PointCloud2 cloud_;
  std::string data_;
  std::vector<std::function<double(std::size_t)>> values_;
};

/// The numbers of each point of a list.
void addColumns(const RosValue& list, const MessagePart& point, PointColumns& columns) {
  for (std::size_t f = 0; f < point.fields.size(); ++f) {
    const MessageField& field = point.fields[f];
    if (!field.isNumber()) continue;
    columns.add(field.name, field.kind == MessageField::Kind::kU8,
                [&list, f](std::size_t i) { return list.items[i].items[f].numbers[0]; });
  }
}

}  // namespace

FieldsKind kindByFields(const BagTopic& topic) {
  if (topic.definition.empty() || !topic.unknown_encoding.empty()) return FieldsKind::kOther;
  try {
    const auto definition = definitionOf(topic);
    const MessagePart& message = definition->message();
    const MessagePart* const first = message.fields.empty() ? nullptr : message.fields.front().part;
    if (first == nullptr || first->name != "std_msgs/Header") return FieldsKind::kOther;
    if (pathOf(message, &isCloudPart) || pointsIn(message) != nullptr) return FieldsKind::kCloud;
    if (pathOf(message, &isImagePart)) return FieldsKind::kImage;
    return pathOf(message, &isPosePart) ? FieldsKind::kPose : FieldsKind::kOther;
  } catch (const std::runtime_error&) {  // it is listed with the text of its definition
    return FieldsKind::kOther;
  }
}

ros::Header measureCloudByFields(const BagMessage& m, const BagTopicParams& params,
                                 SensorFrame& frame) {
  const MessageFields fields = fieldsIn(m);
  const MessagePart& message = fields.definition->message();
  if (const auto path = pathOf(message, &isCloudPart)) {
    setCloud(cloudIn(*fields.value.find(*path), fields.header), params, frame);
    return fields.header;
  }
  const MessageField* const field = pointsIn(message);
  if (field == nullptr) throw std::runtime_error("no points in it");
  const RosValue& list = *fields.value.find(field->name);
  PointColumns columns(list.items.size(), fields.header);
  addColumns(list, *field->part, columns);
  setCloud(columns.cloud(), params, frame);
  return fields.header;
}

ros::Header measureOldCloud(const BagMessage& m, const BagTopicParams& params, SensorFrame& frame) {
  const MessageFields fields = fieldsIn(m);
  const RosValue* const list = fields.value.find("points");
  const RosValue* const channels = fields.value.find("channels");
  const MessageField* const field = fields.definition->message().find("points");
  if (list == nullptr || channels == nullptr || field->part == nullptr)
    throw std::runtime_error("no points in it");
  PointColumns columns(list->items.size(), fields.header);
  addColumns(*list, *field->part, columns);
  for (const RosValue& channel : channels->items) {
    const RosValue* const values = channel.find("values");
    if (values == nullptr || values->numbers.size() != list->items.size())
      throw std::runtime_error("a channel without a value for each point");
    columns.add(channel.text("name"), false,
                [values](std::size_t i) { return values->numbers[i]; });
  }
  setCloud(columns.cloud(), params, frame);
  return fields.header;
}

ros::Header measureImageByFields(const BagMessage& m, const BagTopicParams&, SensorFrame& frame) {
  const MessageFields fields = fieldsIn(m);
  const auto path = pathOf(fields.definition->message(), &isImagePart);
  if (!path) throw std::runtime_error("no image in it");
  const RosValue& given = *fields.value.find(*path);
  Raster raster;
  if (isRawImagePart(*given.part)) {
    ros::Image image;
    image.width = wholeAt<std::uint32_t>(given, "width");
    image.height = wholeAt<std::uint32_t>(given, "height");
    image.encoding = given.text("encoding");
    image.step = wholeAt<std::uint32_t>(given, "step");
    image.data = bytesAt(given, "data");
    raster = ros::rasterOf(image);
  } else {
    ros::CompressedImage image;
    image.format = given.text("format");
    image.data = bytesAt(given, "data");
    raster = ros::rasterOf(image);
  }
  setImage(std::move(raster), frame);
  return fields.header;
}

void notePoseByFields(const BagMessage& m, BagContents& contents) {
  const MessageFields fields = fieldsIn(m);
  const auto path = pathOf(fields.definition->message(), &isPosePart);
  if (!path) throw std::runtime_error("no pose in it");
  // What it is the pose of is not known.
  contents.poses[m.topic->name].on_call = true;
  addPoseOf(m, contents, fields.header, poseAt(*fields.value.find(*path)),
            fields.value.text("child_frame_id"));
}

}  // namespace perception
