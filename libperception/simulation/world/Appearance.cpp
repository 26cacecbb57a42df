#include "libperception/simulation/world/Appearance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/Texture.h"

namespace perception {
namespace {

// All colors and details are assumed.
const std::array<Rgb, 10> kCoach = {Rgb(.72, .72, .70), Rgb(.40, .41, .43), Rgb(.045, .045, .05),
                                    Rgb(.16, .17, .19), Rgb(.04, .10, .32), Rgb(.45, .03, .03),
                                    Rgb(.70, .70, .72), Rgb(.03, .16, .12), Rgb(.10, .24, .42),
                                    Rgb(.42, .34, .22)};
const std::array<Rgb, 4> kBuses = {Rgb(.62, .06, .05), Rgb(.65, .50, .06), Rgb(.05, .22, .45),
                                   Rgb(.10, .38, .16)};
const std::array<Rgb, 9> kShirts = {Rgb(.60, .08, .07), Rgb(.08, .16, .45), Rgb(.70, .68, .62),
                                    Rgb(.07, .07, .08), Rgb(.62, .45, .06), Rgb(.10, .34, .14),
                                    Rgb(.30, .31, .33), Rgb(.45, .12, .34), Rgb(.06, .35, .42)};
const std::array<Rgb, 4> kTrousers = {Rgb(.035, .05, .12), Rgb(.03, .03, .035), Rgb(.20, .16, .10),
                                      Rgb(.10, .10, .11)};
const std::array<Rgb, 4> kHair = {Rgb(.02, .015, .01), Rgb(.09, .05, .02), Rgb(.30, .22, .10),
                                  Rgb(.25, .25, .25)};
const std::array<Rgb, 6> kPlaster = {Rgb(.58, .52, .40), Rgb(.60, .58, .54), Rgb(.42, .20, .13),
                                     Rgb(.62, .48, .27), Rgb(.40, .44, .46), Rgb(.56, .38, .30)};

constexpr double kHouse = 4;     // [m] least height
constexpr double kGlossy = .05;  // mirrored by paint and glass at normal incidence

template <std::size_t N>
const Rgb& pick(const std::array<Rgb, N>& colors, std::uint32_t hash) {
  return colors[hash % N];
}

double detail(double size, double pixel) { return std::clamp(2 - 2 * pixel / size, 0.0, 1.0); }

bool isVehicle(ObjectKind kind) {
  return kind == ObjectKind::kCar || kind == ObjectKind::kVan || kind == ObjectKind::kBus;
}

// Distance from the nearest axle / wheel radius: distinguishes wheels from the body, which is flush
// with them.
double fromAxle(const ObjectParams& o, const Vector3& p, const Vector3& normal) {
  if (!isVehicle(o.kind) || std::abs(normal.y()) < .9) return 10;
  const Wheels wheels = wheelsOf(o);
  const double x = std::min(std::abs(p.x() - wheels.front), std::abs(p.x() - wheels.rear));
  return std::hypot(x, p.z() - wheels.radius) / wheels.radius;
}

Finish wheel(double from_axle) {
  constexpr double kHub = .15, kRim = .62;  // of the wheel's radius
  if (from_axle < kRim) return {Rgb::Constant(from_axle < kHub ? .10 : .34), 0};
  return {Rgb::Constant(.025), 0};
}

// Wheels, lamps, number plates and the dark skirt of a vehicle's body.
Finish coachwork(const ObjectParams& o, const Vector3& p, const Vector3& normal) {
  constexpr double kArch = 1.12;  // of the wheel's radius
  const double from_axle = fromAxle(o, p, normal);
  if (from_axle < kArch) return wheel(from_axle);
  const double h = p.z() / o.height, across = std::abs(p.y()) / o.width;
  const bool end = std::abs(normal.x()) > .7, bus = o.kind == ObjectKind::kBus;
  if (h < (bus ? .14 : .21)) return {Rgb::Constant(.03), 0};
  if (!end) return {bodyColor(o), kGlossy};
  const double lamps = bus ? .20 : .33, top = bus ? .28 : .47;
  if (across > .30 && h > lamps && h < top) {
    if (normal.x() > 0) return {{.80, .80, .76}, kGlossy};
    return {{.55, .02, .02}, kGlossy};
  }
  if (across < .15 && h > .25 && h < .33) return {{.65, .65, .60}, 0};
  return {bodyColor(o), kGlossy};
}

// Trousers to the hip, shoes; hands are not drawn separately.
Finish clothes(const ObjectParams& o, const Vector3& p) {
  const std::uint32_t hash = hashOf(o.name);
  const double h = p.z() / o.height, hip = o.kind == ObjectKind::kCyclist ? .54 : .51;
  const bool arm = o.kind == ObjectKind::kPedestrian && std::abs(p.y()) > .36 * o.width;
  if (h < .05) return {Rgb::Constant(.03), 0};
  if (h < hip && !arm) return {pick(kTrousers, hash >> 8), 0};
  return {bodyColor(o), 0};
}

Finish head(const ObjectParams& o, const Vector3& p) {
  const std::uint32_t hash = hashOf(o.name);
  const bool hair = p.z() > .955 * o.height || (p.z() > .91 * o.height && p.x() < -.01);
  if (hair && o.kind == ObjectKind::kCyclist) return {{.75, .74, .70}, 0};  // a helmet
  if (hair) return {pick(kHair, hash >> 12), 0};
  return {Rgb(.50, .30, .21) * (.45 + .75 * cellValue(hash, 0, 7)), 0};
}

// A front of windows, story by story; u [m] along the wall, `width` its length.
Finish facade(const ObjectParams& o, double u, double z, double width) {
  constexpr double kStory = 3, kAxis = 2.9;  // [m] about: whole numbers of them fit the wall
  const double stories = std::max(1.0, std::round(o.height / kStory));
  const double axes = std::max(1.0, std::floor(width / kAxis));
  const double x = (u / width + .5) * axes, y = z / o.height * stories;
  const double i = std::floor(x), j = std::floor(y);
  const double du = x - i, dv = y - j;
  const Rgb plaster = bodyColor(o);
  if (z < .5) return {plaster * .55, 0};
  if (o.height - z < .25) return {plaster * .75, 0};
  const bool door = j < 1 && static_cast<int>(i) % 4 == 1;
  const double low = door ? 0 : .32, high = .80, side = door ? .34 : .28;
  if (du < side || du > 1 - side || dv < low || dv > high) return {plaster, 0};
  constexpr double kFrame = .045;
  const bool frame = du < side + kFrame || du > 1 - side - kFrame || dv < low + kFrame ||
                     dv > high - kFrame || (!door && std::abs(du - .5) < .015);
  if (frame) return {{.62, .62, .60}, 0};
  if (door) return {{.12, .07, .04}, 0};
  const double curtain =
      cellValue(static_cast<std::int64_t>(i), static_cast<std::int64_t>(j), hashOf(o.name));
  return {Rgb(.04, .05, .06) + (curtain > .6 ? .22 : 0.0) * Rgb(.9, .85, .75), 2 * kGlossy};
}

Finish wall(const ObjectParams& o, const Vector3& p, const Vector3& normal, double pixel) {
  if (normal.z() > .7) return {isHouse(o) ? Rgb(.16, .09, .07) : bodyColor(o) * .8, 0};
  const bool along_x = std::abs(normal.y()) > std::abs(normal.x());
  const double u = along_x ? p.x() : p.y(), width = along_x ? o.length : o.width;
  if (isHouse(o)) return facade(o, u, p.z(), width);
  constexpr double kCourse = .22, kBlock = .5;  // [m]
  const double row = std::floor(p.z() / kCourse);
  const double column = std::floor(u / kBlock + .5 * (static_cast<std::int64_t>(row) & 1));
  const double tone =
      cellValue(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row), hashOf(o.name)) -
      .5;
  return {bodyColor(o) * (1 + .35 * detail(kCourse, pixel) * tone), 0};
}

Finish leaf(const ObjectParams& o, const Vector3& p, double pixel) {
  const double tone = smoothValue(6 * (p.x() + p.z()), 6 * (p.y() - p.z()), hashOf(o.name)) - .5;
  return {bodyColor(o) * (1 + .9 * detail(.3, pixel) * tone), 0};
}

}  // namespace

bool isHouse(const ObjectParams& object) {
  return object.kind == ObjectKind::kBox && object.height >= kHouse;
}

Rgb bodyColor(const ObjectParams& o) {
  const std::uint32_t hash = hashOf(o.name);
  switch (o.kind) {
    case ObjectKind::kCar:
    case ObjectKind::kVan:
      return pick(kCoach, hash) * std::min(1.0, o.reflectivity);
    case ObjectKind::kBus:
      return pick(kBuses, hash) * std::min(1.0, o.reflectivity);
    case ObjectKind::kPedestrian:
    case ObjectKind::kCyclist:
      return pick(kShirts, hash);
    case ObjectKind::kPole:
      return Rgb::Constant(.22 + .12 * cellValue(hash, 1, 7));
    case ObjectKind::kBox:
      return pick(kPlaster, hash);
    case ObjectKind::kBush:
      return Rgb(.07, .15, .035) + cellValue(hash, 2, 7) * Rgb(.06, .03, .01);
  }
  return Rgb::Constant(.3);
}

Finish finishOf(const ObjectParams& o, Material material, const Vector3& place,
                const Vector3& normal, double pixel) {
  switch (material) {
    case Material::kPaint:
      return coachwork(o, place, normal);
    case Material::kGlass:
      return {Rgb::Constant(.02), 2 * kGlossy};
    case Material::kTire:
      return wheel(fromAxle(o, place, normal));
    case Material::kCloth:
      return clothes(o, place);
    case Material::kSkin:
      return head(o, place);
    case Material::kWall:
      return wall(o, place, normal, pixel);
    case Material::kLeaf:
      return leaf(o, place, pixel);
    case Material::kMetal:
    case Material::kRoad:
    case Material::kGrass:
      break;
  }
  return {o.kind == ObjectKind::kPole ? bodyColor(o) : Rgb::Constant(.12), 0};
}

}  // namespace perception
