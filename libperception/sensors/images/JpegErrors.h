#pragma once

namespace perception {

/// No operation; forces the linker to include a jpeg_std_error() by which a damaged JPEG image in a
/// log is an exception instead of the end of the process.
void linkJpegErrors();

}  // namespace perception
