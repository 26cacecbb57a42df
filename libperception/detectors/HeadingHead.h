#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// [heading.NAME]: a head that estimates headings of boxes whose detector does not.
struct HeadingHeadParams {
  std::string file;
  bool replace = false;  ///< also where the detector has a heading of its own

  void visit(ParamVisitor& v);
};

/// A picture of one object with its heading, to learn from.
struct HeadingExample {
  std::vector<float> features;
  double heading = 0;  ///< [rad] KITTI's alpha
  int fold = 0;        ///< examples of one image share a fold
};

/// Estimates the heading of an object from its box: HOG of 10 x 6 cells, a linear score for each of
/// 16 orientations, the best one refined between its neighbors. It knows how wrong it is from
/// images that it did not learn from.
class HeadingHead {
 public:
  static constexpr int kBins = 16;

  /// Descriptor of what is inside a box (`closed`: a panorama whose columns go around); `mirrored`
  /// as seen in a mirror. Empty for a box that is none.
  static std::vector<float> describe(const Raster& image, const ObjectDetection::ImageBox& box,
                                     bool closed, bool mirrored = false);
  /// Ridge regression onto the orientations; confusion, axis error and flips by cross-validation
  /// over the folds. Throws DataError for fewer than 32 examples or fewer than two folds.
  static HeadingHead train(std::string label, const std::vector<HeadingExample>& examples);

  /// Text form. read() throws DataError.
  std::string text() const;
  static HeadingHead read(const std::string& path);

  /// [rad] KITTI's alpha.
  double heading(const std::vector<float>& features) const;
  /// Heading of every box of its label that has none (or of all, `replace`).
  void apply(const Raster& image, bool closed, bool replace,
             std::vector<ObjectDetection>& objects) const;

  const std::string& label() const { return label_; }
  double axisSigma() const { return axis_sigma_; }  ///< [rad] rms of the axis, flips turned back
  double flipShare() const { return flip_share_; }  ///< front taken for back
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
