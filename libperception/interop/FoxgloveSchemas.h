#pragma once
#include "libperception/interop/McapWriter.h"

namespace perception {

// JSON schemas of those fields of Foxglove's messages that FoxgloveMessages.h writes; names and
// types as published (https://docs.foxglove.dev/docs/sdk/schemas).
McapWriter::Schema sceneUpdateSchema();
McapWriter::Schema pointCloudSchema();
McapWriter::Schema frameTransformSchema();
McapWriter::Schema compressedImageSchema();

}  // namespace perception
