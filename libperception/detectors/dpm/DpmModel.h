#pragma once
#include <string>
#include <vector>

namespace perception {

/// A linear template over cells of 32 HOG features (voc-release4 order: 18 contrast sensitive, 9
/// insensitive, 4 texture, 1 outside the image).
struct DpmFilter {
  int height = 0, width = 0;   ///< [cells]
  std::vector<float> weights;  ///< height x width x 32, row by row
};

/// A part: a filter at twice the root's resolution with a cost of displacement from its anchor.
struct DpmPart {
  DpmFilter filter;
  int anchor_x = 0, anchor_y = 0;  ///< [cells of the finer level] from the root's corner
  /// Cost d[0] dx^2 + d[1] dx + d[2] dy^2 + d[3] dy; dx, dy = anchor - position [cells]
  double deformation[4] = {0, 0, 0, 0};
};

/// One view of the object.
struct DpmComponent {
  double heading = 0;  ///< [rad] KITTI's alpha
  double offset = 0;   ///< added to the score
  /// Offset by the root's pyramid level: enlarged, down to half scale, smaller (voc-release5's
  /// location features).
  double octaves[3] = {0, 0, 0};
  int height = 0, width = 0;  ///< [cells] of the detection window
  DpmFilter root;
  std::vector<DpmPart> parts;
};

/// A mixture of deformable part models [felzenszwalb2010], star shaped, of one class.
struct DpmModel {
  std::string class_name;
  int cell = 8;              ///< [px] side of a cell (sbin)
  double threshold = 0;      ///< default threshold of its authors
  bool has_heading = false;  ///< each component has a heading
  std::vector<DpmComponent> components;
};

/// Reads the plain-text export of a bank (gzip or not), or a model of voc-release4 or 5 (.mat).
/// Throws DataError with file and line.
DpmModel readDpmModel(const std::string& path);
DpmModel parseDpmModel(const std::string& text, const std::string& name);

}  // namespace perception
