// Kernels of the part models, compiled once per SIMD level into a namespace of its own. No header
// with inline functions may be included here: the linker would merge them into one level's copy.
// Written with the compiler's vector extensions (vector_size).
//
// Before inclusion: PERCEPTION_SIMD_NAMESPACE, PERCEPTION_SIMD_LANES (floats per vector).
#include "libperception/detectors/simd/VisionKernels.h"

namespace perception {
namespace PERCEPTION_SIMD_NAMESPACE {
namespace {

constexpr int L = PERCEPTION_SIMD_LANES;
using V = float __attribute__((vector_size(L * sizeof(float)), aligned(4), may_alias));
using I = int __attribute__((vector_size(L * sizeof(int)), aligned(4), may_alias));

inline const V& at(const float* p) { return *reinterpret_cast<const V*>(p); }
inline V& at(float* p) { return *reinterpret_cast<V*>(p); }
inline V all(float x) { return x - V{}; }  // not V{} + x, an addition, since 0 + -0 is 0
inline V maximum(V a, V b) { return a > b ? a : b; }
inline V minimum(V a, V b) { return a < b ? a : b; }

// ---- histograms of oriented gradients ([felzenszwalb2010], section 6.1)

void gradients(const PixelRow* above, const PixelRow* row, const PixelRow* below, int width,
               float* magnitude, int* bin) {
  // Unit vectors of 9 orientations, 20 degrees apart.
  static constexpr float kCos[9] = {1.0000F,  0.9397F,  0.7660F,  0.500F,  0.1736F,
                                    -0.1736F, -0.5000F, -0.7660F, -0.9397F};
  static constexpr float kSin[9] = {0.0000F, 0.3420F, 0.6428F, 0.8660F, 0.9848F,
                                    0.9848F, 0.8660F, 0.6428F, 0.3420F};
  for (int x = 1; x < width - 1; x += L) {
    V dx = {}, dy = {}, square = {};
    square -= 1;
    for (int c = 0; c < 3; ++c) {
      const V gx = at(row->channel[c] + x + 1) - at(row->channel[c] + x - 1);
      const V gy = at(below->channel[c] + x) - at(above->channel[c] + x);
      const V s = gx * gx + gy * gy;
      const auto more = s > square;
      dx = more ? gx : dx;
      dy = more ? gy : dy;
      square = more ? s : square;
    }
    V best = {};
    I which = {};
    for (int o = 0; o < 9; ++o) {
      const V dot = kCos[o] * dx + kSin[o] * dy;
      const auto forward = dot > best;
      const V size = dot < 0 ? -dot : dot;
      const auto more = size > best;
      const I here = forward ? I{} + o : I{} + (o + 9);
      which = more ? here : which;
      best = more ? size : best;
    }
    V root;
    for (int i = 0; i < L; ++i) root[i] = __builtin_sqrtf(square[i]);
    at(magnitude + x) = root;
    *reinterpret_cast<I*>(bin + x) = which;
  }
}

void binPixels(const float* magnitude, const int* bin, const int* cell, const float* weights,
               int begin, int end, int stride, float* histogram) {
  using Pair = float __attribute__((vector_size(2 * sizeof(float)), aligned(4), may_alias));
  for (int x = begin; x < end; ++x) {
    Pair& target = *reinterpret_cast<Pair*>(histogram + bin[x] * stride + cell[x]);
    target += magnitude[x] * *reinterpret_cast<const Pair*>(weights + 2 * x);
  }
}

void accumulate(const float* source, float weight, int n, float* target) {
  for (int i = 0; i < n; i += L) at(target + i) += weight * at(source + i);
}

void energy(const float* histogram, int stride, int cells, float* energy) {
  for (int x = 0; x < cells; x += L) {
    V sum = {};
    for (int o = 0; o < 9; ++o) {
      const V both = at(histogram + o * stride + x) + at(histogram + (o + 9) * stride + x);
      sum += both * both;
    }
    at(energy + x) = sum;
  }
}

inline V inverseRoot(V sum) {
  V out;
  for (int i = 0; i < L; ++i) out[i] = 1 / __builtin_sqrtf(sum[i] + 1e-4F);
  return out;
}

void features(const float* histogram, int stride, int cells, const float* above, const float* row,
              const float* below, float* features) {
  for (int x = 1; x < cells - 1; x += L) {
    // Energies of the blocks of the cell: below right, above right, below left, above left.
    const V middle = at(row + x), up = at(above + x), down = at(below + x);
    const V right = middle + at(row + x + 1), left = middle + at(row + x - 1);
    const V n[4] = {
        inverseRoot(right + down + at(below + x + 1)), inverseRoot(right + up + at(above + x + 1)),
        inverseRoot(left + down + at(below + x - 1)), inverseRoot(left + up + at(above + x - 1))};
    V out[kHogFeatures] = {};
    for (int o = 0; o < kOrientations; ++o) {
      const V h = at(histogram + o * stride + x);
      for (int b = 0; b < 4; ++b) {
        const V part = minimum(h * n[b], all(0.2F));
        out[o] += part;
        out[27 + b] += part;
      }
      out[o] *= 0.5F;
    }
    for (int o = 0; o < 9; ++o) {
      const V h = at(histogram + o * stride + x) + at(histogram + (o + 9) * stride + x);
      for (int b = 0; b < 4; ++b) out[18 + o] += minimum(h * n[b], all(0.2F));
      out[18 + o] *= 0.5F;
    }
    for (int b = 0; b < 4; ++b) out[27 + b] *= 0.2357F;
    const int count = cells - 1 - x < L ? cells - 1 - x : L;
    for (int i = 0; i < count; ++i) {
      float* cell = features + static_cast<long>(x + i) * kHogFeatures;
      for (int f = 0; f < kHogFeatures; ++f) cell[f] = out[f][i];
    }
  }
}

// ---- Fourier transforms of patches; a lane is a feature or a filter

/// 4 points in place, e^{-i}.
inline void fft4(V* re, V* im, int a, int b, int c, int d) {
  const V r0 = re[a] + re[c], i0 = im[a] + im[c], r1 = re[a] - re[c], i1 = im[a] - im[c];
  const V r2 = re[b] + re[d], i2 = im[b] + im[d], r3 = re[b] - re[d], i3 = im[b] - im[d];
  re[a] = r0 + r2, im[a] = i0 + i2;
  re[c] = r0 - r2, im[c] = i0 - i2;
  re[b] = r1 + i3, im[b] = i1 - r3;
  re[d] = r1 - i3, im[d] = i1 + r3;
}

inline void turn(V& re, V& im, float c, float s) {  // times c - i s
  const V r = re * c + im * s;
  im = im * c - re * s;
  re = r;
}

/// 16 points, e^{-i}; exchange re and im for e^{+i}. `step` in vectors.
inline void fft16(V* re, V* im, int step) {
  constexpr float c1 = 0.92387953251128674F, s1 = 0.38268343236508977F, h = 0.70710678118654752F;
  V r[16], i[16];
  for (int n = 0; n < 16; ++n) r[n] = re[n * step], i[n] = im[n * step];
  for (int n = 0; n < 4; ++n) fft4(r, i, n, n + 4, n + 8, n + 12);
  // Element 4 k1 + n2 is A[n2][k1]: multiply by the twiddle factor e^{-2 pi i n2 k1 / 16}.
  turn(r[5], i[5], c1, s1), turn(r[6], i[6], h, h), turn(r[7], i[7], s1, c1);
  turn(r[9], i[9], h, h), turn(r[10], i[10], 0, 1), turn(r[11], i[11], -h, h);
  turn(r[13], i[13], s1, c1), turn(r[14], i[14], -h, h), turn(r[15], i[15], -c1, -s1);
  for (int k = 0; k < 4; ++k) {
    fft4(r, i, 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3);
    for (int m = 0; m < 4; ++m) {
      re[(k + 4 * m) * step] = r[4 * k + m];
      im[(k + 4 * m) * step] = i[4 * k + m];
    }
  }
}

void forward(const float* features, long row_stride, float* spectrum) {
  V re[kPatch * kPatch], im[kPatch * kPatch];
  for (int pair = 0; pair < kHogFeatures / (2 * L); ++pair) {
    // Two vectors of features are the real and the imaginary part of one signal.
    const float* from = features + 2 * L * pair;
    for (int y = 0; y < kPatch; ++y) {
      for (int x = 0; x < kPatch; ++x) {
        re[y * kPatch + x] = at(from + y * row_stride + x * kHogFeatures);
        im[y * kPatch + x] = at(from + y * row_stride + x * kHogFeatures + L);
      }
      fft16(re + y * kPatch, im + y * kPatch, 1);
    }
    for (int x = 0; x < kPatch; ++x) fft16(re + x, im + x, kPatch);
    for (int y = 0; y < kPatch; ++y) {
      for (int x = 0; x < kHalf; ++x) {
        const int here = y * kPatch + x;
        const int there = (kPatch - y) % kPatch * kPatch + (kPatch - x) % kPatch;
        float* out = spectrum + (y * kHalf + x) * 3 * kHogFeatures + 2 * L * pair;
        const V ar = 0.5F * (re[here] + re[there]), ai = 0.5F * (im[here] - im[there]);
        const V br = 0.5F * (im[here] + im[there]), bi = 0.5F * (re[there] - re[here]);
        at(out) = ar;
        at(out + L) = br;
        at(out + kHogFeatures) = ai;
        at(out + kHogFeatures + L) = bi;
        at(out + 2 * kHogFeatures) = ar + ai;
        at(out + 2 * kHogFeatures + L) = br + bi;
      }
    }
  }
}

/// Whether the frequency is the conjugate of another.
inline bool isCopy(int x, int y) { return (x == 0 || x == kPatch / 2) && y > kPatch / 2; }

/// One frequency of kCount patches: kVectors of the group's two vectors of filters by 32 features.
template <int kCount, int kVectors>
inline void frequency(const float* weights, const float* const* spectra, long offset,
                      float* const* products, long offset_out) {
  V k1[kVectors][kCount] = {}, k2[kVectors][kCount] = {}, k3[kVectors][kCount] = {};
  for (int c = 0; c < kHogFeatures; ++c) {
    for (int p = 0; p < kCount; ++p) {
      const float* x = spectra[p] + offset + c;
      const V re = all(x[0]), im = all(x[kHogFeatures]), sum = all(x[2 * kHogFeatures]);
      for (int v = 0; v < kVectors; ++v) {
        k1[v][p] += sum * at(weights + 3 * v * L);
        k2[v][p] += re * at(weights + (3 * v + 1) * L);
        k3[v][p] += im * at(weights + (3 * v + 2) * L);
      }
    }
    weights += kWeights * L;
  }
  for (int p = 0; p < kCount; ++p) {
    for (int v = 0; v < kVectors; ++v) {
      at(products[p] + offset_out + 2 * v * L) = k1[v][p] - k3[v][p];
      at(products[p] + offset_out + (2 * v + 1) * L) = k1[v][p] + k2[v][p];
    }
  }
}

template <int kCount>
inline void frequencyOf(const float* weights, const float* const* spectra, long offset,
                        float* const* products, long offset_out) {
  if constexpr (L == 16) {  // 32 registers hold both vectors of filters
    frequency<kCount, 2>(weights, spectra, offset, products, offset_out);
  } else {
    frequency<kCount, 1>(weights, spectra, offset, products, offset_out);
    frequency<kCount, 1>(weights + 3 * L, spectra, offset, products, offset_out + 2 * L);
  }
}

void products(const float* weights, const float* const* spectra, int patches,
              float* const* products) {
  for (int y = 0; y < kPatch; ++y) {
    for (int x = 0; x < kHalf; ++x) {
      if (isCopy(x, y)) continue;
      const long w = y * kHalf + x;
      const float* at_w = weights + w * kHogFeatures * kWeights * L;
      const long in = w * 3 * kHogFeatures, out = w * 4 * L;
      int p = 0;
      for (; p + 4 <= patches; p += 4) frequencyOf<4>(at_w, spectra + p, in, products + p, out);
      for (; p < patches; ++p) frequencyOf<1>(at_w, spectra + p, in, products + p, out);
    }
  }
}

void inverse(const float* products, int rows, int cols, float* responses, long row_stride) {
  // Two vectors of filters are the real and the imaginary part of one signal.
  V re[kPatch * kPatch], im[kPatch * kPatch];
  for (int y = 0; y < kPatch; ++y) {
    for (int x = 0; x < kHalf; ++x) {
      if (isCopy(x, y)) continue;
      const float* from = products + (y * kHalf + x) * 4 * L;
      const V ar = at(from), ai = at(from + L), br = at(from + 2 * L), bi = at(from + 3 * L);
      const int here = y * kPatch + x;
      const int there = (kPatch - y) % kPatch * kPatch + (kPatch - x) % kPatch;
      re[here] = ar - bi, im[here] = ai + br;
      if (here == there) continue;
      re[there] = ar + bi, im[there] = br - ai;
    }
  }
  for (int x = 0; x < kPatch; ++x) fft16(im + x, re + x, kPatch);
  for (int y = 0; y < rows; ++y) {
    fft16(im + y * kPatch, re + y * kPatch, 1);
    for (int x = 0; x < cols; ++x) {
      float* out = responses + y * row_stride + static_cast<long>(x) * 2 * L;
      at(out) = re[y * kPatch + x];
      at(out + L) = im[y * kPatch + x];
    }
  }
}

// ---- displacement of parts

void displace(const float* responses, long row_stride, int rows, int cols, int window,
              const float* costs_x, const float* costs_y, float* scratch, float* best) {
  const int half_cols = (cols + 1) / 2, half_rows = (rows + 1) / 2, taps = 2 * window + 1;
  const long scratch_stride = static_cast<long>(half_cols) * 2 * L;
  for (int y = 0; y < rows + 2 * window; ++y) {
    for (int x = 0; x < half_cols; ++x) {
      const float* from = responses + y * row_stride + static_cast<long>(2 * x) * 2 * L;
      V a = at(from) - at(costs_x), b = at(from + L) - at(costs_x + L);
      for (int d = 1; d < taps; ++d) {
        a = maximum(a, at(from + d * 2 * L) - at(costs_x + d * 2 * L));
        b = maximum(b, at(from + d * 2 * L + L) - at(costs_x + d * 2 * L + L));
      }
      at(scratch + y * scratch_stride + x * 2 * L) = a;
      at(scratch + y * scratch_stride + x * 2 * L + L) = b;
    }
  }
  for (int y = 0; y < half_rows; ++y) {
    for (int x = 0; x < half_cols; ++x) {
      const float* from = scratch + 2 * y * scratch_stride + static_cast<long>(x) * 2 * L;
      V a = at(from) - at(costs_y), b = at(from + L) - at(costs_y + L);
      for (int d = 1; d < taps; ++d) {
        a = maximum(a, at(from + d * scratch_stride) - at(costs_y + d * 2 * L));
        b = maximum(b, at(from + d * scratch_stride + L) - at(costs_y + d * 2 * L + L));
      }
      at(best + y * scratch_stride + x * 2 * L) = a;
      at(best + y * scratch_stride + x * 2 * L + L) = b;
    }
  }
}

// ---- roots

template <int kCount>
inline void correlateSome(const float* features, long row_stride, const float* filter, int height,
                          int width, float* responses) {
  V sum[kCount] = {};
  for (int y = 0; y < height; ++y) {
    const float* row = features + y * row_stride;
    for (int i = 0; i < width * kHogFeatures; i += L) {
      const V w = at(filter + i);
      for (int p = 0; p < kCount; ++p) sum[p] += w * at(row + i + p * kHogFeatures);
    }
    filter += width * kHogFeatures;
  }
  for (int p = 0; p < kCount; ++p) {
    float total = 0;
    for (int i = 0; i < L; ++i) total += sum[p][i];
    responses[p] = total;
  }
}

void correlate(const float* features, long row_stride, const float* filter, int height, int width,
               int n, float* responses) {
  constexpr int kBlock = 8;
  int x = 0;
  for (; x + kBlock <= n; x += kBlock)
    correlateSome<kBlock>(features + static_cast<long>(x) * kHogFeatures, row_stride, filter, height,
                          width, responses + x);
  for (; x < n; ++x)
    correlateSome<1>(features + static_cast<long>(x) * kHogFeatures, row_stride, filter, height, width,
                     responses + x);
}

void blend(const float* const* sources, const float* weights, int count, int n, float* target) {
  for (int i = 0; i < n; i += L) {
    V sum = weights[0] * at(sources[0] + i);
    for (int k = 1; k < count; ++k) sum += weights[k] * at(sources[k] + i);
    at(target + i) = sum;
  }
}

void gather(const float* source, const int* first, const float* weights, int n, float* target) {
  const float* w1 = weights + n;
  const float* w2 = weights + 2 * n;
  for (int i = 0; i < n; ++i) {
    const float* s = source + first[i];
    target[i] = weights[i] * s[0] + w1[i] * s[1] + w2[i] * s[2];
  }
}

}  // namespace

extern const VisionKernels kVisionKernels;
const VisionKernels kVisionKernels = {L,         gradients, binPixels, accumulate, energy,
                                      features,  forward,   products,  inverse,    displace,
                                      correlate, blend,     gather};

}  // namespace PERCEPTION_SIMD_NAMESPACE
}  // namespace perception
