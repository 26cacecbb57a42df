// The arithmetic of BankBatch, compiled once a SIMD level into a namespace of its own. No header
// may be included here that has inline functions: the linker would take one level's copy for all.
// Written in vectors of the compiler (vector_size), with exp of libmvec. Padding lanes are
// computed along and ignored.
//
// Before inclusion: PERCEPTION_SIMD_NAMESPACE, PERCEPTION_SIMD_LANES, and PERCEPTION_SIMD_MATH(f),
// the name of libmvec's function f for so many lanes.

namespace perception {
namespace PERCEPTION_SIMD_NAMESPACE {

using Count = unsigned long;
constexpr Count kLanes = PERCEPTION_SIMD_LANES;
using V = double __attribute__((vector_size(PERCEPTION_SIMD_LANES * sizeof(double))));

using I = long long __attribute__((vector_size(PERCEPTION_SIMD_LANES * sizeof(double))));

extern "C" {
V PERCEPTION_SIMD_MATH(exp)(V);
}

inline const V& at(const double* p) { return *reinterpret_cast<const V*>(p); }
inline V& at(double* p) { return *reinterpret_cast<V*>(p); }

/// Sine and cosine together, for |x| below 1e5, to 2e-16 or so: reduced by multiples of pi/2, then
/// the polynomials of fdlibm (k_sin.c, k_cos.c, Sun Microsystems 1993).
inline void sineAndCosine(const V& x, V& sine, V& cosine) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  const V shifted = x * 0.63661977236758134308 + kShift;
  const V turns = shifted - kShift;
  const V r = (x - turns * 1.57079632679489655800) - turns * 6.12323399573676603587e-17;
  const V z = r * r;
  const V s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const V c =
      1 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const I quadrant = reinterpret_cast<I>(shifted);
  const I odd = (quadrant & 1) != 0;
  const V sine_size = odd ? c : s, cosine_size = odd ? s : c;
  sine = (quadrant & 2) != 0 ? -sine_size : sine_size;
  cosine = ((quadrant + 1) & 2) != 0 ? -cosine_size : cosine_size;
}

/// The upper triangle of P lies in planes 4 to 13.
struct Lanes {
  V x0, x1, x2, x3, p00, p01, p02, p03, p11, p12, p13, p22, p23, p33;

  Lanes(const double* b, Count s)
      : x0(at(b)),
        x1(at(b + s)),
        x2(at(b + 2 * s)),
        x3(at(b + 3 * s)),
        p00(at(b + 4 * s)),
        p01(at(b + 5 * s)),
        p02(at(b + 6 * s)),
        p03(at(b + 7 * s)),
        p11(at(b + 8 * s)),
        p12(at(b + 9 * s)),
        p13(at(b + 10 * s)),
        p22(at(b + 11 * s)),
        p23(at(b + 12 * s)),
        p33(at(b + 13 * s)) {}

  void store(double* b, Count s) const {
    at(b) = x0, at(b + s) = x1, at(b + 2 * s) = x2, at(b + 3 * s) = x3, at(b + 4 * s) = p00;
    at(b + 5 * s) = p01, at(b + 6 * s) = p02, at(b + 7 * s) = p03, at(b + 8 * s) = p11;
    at(b + 9 * s) = p12, at(b + 10 * s) = p13, at(b + 11 * s) = p22, at(b + 12 * s) = p23;
    at(b + 13 * s) = p33;
  }
};

/// [x, y, vx, vy], method.md 3.1: k, tau and Q by eq. (4), method.md (4), are in the planes of `m`.
void predictConstantVelocity(Count n, Count s, const double* m, double* bank) {
  for (Count i = 0; i < n; i += kLanes) {
    Lanes b(bank + i, s);
    const double* own = m + i;
    const V decay = at(own), dt_eff = at(own + s), pp = at(own + 2 * s) + at(own + 5 * s),
            pv = at(own + 3 * s), vv = at(own + 4 * s);
    b.x0 += dt_eff * b.x2;
    b.x1 += dt_eff * b.x3;
    b.x2 *= decay;
    b.x3 *= decay;
    const V g02 = b.p02 + dt_eff * b.p22, g03 = b.p03 + dt_eff * b.p23;
    const V g12 = b.p12 + dt_eff * b.p23, g13 = b.p13 + dt_eff * b.p33;
    b.p00 += dt_eff * (b.p02 + g02) + pp;
    b.p01 += dt_eff * (b.p12 + g03);
    b.p11 += dt_eff * (b.p13 + g13) + pp;
    b.p02 = decay * g02 + pv;
    b.p03 = decay * g03;
    b.p12 = decay * g12;
    b.p13 = decay * g13 + pv;
    b.p22 = decay * decay * b.p22 + vv;
    b.p23 *= decay * decay;
    b.p33 = decay * decay * b.p33 + vv;
    b.store(bank + i, s);
  }
}

/// [x, y, v, theta]: F by method.md (6), Q by method.md (7).
void predictWheeled(Count n, Count s, const double* m, double* bank) {
  for (Count i = 0; i < n; i += kLanes) {
    Lanes q(bank + i, s);
    const double* own = m + i;
    const V decay = at(own), dt_eff = at(own + s), pp = at(own + 2 * s), pv = at(own + 3 * s),
            vv = at(own + 4 * s), slip = at(own + 5 * s), ypp = at(own + 6 * s),
            ypy = at(own + 7 * s), yyy = at(own + 8 * s);
    const V v = q.x2;
    V cs, sn;
    sineAndCosine(q.x3, sn, cs);
    const V a = dt_eff * cs, b = -dt_eff * v * sn, d = dt_eff * sn, e = dt_eff * v * cs;
    q.x0 += a * v;
    q.x1 += d * v;
    q.x2 = decay * v;
    const V p22 = q.p22, p23 = q.p23, p33 = q.p33;
    const V g02 = q.p02 + a * p22 + b * p23, g03 = q.p03 + a * p23 + b * p33;
    const V g12 = q.p12 + d * p22 + e * p23, g13 = q.p13 + d * p23 + e * p33;
    const V g00 = q.p00 + a * q.p02 + b * q.p03;
    const V g01 = q.p01 + a * q.p12 + b * q.p13;
    const V g11 = q.p11 + d * q.p12 + e * q.p13;
    const V n0 = -v * sn, n1 = v * cs;
    q.p00 = g00 + a * g02 + b * g03 + pp * cs * cs + ypp * n0 * n0 + slip;
    q.p01 = g01 + d * g02 + e * g03 + pp * cs * sn + ypp * n0 * n1;
    q.p11 = g11 + d * g12 + e * g13 + pp * sn * sn + ypp * n1 * n1 + slip;
    q.p02 = decay * g02 + pv * cs;
    q.p12 = decay * g12 + pv * sn;
    q.p03 = g03 + ypy * n0;
    q.p13 = g13 + ypy * n1;
    q.p22 = decay * decay * p22 + vv;
    q.p23 = decay * p23;
    q.p33 = p33 + yyy;
    q.store(bank + i, s);
  }
}

/// [x, y, v, theta] by the moments of an uncertain heading, method.md (8), with Q of method.md (7):
/// predictUncertainHeading() of MotionModel.cpp in vectors.
void predictMoments(Count n, Count s, const double* m, double* bank) {
  for (Count i = 0; i < n; i += kLanes) {
    Lanes q(bank + i, s);
    const double* own = m + i;
    const V decay = at(own), dt_eff = at(own + s), pp = at(own + 2 * s), pv = at(own + 3 * s),
            vv = at(own + 4 * s), slip = at(own + 5 * s), ypp = at(own + 6 * s),
            ypy = at(own + 7 * s), yyy = at(own + 8 * s);
    const V v = q.x2, cov = q.p23;
    V cs, sn;
    sineAndCosine(q.x3, sn, cs);
    const V shrink = PERCEPTION_SIMD_MATH(exp)(-0.5 * q.p33);
    const V ux = shrink * cs, uy = shrink * sn;
    const V mx = v * ux - cov * uy, my = v * uy + cov * ux;
    const V nx = -my, ny = mx;
    const V shrink4 = shrink * shrink * shrink * shrink;
    const V tx = shrink4 * (cs * cs - sn * sn), ty = 2 * shrink4 * cs * sn;
    const V whole = v * v + q.p22, re = whole - 4 * cov * cov, im = 4 * v * cov;
    const V sx = tx * re - ty * im, sy = tx * im + ty * re;
    const V s00 = 0.5 * (whole + sx), s01 = 0.5 * sy, s11 = 0.5 * (whole - sx);  // E[V V']
    const V a00 = ux * q.p22 + nx * cov, a01 = ux * cov + nx * q.p33;            // slope B
    const V a10 = uy * q.p22 + ny * cov, a11 = uy * cov + ny * q.p33;
    const V rest00 = s00 - mx * mx - (a00 * ux + a01 * nx);  // unexplained by the slope
    const V rest01 = s01 - mx * my - (a00 * uy + a01 * ny);
    const V rest11 = s11 - my * my - (a10 * uy + a11 * ny);
    const V g02 = q.p02 + dt_eff * a00, g03 = q.p03 + dt_eff * a01;
    const V g12 = q.p12 + dt_eff * a10, g13 = q.p13 + dt_eff * a11;
    const V dt_eff2 = dt_eff * dt_eff;
    q.p00 += dt_eff * (ux * q.p02 + nx * q.p03) + dt_eff * (g02 * ux + g03 * nx) +
             pp * 0.5 * (1 + tx) + ypp * (whole - s00) + dt_eff2 * rest00 + slip;
    q.p01 += dt_eff * (ux * q.p12 + nx * q.p13) + dt_eff * (g02 * uy + g03 * ny) + pp * 0.5 * ty -
             ypp * s01 + dt_eff2 * rest01;
    q.p11 += dt_eff * (uy * q.p12 + ny * q.p13) + dt_eff * (g12 * uy + g13 * ny) +
             pp * 0.5 * (1 - tx) + ypp * (whole - s11) + dt_eff2 * rest11 + slip;
    q.p02 = decay * g02 + pv * ux;
    q.p12 = decay * g12 + pv * uy;
    q.p03 = g03 + ypy * nx;
    q.p13 = g13 + ypy * ny;
    q.p22 = decay * decay * q.p22 + vv;
    q.p23 = decay * cov;
    q.p33 += yyy;
    q.x0 += dt_eff * mx;
    q.x1 += dt_eff * my;
    q.x2 = decay * v;
    q.store(bank + i, s);
  }
}

}  // namespace PERCEPTION_SIMD_NAMESPACE
}  // namespace perception
