#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [heading.NAME]: a HeadingHead for boxes without heading.
struct HeadingHeadParams {
  std::string file;
  bool replace = false;  ///< replace the headings of the detector

  void visit(ParamVisitor& v);
};

/// Training example: descriptor and heading of one object.
struct HeadingExample {
  std::vector<float> features;
  double heading = 0;  ///< [rad] KITTI's alpha
  int fold = 0;        ///< of cross-validation; the same for all examples of an image
};

/// Estimates the heading of an object from its box: HOG of 10 x 6 cells, a linear score for each of
/// 16 orientations, the best one refined between its neighbors. Its errors are cross-validated.
class HeadingHead {
 public:
  static constexpr int kBins = 16;

  /// Descriptor of the inside of a box (`closed`: a full panorama, whose columns wrap around);
  /// `mirrored`: of the mirrored image. Empty for an invalid box.
  static std::vector<float> describe(const Raster& image, const ObjectDetection::ImageBox& box,
                                     bool closed, bool mirrored = false);
  /// Ridge regression onto the orientations; confusion, axis error and flips by cross-validation
  /// over the folds. Throws DataError for fewer than 32 examples or fewer than two folds.
  static HeadingHead train(std::string label, const std::vector<HeadingExample>& examples);

  /// Serialization as text. read() throws DataError.
  std::string text() const;
  static HeadingHead read(const std::string& path);

  /// Heading [rad], KITTI's alpha, by a descriptor.
  double heading(const std::vector<float>& features) const;
  /// Sets the heading of every box of its label that has none (of all with `replace`).
  void apply(const Raster& image, bool closed, bool replace,
             std::vector<ObjectDetection>& objects) const;

  const std::string& label() const { return label_; }
  double axisSigma() const { return axis_sigma_; }  ///< [rad] rms error of the axis
  double flipShare() const { return flip_share_; }  ///< share of reversed headings
  int examples() const { return examples_; }
  using Confusion = std::array<std::array<double, kBins>, kBins>;
  const Confusion& confusion() const { return confusion_; }  ///< [true][predicted], rows sum to 1

 private:
  void fit(const std::vector<HeadingExample>& examples, int left_out);
  static int binOf(double heading);

  std::string label_;
  std::vector<float> weights_;  ///< kBins rows of features and a constant
  double axis_sigma_ = 0, flip_share_ = 0;
  int examples_ = 0;
  Confusion confusion_{};
};

}  // namespace perception
