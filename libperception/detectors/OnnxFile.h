#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// What an ONNX file says of its input, read without a library for it: which exports cv::dnn can
/// run is decided by this.
struct OnnxFile {
  std::vector<std::int64_t> input;  ///< dimensions; -1: left open ("dynamic")
  std::int64_t opset = 0;
};
/// Throws DataError: missing, or not an ONNX file.
OnnxFile readOnnxFile(const std::string& path);

}  // namespace perception
