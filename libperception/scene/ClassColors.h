#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace perception {

/// An RGBA color.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  double alpha = 1;  ///< 0 = invisible

  Color withAlpha(double a) const { return {r, g, b, a}; }
};

/// Colors that color-blind readers can tell apart on white: Okabe and Ito, "Color universal design"
/// (2008).
namespace okabe_ito {
inline constexpr Color kBlue{0, 114, 178}, kVermilion{213, 94, 0}, kGreen{0, 158, 115},
    kPurple{204, 121, 167}, kOrange{230, 159, 0}, kSky{86, 180, 233}, kBlack{0, 0, 0};
}  // namespace okabe_ito

/// Color of a class in all pictures, plots and pages. Classes without a fixed color get one of the
/// remaining palette by index `place`.
Color colorOfClass(const std::string& name, int place);
/// Classes drawn in gray because they are not road users (static-other).
bool isMuted(const std::string& class_name);

/// Color of the i-th of several curves.
Color colorOfCurve(std::size_t i);

/// #rrggbb, as HTML and gnuplot take it.
std::string hexOf(const Color& color);

}  // namespace perception
