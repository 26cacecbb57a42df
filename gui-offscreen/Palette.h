#pragma once
#include <cstdint>
#include <string>

namespace perception {

/// A color and how much of it covers what lies below.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  double alpha = 1;  ///< 0 = invisible

  Color withAlpha(double a) const { return {r, g, b, a}; }
};

// SelectedIndices to be told apart on white by color-blind readers, too: Okabe and Ito, "Color
// universal design" (2008).
constexpr Color kInk{20, 20, 20};
constexpr Color kMutedInk{105, 105, 105};
constexpr Color kPaper{255, 255, 255};
constexpr Color kGridLine{170, 170, 170};
constexpr Color kGroundPoint{205, 205, 205};
constexpr Color kOccupied{240, 180, 60};
constexpr Color kEgo{60, 60, 60};
constexpr Color kPhantom{225, 20, 150};      ///< returns that are probably rain, snow, spray
constexpr Color kMeasurement{125, 60, 190};  ///< what front ends took from the sensors
constexpr Color kRadarReturn{150, 90, 20};
constexpr Color kDetectorBox{235, 200, 0};  ///< boxes of an image detector, on images

/// Color of a class; classes that are not known by name share the rest of the palette by place.
Color colorOfClass(const std::string& name, int place);
/// Classes that are drawn quietly: objects, but nobody waits for them (static-other).
bool isMuted(const std::string& class_name);

/// Color of a lidar return by its height above the ground [m].
Color colorOfHeight(double height);
constexpr double kHeightLow = 0.3, kHeightHigh = 3;  ///< [m] ends of that scale

}  // namespace perception
