#pragma once
#include <string>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"

namespace perception {

// JSON schemas of those fields of Foxglove's messages that FoxgloveMessages.h writes; names and
// types as published (https://docs.foxglove.dev/docs/sdk/schemas).
McapWriter::Schema sceneUpdateSchema();
McapWriter::Schema pointCloudSchema();
McapWriter::Schema frameTransformSchema();
McapWriter::Schema compressedImageSchema();
McapWriter::Schema logSchema();
/// Of our own: a time and numbers by name, each of which may be missing.
McapWriter::Schema numbersSchema(const std::string& name, const std::vector<std::string>& fields);

}  // namespace perception
