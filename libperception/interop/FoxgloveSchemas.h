#pragma once
#include "libperception/interop/McapWriter.h"

namespace perception {

// JSON schemas of Foxglove's messages, as its package @foxglove/schemas 2.1.0 has them (MIT
// license).
McapWriter::Schema sceneUpdateSchema();
McapWriter::Schema pointCloudSchema();
McapWriter::Schema frameTransformSchema();
McapWriter::Schema compressedImageSchema();

}  // namespace perception
