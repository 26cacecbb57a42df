#pragma once

namespace perception {

/// Measures that the pictures of scenes have in common.
inline constexpr int kTitle = 30, kMargin = 10;             // [px] height of the title line; border
inline constexpr double kTitleSize = 10, kSmallSize = 7.5;  // [px] height of capitals
inline constexpr double kArrowTime =
    1;  // [s] a velocity's arrow is as long as the way in this time
inline constexpr double kStanding = 0.5;  // [m/s] below this speed there is no arrow

}  // namespace perception
