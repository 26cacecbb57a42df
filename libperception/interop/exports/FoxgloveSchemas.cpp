#include "libperception/interop/exports/FoxgloveSchemas.h"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

namespace perception {
namespace {

using nlohmann::json;
using Fields = std::initializer_list<std::pair<const char*, json>>;

json number() { return {{"type", "number"}}; }
json text() { return {{"type", "string"}}; }
json flag() { return {{"type", "boolean"}}; }
json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
json integer() { return {{"type", "integer"}}; }
json arrayOf(json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

/// All fields of a message are required.
json object(const char* title, const Fields& fields) {
  json out = {{"title", title},
              {"type", "object"},
              {"properties", json::object()},
              {"required", json::array()}};
  for (const auto& [name, schema] : fields) {
    out["properties"][name] = schema;
    out["required"].push_back(name);
  }
  return out;
}

/// Seconds and nanoseconds: a "time" since 1970, or a "duration".
json secondsOf(const char* title) {
  return object(title, {{"sec", integer()}, {"nsec", integer()}});
}
json time() { return secondsOf("time"); }

json vector() {
  return object("foxglove.Vector3", {{"x", number()}, {"y", number()}, {"z", number()}});
}
json quaternion() {
  return object("foxglove.Quaternion",
                {{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
json pose() {
  return object("foxglove.Pose", {{"position", vector()}, {"orientation", quaternion()}});
}
json color() {
  return object("foxglove.Color",
                {{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}

json entity() {
  const json other = {{"type", "object"}};  // primitives that no message here has
  return object(
      "foxglove.SceneEntity",
      {{"timestamp", time()},
       {"frame_id", text()},
       {"id", text()},
       {"lifetime", secondsOf("duration")},
       {"frame_locked", flag()},
       {"metadata", arrayOf(object("foxglove.KeyValuePair", {{"key", text()}, {"value", text()}}))},
       {"arrows", arrayOf(other)},
       {"cubes", arrayOf(object("foxglove.CubePrimitive",
                                {{"pose", pose()}, {"size", vector()}, {"color", color()}}))},
       {"spheres", arrayOf(other)},
       {"cylinders", arrayOf(other)},
       {"lines", arrayOf(other)},
       {"triangles", arrayOf(other)},
       {"texts", arrayOf(object("foxglove.TextPrimitive", {{"pose", pose()},
                                                           {"billboard", flag()},
                                                           {"font_size", number()},
                                                           {"scale_invariant", flag()},
                                                           {"color", color()},
                                                           {"text", text()}}))},
       {"models", arrayOf(other)}});
}

McapWriter::Schema named(const char* name, const Fields& fields) {
  return {name, "jsonschema", object(name, fields).dump()};
}

}  // namespace

McapWriter::Schema sceneUpdateSchema() {
  const json deletion = object("foxglove.SceneEntityDeletion",
                               {{"timestamp", time()}, {"type", integer()}, {"id", text()}});
  return named("foxglove.SceneUpdate",
               {{"deletions", arrayOf(deletion)}, {"entities", arrayOf(entity())}});
}

McapWriter::Schema pointCloudSchema() {
  const json field = object("foxglove.PackedElementField",
                            {{"name", text()}, {"offset", integer()}, {"type", integer()}});
  return named("foxglove.PointCloud", {{"timestamp", time()},
                                       {"frame_id", text()},
                                       {"pose", pose()},
                                       {"point_stride", integer()},
                                       {"fields", arrayOf(field)},
                                       {"data", bytes()}});
}

McapWriter::Schema frameTransformSchema() {
  return named("foxglove.FrameTransform", {{"timestamp", time()},
                                           {"parent_frame_id", text()},
                                           {"child_frame_id", text()},
                                           {"translation", vector()},
                                           {"rotation", quaternion()}});
}

McapWriter::Schema compressedImageSchema() {
  return named(
      "foxglove.CompressedImage",
      {{"timestamp", time()}, {"frame_id", text()}, {"data", bytes()}, {"format", text()}});
}

McapWriter::Schema logSchema() {
  return named("foxglove.Log", {{"timestamp", time()},
                                {"level", integer()},
                                {"message", text()},
                                {"name", text()},
                                {"file", text()},
                                {"line", integer()}});
}

McapWriter::Schema numbersSchema(const std::string& name, const std::vector<std::string>& fields) {
  json schema = object(name.c_str(), {{"timestamp", time()}});
  for (const std::string& field : fields) schema["properties"][field] = number();
  return {name, "jsonschema", schema.dump()};
}

}  // namespace perception
