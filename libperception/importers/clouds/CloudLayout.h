#pragma once
#include <optional>
#include <string>
#include <vector>

namespace perception {

/// What the columns of a cloud are that comes without their names.
struct CloudLayout {
  std::vector<std::string> columns;  ///< x, y, z, intensity, ring, time; "-": skipped
  double intensity_max = 1;          ///< intensities are divided by it
};

/// Columns beyond which nothing is looked for.
inline constexpr std::size_t kMostCloudColumns = 12;

/// How many columns rows of numbers have that were written one after the other: the least number
/// for which the place in the row says most of the size of a number (mutual information), for
/// coordinates, intensities and rings differ in size, and rows that are cut wrongly mix them.
/// Empty: there are too few numbers (100 rows of four), or no number of columns says anything.
std::optional<std::size_t> columnCountOf(const std::vector<float>& numbers);

/// Whether bytes are float64, and not float32: half of the words of float64 make numbers of any
/// size as float32, while float64 show columns with coordinates.
bool looksLikeDoubles(const std::string& bytes);

/// What the columns hold, by their values: x, y and z are the first three beside each other that
/// can be coordinates [m]; a ring is a small whole number in which the elevations of the returns
/// are alike; times rise by whole periods through 10 ms to 0.6 s, in a file whose returns are in
/// the order in which a scanner sees them (an intensity that was sorted, or counts up, is none);
/// the first other column that is nowhere negative, nor the same everywhere, is the intensity.
/// `values`: [column][row]. Empty: there are no three coordinates.
std::optional<CloudLayout> layoutOf(const std::vector<std::vector<double>>& values);

}  // namespace perception
