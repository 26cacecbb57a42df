#pragma once
#include <cstdint>
#include <string>

namespace perception {

/// A colour and how much of it covers what lies below.
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  double alpha = 1;  ///< 0 = invisible

  Colour withAlpha(double a) const { return {r, g, b, a}; }
};

// Chosen to be told apart on white by colour-blind readers, too: Okabe and Ito, "Color universal
// design" (2008).
constexpr Colour kInk{20, 20, 20};
constexpr Colour kMutedInk{105, 105, 105};
constexpr Colour kPaper{255, 255, 255};
constexpr Colour kGridLine{170, 170, 170};
constexpr Colour kGroundPoint{205, 205, 205};
constexpr Colour kOccupied{240, 180, 60};
constexpr Colour kEgo{60, 60, 60};
constexpr Colour kPhantom{225, 20, 150};      ///< returns that are probably rain, snow, spray
constexpr Colour kMeasurement{125, 60, 190};  ///< what front ends took from the sensors
constexpr Colour kRadarReturn{150, 90, 20};
constexpr Colour kDetectorBox{235, 200, 0};  ///< boxes of an image detector, on images

/// Colour of a class; classes that are not known by name share the rest of the palette by place.
Colour colourOfClass(const std::string& name, int place);
/// Classes that are drawn quietly: objects, but nobody waits for them (static-other).
bool isMuted(const std::string& class_name);

/// Colour of a lidar return by its height above the ground [m].
Colour colourOfHeight(double height);
constexpr double kHeightLow = 0.3, kHeightHigh = 3;  ///< [m] ends of that scale

}  // namespace perception
