#pragma once
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace CLI {
class App;
}

namespace perception {

/// Conversion of the image of a spinning radar to returns.
struct RadarPictureParams {
  double pixel = 0.17361;  ///< [m] of Navtech_Cartesian (RADIATE's paper)
  int beams = 400;         ///< of one turn (RADIATE's polar pictures)
  double range = 100;      ///< [m] of the radar (RADIATE's paper)
  double nearest = 3;      ///< [m] excludes the vehicle's roof and antenna ringing
  /// Keeps the k strongest echoes of each beam as in CFEAR radar odometry [adolfsson2021] (k = 12,
  /// threshold 60 of 255), here only local maxima.
  int strongest = 12;
  int least_power = 60;  ///< [0, 255]
  /// Non-maximum suppression: one reflector has echoes in neighboring beams and cells.
  int around_beams = 2;  ///< beam width 1.8 deg, twice the step
  int around_cells = 3;  ///< half a meter
};

/// Options --strongest and --least-power.
void declareRadarPicture(CLI::App& cli, RadarPictureParams& params);

/// Returns of a Cartesian radar image with the vehicle in its center, up = forward; no range rates.
/// Throws DataError if the file is not an image.
RadarReturns radarReturnsOf(const std::string& path, const RadarPictureParams& params);

/// The same of a polar picture (one channel): a row a beam, whose bearing is given [rad], a column
/// a cell of `pixel` [m], the first at `first` [m].
RadarReturns radarReturnsOf(const Raster& polar, const std::vector<double>& bearings, double first,
                            const RadarPictureParams& params);

}  // namespace perception
