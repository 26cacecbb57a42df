// Kernels of the part models, compiled once per SIMD level. No inline functions and no other
// headers here: the linker would merge them into one level's copy.
#pragma once

namespace perception {

/// Sides of the patches that are convolved by Fourier transform, and of their half spectrum.
enum {
  kPatch = 16,                                  ///< [cells]
  kHalf = kPatch / 2 + 1,                       ///< columns of the spectrum of a real signal
  kFrequencies = kPatch * kHalf,                ///< ky major, kx = 0 .. kHalf - 1
  kHogFeatures = 32,                            ///< values of a HOG cell
  kSpectrum = kFrequencies * 3 * kHogFeatures,  ///< floats of a patch's spectrum
  kWeights = 6,                                 ///< vectors of a group's weight: see products()
  kOrientations = 18                            ///< contrast sensitive
};

/// A row of an image in three planes.
struct PixelRow {
  const float* channel[3];
};

struct VisionKernels {
  int lanes;  ///< floats per vector; a group has 2 * lanes filters

  /// For pixels 1 .. width - 2: magnitude of the strongest channel's gradient and its orientation,
  /// 0 .. 17 in steps of 20 degrees. Writes up to one vector beyond.
  void (*gradients)(const PixelRow* above, const PixelRow* row, const PixelRow* below, int width,
                    float* magnitude, int* bin);
  /// Distributes each pixel to the two nearest cells: adds to histogram[bin * stride + cell[x]] and
  /// the next element, weighted by weights[2 x], weights[2 x + 1].
  void (*bin)(const float* magnitude, const int* bin, const int* cell, const float* weights,
              int begin, int end, int stride, float* histogram);
  /// target += weight * source
  void (*accumulate)(const float* source, float weight, int n, float* target);
  /// Energies of the cells of a histogram row (stride floats an orientation).
  void (*energy)(const float* histogram, int stride, int cells, float* energy);
  /// The 32 features of cells 1 .. cells - 2 of a row; energies of the rows above, at, below.
  void (*features)(const float* histogram, int stride, int cells, const float* above,
                   const float* at, const float* below, float* features);
  /// The half spectrum of kPatch x kPatch cells: kSpectrum floats, per frequency 32 real parts, 32
  /// imaginary parts and 32 sums of both. `row_stride` in floats.
  void (*forward)(const float* features, long row_stride, float* spectrum);
  /// Sums over features of spectrum x times weight w for up to kAtOnce patches: per patch
  /// kFrequencies * 4 * lanes floats (A.re, A.im, B.re, B.im), where a group's filters are A and B.
  /// By three products, not four: w is given as w.re, w.im - w.re, w.im + w.re of A, then of B; x w
  /// = k - x.im (w.im + w.re) + i (k + x.re (w.im - w.re)) with k = (x.re + x.im) w.re. Frequencies
  /// that are conjugates of others (kx = 0 or 8, ky > 8) are skipped.
  void (*products)(const float* weights, const float* const* spectra, int patches,
                   float* const* products);
  /// Inverse transform to `rows` x `cols` responses of 2 * lanes filters each; strides in floats.
  void (*inverse)(const float* products, int rows, int cols, float* responses, long row_stride);
  /// Best displaced response at every second position: from rows x cols responses of 2 * lanes
  /// filters with a margin of `window`; costs are (2 window + 1) x 2 * lanes for x, then for y.
  void (*displace)(const float* responses, long row_stride, int rows, int cols, int window,
                   const float* costs_x, const float* costs_y, float* scratch, float* best);
  /// Direct correlation of a filter (height x width cells) at `n` positions of a row.
  void (*correlate)(const float* features, long row_stride, const float* filter, int height,
                    int width, int n, float* responses);
  /// Vertical resampling: target = sum of weights[k] * sources[k].
  void (*blend)(const float* const* sources, const float* weights, int count, int n, float* target);
  /// Horizontal resampling: target[i] = sum of weights[k * n + i] * source[first[i] + k], k = 0 ..
  /// 2.
  void (*gather)(const float* source, const int* first, const float* weights, int n, float* target);
};

enum { kAtOnce = 16 };  ///< largest number of patches per call of products()

namespace sse2 {
extern const VisionKernels kVisionKernels;
}
namespace avx2 {
extern const VisionKernels kVisionKernels;
}
namespace avx512 {
extern const VisionKernels kVisionKernels;
}

}  // namespace perception
