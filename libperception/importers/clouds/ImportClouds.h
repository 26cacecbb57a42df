#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Format of a cloud file without header.
struct CloudFormat {
  /// Of .bin (float32 each, or `doubles`) and of .csv without a header line: x, y, z, intensity,
  /// ring, time; columns of other names are skipped. Empty: they are found from the data
  /// (CloudLayout).
  std::vector<std::string> columns{"x", "y", "z", "intensity"};
  bool doubles = false;      ///< .bin of float64
  double intensity_max = 0;  ///< intensities are divided by it; 0: they are in [0, 1] already
  double time_scale = 1;     ///< [s] of the unit of the column time
  bool about_stamp = false;  ///< times are about the scan's stamp, not from the first point's on
  double max_range = 0;      ///< [m] of the instrument; 0: unknown
};

/// File extensions supported by readCloudFile(), including gzip variants.
const std::vector<std::string>& cloudEndings();
/// ".bin" of "a/0001.bin.gz".
std::string cloudEndingOf(const std::string& path);

/// For files without names of their columns (.bin always; .csv, .txt, .xyz, .npy and .npz where
/// they have none): `format` with the columns that are found from their data, the first file's and
/// as many more as hold 100 returns together, and the scale of the intensities where none is given;
/// the columns are unchanged if it has some or the files have names. .bin are found to be float32
/// or float64. Throws DataError if the data do not say what they are.
CloudFormat foundFormat(const std::vector<std::string>& paths, const CloudFormat& format);

/// One scan: .bin (float32 columns), .pcd (PCL 0.7: ascii, binary, binary_compressed), .ply (ascii,
/// binary of both byte orders), .csv .txt .xyz (CsvText), .npy and .npz of numpy. Order and number
/// of points are kept, including NaN points. Times become offsets from that of the earliest return.
/// Throws DataError (kNoInput if missing, else with position and expectation).
LidarCloud readCloudFile(const std::string& path, const CloudFormat& format = {});

/// VIEWPOINT of a .pcd file: the pose of the sensor, in whose frame the points are, in a fixed
/// frame; empty where the file has none that is a pose. Throws DataError if it cannot be read.
std::optional<Pose3> viewpointOf(const std::string& path);

/// The cloud's points in another frame, by the pose of their own frame in it.
LidarCloud inFrame(LidarCloud cloud, const Pose3& T_to_from);

}  // namespace perception
