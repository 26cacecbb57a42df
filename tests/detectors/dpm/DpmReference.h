#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/detectors/dpm/DpmEngine.h"
#include "tests/support/DpmText.h"

// The detector of Felzenszwalb et al. written down literally, in double precision and with no eye
// on time: what the engine must give.
namespace perception::test {

struct ReferenceImage {
  int width = 0, height = 0;
  std::vector<double> values;  // 3 a pixel
  double at(int x, int y, int c) const {
    return values[static_cast<std::size_t>((y * width + x) * 3 + c)];
  }
};

inline ReferenceImage referenceImage(const Raster& raster) {
  ReferenceImage out{raster.width, raster.height, {}};
  out.values.assign(raster.pixels.begin(), raster.pixels.end());
  return out;
}

inline ReferenceImage referenceHalved(const ReferenceImage& image) {
  ReferenceImage out{image.width / 2, image.height / 2, {}};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c)
        out.values.push_back((image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) +
                              image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c)) /
                             4);
  return out;
}

/// The integral of the image over each pixel's area (smaller), or linear between centers (larger).
inline ReferenceImage referenceResampled(const ReferenceImage& image, int width, int height) {
  const auto weights = [](int from, int to, int i) {
    std::vector<double> w(static_cast<std::size_t>(from), 0.0);
    const double ratio = static_cast<double>(from) / to;
    if (ratio > 1) {
      for (int k = 0; k < from; ++k)
        w[static_cast<std::size_t>(k)] =
            std::max(0.0, std::min(k + 1.0, (i + 1) * ratio) - std::max(k + 0.0, i * ratio)) /
            ratio;
    } else {
      const double place = std::clamp((i + 0.5) * ratio - 0.5, 0.0, from - 1.0);
      const int low = static_cast<int>(place);
      w[static_cast<std::size_t>(low)] = 1 - (place - low);
      if (low + 1 < from) w[static_cast<std::size_t>(low) + 1] = place - low;
    }
    return w;
  };
  ReferenceImage out{width, height, {}};
  for (int y = 0; y < height; ++y) {
    const auto wy = weights(image.height, height, y);
    for (int x = 0; x < width; ++x) {
      const auto wx = weights(image.width, width, x);
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int v = 0; v < image.height; ++v) {
          if (wy[static_cast<std::size_t>(v)] == 0) continue;
          for (int u = 0; u < image.width; ++u) {
            const double w = wx[static_cast<std::size_t>(u)];
            if (w != 0) sum += wy[static_cast<std::size_t>(v)] * w * image.at(u, v, c);
          }
        }
        out.values.push_back(sum);
      }
    }
  }
  return out;
}

/// features.cc of voc-release4 in words: HOG of an endless plane of cells, nothing but the last
/// value outside.
class ReferenceHog {
 public:
  ReferenceHog(const ReferenceImage& image, int side)
      : nx_(static_cast<int>(std::lround(static_cast<double>(image.width) / side))),
        ny_(static_cast<int>(std::lround(static_cast<double>(image.height) / side))),
        histogram_(static_cast<std::size_t>(nx_ * ny_)),
        energy_(static_cast<std::size_t>(nx_ * ny_), 0.0) {
    static constexpr double kCos[9] = {1.0,     0.9397,  0.7660,  0.5,    0.1736,
                                       -0.1736, -0.5000, -0.7660, -0.9397};
    static constexpr double kSin[9] = {0.0,    0.3420, 0.6428, 0.8660, 0.9848,
                                       0.9848, 0.8660, 0.6428, 0.3420};
    for (int y = 1; y < ny_ * side - 1; ++y) {
      for (int x = 1; x < nx_ * side - 1; ++x) {
        const int u = std::min(x, image.width - 2), v = std::min(y, image.height - 2);
        double square = -1, dx = 0, dy = 0;
        for (int c = 0; c < 3; ++c) {
          const double gx = image.at(u + 1, v, c) - image.at(u - 1, v, c);
          const double gy = image.at(u, v + 1, c) - image.at(u, v - 1, c);
          if (gx * gx + gy * gy > square) square = gx * gx + gy * gy, dx = gx, dy = gy;
        }
        double best = 0;
        int which = 0;
        for (int o = 0; o < 9; ++o) {
          const double dot = kCos[o] * dx + kSin[o] * dy;
          if (dot > best) best = dot, which = o;
          if (-dot > best) best = -dot, which = o + 9;
        }
        const double px = (x + 0.5) / side - 0.5, py = (y + 0.5) / side - 0.5;
        const int cx = static_cast<int>(std::floor(px)), cy = static_cast<int>(std::floor(py));
        for (int j = 0; j < 2; ++j)
          for (int i = 0; i < 2; ++i) {
            if (cx + i < 0 || cx + i >= nx_ || cy + j < 0 || cy + j >= ny_) continue;
            const double w = (i ? px - cx : 1 - px + cx) * (j ? py - cy : 1 - py + cy);
            histogram_[at(cx + i, cy + j)][static_cast<std::size_t>(which)] +=
                w * std::sqrt(square);
          }
      }
    }
    for (std::size_t i = 0; i < energy_.size(); ++i)
      for (std::size_t o = 0; o < 9; ++o)
        energy_[i] += std::pow(histogram_[i][o] + histogram_[i][o + 9], 2);
  }

  std::array<double, 32> cell(int x, int y) const {
    std::array<double, 32> f{};
    if (x < 1 || y < 1 || x >= nx_ - 1 || y >= ny_ - 1) {
      f[31] = 1;
      return f;
    }
    const auto block = [&](int i, int j) {
      return 1 /
             std::sqrt(energy_[at(x + i, y + j)] + energy_[at(x + i - 1, y + j)] +
                       energy_[at(x + i, y + j - 1)] + energy_[at(x + i - 1, y + j - 1)] + 1e-4);
    };
    const double n[4] = {block(1, 1), block(1, 0), block(0, 1), block(0, 0)};
    const auto& h = histogram_[at(x, y)];
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t o = 0; o < 18; ++o) {
        f[o] += 0.5 * std::min(h[o] * n[b], 0.2);
        f[27 + b] += 0.2357 * std::min(h[o] * n[b], 0.2);
      }
      for (std::size_t o = 0; o < 9; ++o)
        f[18 + o] += 0.5 * std::min((h[o] + h[o + 9]) * n[b], 0.2);
    }
    return f;
  }
  int cellsX() const { return nx_; }
  int cellsY() const { return ny_; }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y * nx_ + x); }
  int nx_, ny_;
  std::vector<std::array<double, 18>> histogram_;
  std::vector<double> energy_;
};

inline double referenceResponse(const ReferenceHog& hog, const DpmFilter& filter, int x, int y) {
  double sum = 0;
  for (int j = 0; j < filter.height; ++j)
    for (int i = 0; i < filter.width; ++i) {
      const auto f = hog.cell(x + i, y + j);
      for (std::size_t k = 0; k < 32; ++k)
        sum +=
            f[k] * static_cast<double>(
                       filter.weights[static_cast<std::size_t>((j * filter.width + i) * 32) + k]);
    }
  return sum;
}

/// Score of one component with its root's corner at cell (x, y).
inline double referenceScore(const ReferenceHog& roots, const ReferenceHog& parts,
                             const DpmComponent& c, int x, int y, int window) {
  double score = referenceResponse(roots, c.root, x, y) + c.offset;
  for (const DpmPart& part : c.parts) {
    double best = -1e9;
    for (int dy = -window; dy <= window; ++dy)
      for (int dx = -window; dx <= window; ++dx) {
        // Displacements are anchor - place.
        const double* d = part.deformation;
        best = std::max(best, referenceResponse(parts, part.filter, 2 * x + part.anchor_x - dx,
                                                2 * y + part.anchor_y - dy) -
                                  (d[0] * dx * dx + d[1] * dx + d[2] * dy * dy + d[3] * dy));
      }
    score += best;
  }
  return score;
}

}  // namespace perception::test
