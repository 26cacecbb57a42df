#include "libperception/scene/ClassColors.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace perception {
namespace {

using namespace okabe_ito;

struct ClassColor {
  const char* name;
  Color color;
};

constexpr ClassColor kByName[] = {{"pedestrian", kVermilion},
                                  {"cyclist", kGreen},
                                  {"car", kBlue},
                                  {"bus", kPurple},
                                  {"static-other", {115, 115, 115}}};
constexpr Color kOthers[] = {kOrange, kSky, kBlack};
constexpr Color kCurves[] = {kBlue,   kVermilion, kGreen,        kPurple,
                             kOrange, kSky,       {139, 69, 19}, kBlack};

}  // namespace

Color colorOfClass(const std::string& name, int place) {
  for (const ClassColor& row : kByName) {
    if (name == row.name) return row.color;
  }
  return kOthers[static_cast<std::size_t>(std::max(0, place)) % std::size(kOthers)];
}

bool isMuted(const std::string& class_name) { return class_name == "static-other"; }

Color colorOfCurve(std::size_t i) { return kCurves[i % std::size(kCurves)]; }

std::string hexOf(const Color& color) {
  return fmt::format("#{:02X}{:02X}{:02X}", color.r, color.g, color.b);
}

}  // namespace perception
