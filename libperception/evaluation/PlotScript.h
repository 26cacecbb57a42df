#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libperception/scene/ClassColors.h"

namespace perception {

/// Colors of libperception/scene/ClassColors.h, as gnuplot takes them.
namespace plot_color {
inline const std::string kGreen = hexOf(okabe_ito::kGreen), kOrange = hexOf(okabe_ito::kOrange),
                         kBlue = hexOf(okabe_ito::kBlue), kVermilion = hexOf(okabe_ito::kVermilion);
inline const std::string kRed = hexOf({192, 0, 0}), kGray = hexOf({187, 187, 187});
/// Of the i-th run in a picture of several.
inline std::string ofRun(std::size_t i) { return hexOf(colorOfCurve(i)); }
}  // namespace plot_color

/// What came of the plots.
struct PlotResult {
  std::vector<std::string> files;  ///< PNG names relative to the folder, "plots/overview.png" ...
  std::string fault;               ///< why there are fewer than there should be; for a warning
};

/// One gnuplot script, plots.gp, with its data files in DIR/plots: pictures are begun one after the
/// other and drawn at the end.
class PlotScript {
 public:
  /// Creates DIR/plots and removes the pictures of an earlier evaluation, which would be taken for
  /// this one's. Throws OutputError.
  explicit PlotScript(const std::string& dir);

  /// Writes a data file beside the script. Throws OutputError.
  void data(const std::string& name, const std::string& text) const;
  /// Starts a picture of this size [px]; nothing of the one before is left.
  void begin(const std::string& file, std::size_t width, std::size_t height);
  void add(const std::string& commands) { script_ += commands; }
  /// Runs gnuplot. Throws OutputError when the script cannot be written.
  PlotResult draw() const;

 private:
  std::string dir_, script_;
  std::vector<std::string> files_;
};

}  // namespace perception
