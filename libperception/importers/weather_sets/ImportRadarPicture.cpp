#include "libperception/importers/weather_sets/ImportRadarPicture.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/sensors/images/ImageFile.h"

namespace perception {
namespace {

/// Power by beam and cell (polar image): a row a beam, counter-clockwise from forward.
cv::Mat polarOf(const cv::Mat& picture, const RadarPictureParams& params) {
  const int center_u = picture.cols / 2, center_v = picture.rows / 2;
  const int cells =
      std::min({center_u, center_v, static_cast<int>(params.range / params.pixel)}) - 1;
  cv::Mat polar = cv::Mat::zeros(params.beams, std::max(cells, 1), CV_8UC1);
  for (int beam = 0; beam < params.beams; ++beam) {
    const double bearing = kTwoPi * beam / params.beams;
    const double c = std::cos(bearing), s = std::sin(bearing);
    for (int i = 0; i < cells; ++i) {  // up is forward, left is left
      const int u = center_u - static_cast<int>(std::lround(s * i));
      const int v = center_v - static_cast<int>(std::lround(c * i));
      polar.at<std::uint8_t>(beam, i) = picture.at<std::uint8_t>(v, u);
    }
  }
  return polar;
}

/// A cell of the polar picture.
struct Echo {
  int power, beam, cell;
};

/// Local maxima among eight neighbors.
std::vector<Echo> peaksOf(const cv::Mat& polar, const RadarPictureParams& params) {
  std::vector<Echo> peaks;
  const int nearest = std::max(1, static_cast<int>(std::ceil(params.nearest / params.pixel)));
  for (int beam = 0; beam < polar.rows; ++beam) {
    for (int cell = nearest; cell + 1 < polar.cols; ++cell) {
      const int power = polar.at<std::uint8_t>(beam, cell);
      if (power < params.least_power) continue;
      bool peak = true;
      for (int db = -1; db <= 1 && peak; ++db) {
        const auto* row = polar.ptr<std::uint8_t>((beam + db + polar.rows) % polar.rows);
        peak = power >= std::max({row[cell - 1], row[cell], row[cell + 1]});
      }
      if (peak) peaks.push_back({power, beam, cell});
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Echo& a, const Echo& b) { return a.power > b.power; });
  return peaks;
}

/// Greedy non-maximum suppression, strongest echo first; a saturated wall keeps one echo per
/// window.
class BoundingDisc {
 public:
  BoundingDisc(const cv::Mat& polar, const RadarPictureParams& params)
      : params_(params),
        taken_(cv::Mat::zeros(polar.rows, polar.cols, CV_8UC1)),
        of_beam_(static_cast<std::size_t>(polar.rows)) {}
  bool take(const Echo& echo) {
    int& count = of_beam_[static_cast<std::size_t>(echo.beam)];
    if (taken_.at<std::uint8_t>(echo.beam, echo.cell) != 0 || count >= params_.strongest)
      return false;
    ++count;
    const int first = std::max(0, echo.cell - params_.around_cells);
    const int last = std::min(taken_.cols - 1, echo.cell + params_.around_cells);
    for (int db = -params_.around_beams; db <= params_.around_beams; ++db) {
      auto* row = taken_.ptr<std::uint8_t>((echo.beam + db + taken_.rows) % taken_.rows);
      std::fill(row + first, row + last + 1, std::uint8_t{1});
    }
    return true;
  }

 private:
  const RadarPictureParams& params_;
  cv::Mat taken_;
  std::vector<int> of_beam_;
};

RadarReturns returnsOfPolar(const cv::Mat& polar, const std::vector<double>& bearings, double first,
                            const RadarPictureParams& params) {
  RadarReturns out;
  out.max_range = params.range;
  BoundingDisc surroundings(polar, params);
  for (const Echo& echo : peaksOf(polar, params)) {
    if (!surroundings.take(echo)) continue;
    RadarReturn& r = out.returns.emplace_back();
    r.range = first + echo.cell * params.pixel;
    r.bearing = wrapAngle(bearings[static_cast<std::size_t>(echo.beam)]);
    r.has_rate = false;
    r.amplitude = echo.power;
  }
  return out;
}

}  // namespace

RadarReturns radarReturnsOf(const std::string& path, const RadarPictureParams& params) {
  const cv::Mat picture = readImageFile(path, cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw DataError(path + ": not an image");
  const cv::Mat polar = polarOf(picture, params);
  std::vector<double> bearings;
  for (int beam = 0; beam < polar.rows; ++beam) bearings.push_back(kTwoPi * beam / polar.rows);
  return returnsOfPolar(polar, bearings, 0, params);
}

RadarReturns radarReturnsOf(const Raster& polar, const std::vector<double>& bearings, double first,
                            const RadarPictureParams& params) {
  const cv::Mat picture(polar.height, polar.width, CV_8UC1,
                        const_cast<std::uint8_t*>(polar.pixels.data()));
  return returnsOfPolar(picture, bearings, first, params);
}

void declareRadarPicture(CLI::App& cli, RadarPictureParams& params) {
  cli.add_option("--strongest", params.strongest, "echoes taken of each of the radar's beams")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  cli.add_option("--least-power", params.least_power, "[0, 255] of an echo")
      ->check(CLI::Range(0, 255))
      ->capture_default_str();
}

}  // namespace perception
