#pragma once
#include "libperception/scene/ClassColors.h"

namespace perception {

// Colors of the pictures besides those of classes (libperception/scene/ClassColors.h).
constexpr Color kInk{20, 20, 20};
constexpr Color kMutedInk{105, 105, 105};
constexpr Color kPaper{255, 255, 255};
constexpr Color kGridLine{170, 170, 170};
constexpr Color kGroundPoint{205, 205, 205};
constexpr Color kOccupied{240, 180, 60};
constexpr Color kEgo{60, 60, 60};
constexpr Color kPhantom{225, 20, 150};  ///< returns with trust below kTrusted: rain, snow, spray
constexpr Color kMeasurement{125, 60, 190};  ///< measurements
constexpr Color kRadarReturn{150, 90, 20};
constexpr Color kDetectorBox{235, 200, 0};  ///< boxes of an image detector, on images

/// Color of a lidar return by its height above the ground [m].
Color colorOfHeight(double height);
constexpr double kHeightLow = 0.3, kHeightHigh = 3;  ///< [m] limits of the color scale

}  // namespace perception
