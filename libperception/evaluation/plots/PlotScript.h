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
/// Color of the i-th run in a plot of several.
inline std::string ofRun(std::size_t i) { return hexOf(colorOfCurve(i)); }
}  // namespace plot_color

/// Result of a plot run.
struct PlotResult {
  std::vector<std::string> files;  ///< PNG names relative to the folder, "plots/overview.png" ...
  std::string fault;               ///< warning text if plots are missing, else empty
};

/// A gnuplot script, plots.gp, with its data files in DIR/plots. Pictures are added one after the
/// other and drawn at the end.
class PlotScript {
 public:
  /// Creates DIR/plots and removes pictures of an earlier evaluation. Throws OutputError.
  explicit PlotScript(const std::string& dir);

  /// Writes a data file beside the script. Throws OutputError.
  void data(const std::string& name, const std::string& text) const;
  /// Starts a picture of this size [px] with gnuplot's settings reset.
  void begin(const std::string& file, std::size_t width, std::size_t height);
  void add(const std::string& commands) { script_ += commands; }
  /// Runs gnuplot. Throws OutputError when the script cannot be written.
  PlotResult draw() const;

 private:
  std::string dir_, script_;
  std::vector<std::string> files_;
};

}  // namespace perception
