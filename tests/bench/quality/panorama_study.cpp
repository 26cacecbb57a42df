// The geometry of panoramas, rendered and measured back: bearing and range of a post at all
// bearings, by resolution; a degree of pitch that nobody knows of against the stated deviation.
#include <fmt/format.h>

#include "tests/detectors/PanoramaChain.h"

int main() {
  using namespace perception;
  using namespace perception::test;
  fmt::print("one post (simulated), 24 bearings a row, camera {} m over the ground\n", kHeight);
  fmt::print("{:>6} {:>8} {:>9} {:>14} {:>14} {:>16} {:>9} {:>26}\n", "width", "range m", "too far",
             "range err mean", "range err max", "bearing err mdeg", "not one",
             "1 deg of pitch, deviations");
  for (const int width : {1024, 2048, 4096, 8192}) {
    const Panorama panorama(width);
    for (const double distance : {5.0, 10.0, 15.0, 20.0, 30.0}) {
      double mean = 0, bias = 0, worst = 0, bearing = 0, pitch = 0;
      int other = 0;
      constexpr int kBearings = 24;
      for (int i = 0; i < kBearings; ++i) {
        const Post post{-kPi + kTwoPi * (i + 0.03) / kBearings, distance};  // the first at the seam
        const ChainError e = chainError(panorama, post);
        other += e.objects != 1;
        mean += e.range / kBearings;
        bias += e.too_far / kBearings;
        worst = std::max(worst, e.range);
        bearing = std::max(bearing, e.bearing);
        pitch = std::max(pitch, std::abs(chainError(panorama, post, radians(1)).deviations));
      }
      fmt::print("{:6} {:8.0f} {:7.2f} % {:12.2f} % {:12.2f} % {:16.1f} {:9} {:26.1f}\n", width,
                 distance, 100 * bias, 100 * mean, 100 * worst, 1e3 * degrees(bearing), other,
                 pitch);
    }
  }
  return 0;
}
