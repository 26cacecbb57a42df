#include "libperception/simulation/weather/particles/Precipitation.h"

#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// Extinction by a sum over diameters [mm], cross sections as m^2.
double summed(const SizeDistribution& sizes, double efficiency) {
  double sum = 0;
  const double step = 0.001;
  for (double d = step / 2; d < 40; d += step) {
    sum += kPi / 4 * d * d * 1e-6 * efficiency * sizes.number * std::exp(-sizes.slope * d) * step;
  }
  return sum;
}

TEST(Precipitation, ExtinctionOfRainIsThatOfItsDrops) {
  for (const double rate : {0.5, 1.0, 10.0, 25.0, 50.0}) {
    EXPECT_NEAR(rainExtinction(rate) / (3.7e-4 * std::pow(rate, 0.63)), 1, 0.02) << rate;
    EXPECT_NEAR(rainExtinction(rate) / summed(marshallPalmer(rate), 2.03), 1, 0.001) << rate;
  }
  EXPECT_EQ(rainExtinction(0), 0);
}

TEST(Precipitation, ExtinctionOfSnowIsThatOfItsFlakes) {
  for (const double rate : {0.5, 1.0, 2.5, 10.0}) {
    EXPECT_NEAR(snowExtinction(rate) / (1.44e-3 * std::pow(rate, 0.57)), 1, 0.02) << rate;
    EXPECT_NEAR(snowExtinction(rate) / summed(gunnMarshall(rate), 2.0), 1, 0.001) << rate;
  }
}

TEST(Precipitation, RadarLosesADecibelInHeavyRain) {
  EXPECT_NEAR(2 * radarAttenuation(25) * 50 / 1000, 1.1, 0.05);
  EXPECT_NEAR(2 * radarAttenuation(50) * 100 / 1000, 3.8, 0.05);
}

TEST(Precipitation, ShareOfNearReturnsIsThatOfTheDrawnOnes) {
  Rng rng({3, 0, 0, 0});
  int near = 0;
  for (int i = 0; i < 20000; ++i) near += kSnowReturns.range(rng) < 5;
  EXPECT_NEAR(near / 20000.0, kSnowReturns.shareWithin(5), 0.01);
  EXPECT_NEAR(kSnowReturns.shareWithin(5), 0.589, 0.001);
}

/// Backscatter and extinction efficiency of a sphere of size x and refractive index m by the
/// series of [mie1908].
struct Efficiencies {
  double backscatter, extinction;
};
Efficiencies mie(double x, std::complex<double> m) {
  using Complex = std::complex<double>;
  const int orders = static_cast<int>(x + 4 * std::cbrt(x) + 4);
  const Complex inside = m * x;
  std::vector<Complex> log_derivative(static_cast<std::size_t>(orders + std::abs(inside)) + 16);
  for (std::size_t n = log_derivative.size() - 1; n > 0; --n) {
    const Complex ratio = static_cast<double>(n) / inside;
    log_derivative[n - 1] = ratio - 1.0 / (log_derivative[n] + ratio);
  }
  double psi0 = std::cos(x), psi1 = std::sin(x), chi0 = -std::sin(x), chi1 = std::cos(x), q = 0;
  Complex back = 0;
  for (int n = 1; n <= orders; ++n) {
    const double psi = (2 * n - 1) * psi1 / x - psi0, chi = (2 * n - 1) * chi1 / x - chi0;
    const Complex xi(psi, -chi), xi1(psi1, -chi1), d = log_derivative[static_cast<std::size_t>(n)];
    const Complex e = d / m + n / x, h = m * d + n / x;
    const Complex a = (e * psi - psi1) / (e * xi - xi1), b = (h * psi - psi1) / (h * xi - xi1);
    back += (2.0 * n + 1) * (n % 2 ? -1.0 : 1.0) * (a - b);
    q += (2 * n + 1) * (a + b).real();
    psi0 = psi1, psi1 = psi, chi0 = chi1, chi1 = chi;
  }
  return {std::norm(back) / (x * x), 2 * q / (x * x)};
}

// Water at 10 deg C and 77 GHz by [liebe1991].
const std::complex<double> kWater(3.356, 1.908);
constexpr double kWavelength = 3.893;  // [mm]

TEST(Precipitation, RadarBackscatterIsThatOfMarshallPalmersDropsByMie) {
  for (const double rate : {1.0, 2.5, 5.0, 10.0, 25.0, 50.0}) {
    const SizeDistribution sizes = marshallPalmer(rate);
    double mie_sum = 0, rayleigh_sum = 0, extinction_sum = 0;
    constexpr double kStep = .04;  // [mm]
    for (double d = .5 * kStep; d < 8; d += kStep) {
      const double number = sizes.number * std::exp(-sizes.slope * d) * kStep;
      const Efficiencies q = mie(kPi * d / kWavelength, kWater);
      const double area = kPi / 4 * d * d * 1e-6;  // [m^2]
      mie_sum += q.backscatter * area * number, extinction_sum += q.extinction * area * number;
      const auto k = (kWater * kWater - 1.0) / (kWater * kWater + 2.0);
      rayleigh_sum += std::pow(kPi, 5) / std::pow(kWavelength, 4) * std::norm(k) * std::pow(d, 6) *
                      1e-6 * number;
    }
    EXPECT_NEAR(radarBackscatter(rate) / mie_sum, 1, .12) << rate;
    EXPECT_GT(rayleigh_sum / mie_sum, 3) << rate;  // drops are as large as the wavelength
    // The same sum attenuates as P.838 says, within what the drops' sizes are known to.
    EXPECT_NEAR(4343 * extinction_sum / radarAttenuation(rate), 1.1, .2) << rate;
  }
  EXPECT_EQ(radarBackscatter(0), 0);
}

}  // namespace
}  // namespace perception
