#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui-offscreen/drawing/Palette.h"
#include "libperception/pictures/ScenarioDrawing.h"
#include "libperception/pictures/ScenarioPictures.h"

namespace perception {
namespace {

constexpr Color kLidarColor{0, 114, 178}, kCameraColor{230, 159, 0}, kRadarColor{0, 158, 115};

/// One sector that a sensor sees.
struct Wedge {
  double range;       ///< [m]
  std::string label;  ///< what holds within; "": the sensor's whole view
};

struct Coverage {
  const SensorParams* sensor;
  double fov;                 ///< [rad]
  std::vector<Wedge> wedges;  ///< the widest first
};

Coverage coverageOf(const SensorParams& s) {
  switch (s.kind) {
    case SensorKind::kRadar:
      return {&s, s.radar.fov, {{s.radar.range_max, ""}}};
    case SensorKind::kSphericalCamera:
      return {&s, kTwoPi, {{s.panorama.car_range, "cars"}, {s.panorama.person_range, "persons"}}};
    case SensorKind::kCameraBoxes: {
      const double f = s.camera.model().fy;  // [px] heights of a car and of a person at full recall
      return {
          &s,
          s.camera.fov,
          {{1.7 * f / s.camera.full_pixels, "persons"}, {1.5 * f / s.camera.full_pixels, "cars"}}};
    }
    default:
      return {&s, s.lidar.azimuth_to - s.lidar.azimuth_from, {{s.lidar.range_max, ""}}};
  }
}

std::vector<Vector2> sector(const SensorParams& s, double fov, double range) {
  const Vector2 apex(s.x, s.y);
  std::vector<Vector2> corners;
  const int steps = std::max(2, static_cast<int>(std::ceil(fov / radians(3))));
  if (fov < kTwoPi - 1e-6) corners.push_back(apex);
  for (int i = 0; i <= steps; ++i) {
    const double a = s.yaw - .5 * fov + fov * i / steps;
    corners.push_back(apex + range * Vector2(std::cos(a), std::sin(a)));
  }
  return corners;
}

std::string detailOf(const Coverage& c) {
  std::string ranges;
  for (const Wedge& w : c.wedges) {
    if (!ranges.empty()) ranges += ", ";
    ranges += fmt::format("{}{}{:.0f} m", w.label, w.label.empty() ? "" : " to ", w.range);
  }
  const std::string view =
      c.fov > kTwoPi - 1e-6
          ? "all around"
          : fmt::format("{:.0f} deg at {:.0f} deg", degrees(c.fov), degrees(c.sensor->yaw));
  return fmt::format("{}: {}, {}, {:g} Hz", c.sensor->label, view, ranges, c.sensor->rate);
}

double niceStep(double range) {
  for (const double step : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    if (range / step <= 4.5) return step;
  }
  return 200;
}

void drawRings(Canvas& canvas, const Scale& scale, double reach) {
  const double step = niceStep(reach);
  for (double r = step; r <= reach; r += step) {
    SensorParams center;
    center.x = center.y = 0;
    const auto ring = sector(center, kTwoPi, r);
    for (std::size_t i = 0; i + 1 < ring.size(); i += 2) {
      canvas.line(scale(ring[i]), scale(ring[i + 1]), kGridLine, 1);
    }
    const Vector2 at = scale({0, -r});
    canvas.text({at.x() + 3, at.y() - 3}, fmt::format("{:g} m", r), 9, kMutedInk);
  }
}

void drawOwnCar(Canvas& canvas, const Scale& scale) {
  const Vector2 middle = scale({1.3, 0});
  if (scale.pixels * 5 > 12) {
    drawPolygon(canvas, scale, footprint({0, 0}, 0, kEgoFront, kEgoRear, kEgoWidth), kEgo);
  } else {  // too small to scale: a symbol
    canvas.polygon({{middle.x() + 9, middle.y()},
                    {middle.x() - 6, middle.y() - 5},
                    {middle.x() - 6, middle.y() + 5}},
                   kEgo);
  }
}

/// Names and ranges of a sensor's sectors.
void nameWedges(Canvas& canvas, const Scale& scale, const Coverage& c) {
  const bool whole = c.fov > kTwoPi - 1e-6;
  for (std::size_t k = 0; k < c.wedges.size(); ++k) {
    // Whole circles carry their names apart from each other; wedges near their far end.
    const auto place = static_cast<double>(k);
    const double middle = .5 * static_cast<double>(c.wedges.size() - 1);
    const double a =
        whole ? radians(135 - 30 * place) : c.sensor->yaw + .45 * c.fov * (middle - place);
    const double r = c.wedges[k].range * (whole ? .86 : .72);
    const Vector2 p =
        scale(Vector2(c.sensor->x, c.sensor->y) + r * Vector2(std::cos(a), std::sin(a)));
    const std::string& name = c.wedges[k].label;
    const std::string text =
        fmt::format("{} {:.0f} m", name.empty() ? c.sensor->label : name, c.wedges[k].range);
    const double width = Canvas::textWidth(text, 10, true);
    canvas.rectangle({p.x() - .5 * width - 2, p.y() - 9, width + 4, 13}, kPaper.withAlpha(.75));
    canvas.text({p.x() - .5 * width, p.y() + 1}, text, 10, kInk, true);
  }
}

/// [m] how far the farthest sector reaches along x or y.
double reachOf(const std::vector<Coverage>& sensors) {
  double reach = 5;
  for (const Coverage& c : sensors) {
    for (const Wedge& w : c.wedges) {
      for (const Vector2& p : sector(*c.sensor, c.fov, w.range)) {
        reach = std::max({reach, std::abs(p.x()), std::abs(p.y())});
      }
    }
  }
  return reach;
}

void drawCoverage(Canvas& canvas, const Rect& area, const std::vector<Coverage>& sensors,
                  const Color& color) {
  const double reach = reachOf(sensors);
  Scale scale;
  scale.at = {area.x + .5 * area.width, area.y + .5 * area.height};
  scale.pixels = .46 * std::min(area.width, area.height) / reach;
  canvas.clip(area);
  for (const Coverage& c : sensors) {
    for (const Wedge& w : c.wedges) {
      drawPolygon(canvas, scale, sector(*c.sensor, c.fov, w.range), color.withAlpha(.22));
    }
  }
  for (const Coverage& c : sensors) {
    for (const Wedge& w : c.wedges) {
      drawOutline(canvas, scale, sector(*c.sensor, c.fov, w.range), color, 1.2);
    }
  }
  drawRings(canvas, scale, reach);
  drawOwnCar(canvas, scale);
  for (const Coverage& c : sensors) nameWedges(canvas, scale, c);
  canvas.unclip();
}

}  // namespace

Picture coveragePicture(const std::vector<SensorParams>& sensors, const std::string& title) {
  struct Panel {
    const char* name;
    Color color;
    std::vector<Coverage> sensors;
  };
  std::vector<Panel> panels = {
      {"Lidar", kLidarColor, {}}, {"Camera", kCameraColor, {}}, {"Radar", kRadarColor, {}}};
  for (const SensorParams& s : sensors) {
    if (s.isOfEgo() || s.kind == SensorKind::kCameraImages) continue;  // images find nothing
    panels[s.isLidar() ? 0 : s.isCamera() ? 1 : 2].sensors.push_back(coverageOf(s));
  }
  panels.erase(std::remove_if(panels.begin(), panels.end(),
                              [](const Panel& p) { return p.sensors.empty(); }),
               panels.end());
  std::size_t lines = 0;
  for (const Panel& p : panels) lines = std::max(lines, p.sensors.size());
  constexpr int kSide = 480, kGap = 12, kTop = 64, kLine = 15;
  const int width = static_cast<int>(panels.size()) * (kSide + kGap) + kGap;
  Canvas canvas(width, kTop + kSide + 20 + kLine * static_cast<int>(lines));
  canvas.text({kGap, 24}, title, 15, kInk, true);
  double x = kGap;
  for (const Panel& panel : panels) {
    canvas.text({x, kTop - 8}, panel.name, 13, panel.color, true);
    canvas.text({x + 90, kTop - 8}, "seen from above, vehicle faces right", 10, kMutedInk);
    drawCoverage(canvas, {x, kTop, kSide, kSide}, panel.sensors, panel.color);
    double y = kTop + kSide + 16;
    for (const Coverage& c : panel.sensors) {
      const std::string text = detailOf(c);
      const double shrink = std::min(1.0, kSide / Canvas::textWidth(text, 10));
      canvas.text({x, y}, text, 10 * shrink, kInk);
      y += kLine;
    }
    x += kSide + kGap;
  }
  return canvas.picture();
}

}  // namespace perception
