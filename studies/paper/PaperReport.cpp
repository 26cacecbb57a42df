#include "studies/paper/PaperReport.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/evaluation/tables/PaperTables.h"

namespace perception {
namespace {

using Row = std::vector<std::string>;
using Of = std::function<Figure(const Evaluation&)>;
using Parts = std::vector<const Evaluation*>;

/// Which encounters a row pools.
struct Selection {
  std::string run;      ///< sensor set or particlesName()
  std::string weather;  ///< its table; empty: all
  std::string kind;     ///< class of the truth; empty: all

  bool takes(const PaperOutcome& o, int trial) const {
    return o.runs.count(run) && (weather.empty() || weather == o.of.weather.table) &&
           (trial == 0 || trial == o.of.trial);
  }
};

Parts partsOf(const std::vector<PaperOutcome>& outcomes, const Selection& s, int trial = 0) {
  Parts parts;
  for (const PaperOutcome& o : outcomes)
    if (s.takes(o, trial)) parts.push_back(&o.runs.at(s.run));
  return parts;
}

ClassId classNamed(const Evaluation& e, const std::string& name) {
  for (std::size_t c = 0; c < e.class_names.size(); ++c)
    if (e.class_names[c] == name) return static_cast<ClassId>(c);
  return -1;
}

/// A figure of all encounters of a row, and its standard deviation over the trials, each pooled.
class Pool {
 public:
  Pool(const std::vector<PaperOutcome>& outcomes, Selection selection)
      : selection_(std::move(selection)) {
    const Parts parts = partsOf(outcomes, selection_);
    if (parts.empty()) return;
    all_ = pooled(parts);
    std::set<int> trials;
    for (const PaperOutcome& o : outcomes)
      if (selection_.takes(o, 0)) trials.insert(o.of.trial);
    for (const int t : trials) trials_.push_back(pooled(partsOf(outcomes, selection_, t)));
  }

  TrackingFigures figures(const Evaluation& e) const {
    const ClassId c = selection_.kind.empty() ? -1 : classNamed(e, selection_.kind);
    return trackingFigures(e, Pairing::kClosest, c);
  }
  Figure mean(Figure TrackingFigures::*member) const {
    return all_ ? figures(*all_).*member : Figure();
  }
  std::string text(Figure TrackingFigures::*member, int places = 3) const {
    return text([&](const Evaluation& e) { return figures(e).*member; }, places);
  }
  std::string text(const Of& of, int places) const {
    if (!all_) return "";
    const Figure whole = of(*all_);
    if (!whole) return "n/a";
    std::vector<double> values;
    for (const Evaluation& e : trials_)
      if (const Figure f = of(e)) values.push_back(*f);
    std::string text = fmt::format("{:.{}f}", *whole, places);
    if (values.size() < 2) return text;
    double mean = 0, square = 0;
    const auto n = static_cast<double>(values.size());
    for (const double v : values) mean += v / n;
    for (const double v : values) square += (v - mean) * (v - mean) / (n - 1);
    return text + fmt::format(" ± {:.{}f}", std::sqrt(square), places);
  }
  std::string returns() const {
    return all_ ? fmt::format("{}", figures(*all_).returns) : std::string();
  }

 private:
  Selection selection_;
  std::optional<Evaluation> all_;
  std::vector<Evaluation> trials_;
};

const PaperTrackingRow* published(const std::string& table, const std::string& sensors,
                                  const std::string& condition = "") {
  for (const PaperTrackingRow& row : paperTrackingRows()) {
    if (row.table == table && row.sensors == sensors &&
        (condition.empty() || row.condition == condition))
      return &row;
  }
  return nullptr;
}

StudyTable trackingTable(const char* name, const char* title, const char* first) {
  return {name,
          title,
          {first, "sensors", "tracked", "paper: tracked", "range error [m]", "paper: range",
           "bearing error [rad]", "paper: bearing", "correct class", "paper: correct",
           "wrong class", "paper: wrong", "returns", "paper: returns"},
          {}};
}

void addTracking(const std::vector<PaperOutcome>& outcomes, const Selection& selection,
                 const std::string& label, const std::string& sensors,
                 const PaperTrackingRow* paper, StudyTable& table) {
  const Pool pool(outcomes, selection);
  const auto theirs = [&](double PaperTrackingRow::*member) {
    return paper ? fmt::format("{:.3f}", paper->*member) : std::string();
  };
  table.rows.push_back({label, sensors, pool.text(&TrackingFigures::tracked_a),
                        theirs(&PaperTrackingRow::tracked), pool.text(&TrackingFigures::range_rms),
                        theirs(&PaperTrackingRow::range), pool.text(&TrackingFigures::bearing_rms),
                        theirs(&PaperTrackingRow::bearing), pool.text(&TrackingFigures::correct),
                        theirs(&PaperTrackingRow::correct), pool.text(&TrackingFigures::mis),
                        theirs(&PaperTrackingRow::mis), pool.returns(),
                        paper ? fmt::format("{}", paper->returns) : ""});
}

StudyTable sensorsTable(const std::vector<PaperOutcome>& outcomes) {
  StudyTable table = trackingTable(
      "sensors", "By sensor set, simulated, all weathers of this run pooled", "object");
  for (const auto& [label, kind, paper] :
       {std::array<const char*, 3>{"Pedestrian", "pedestrian", "pedestrian"},
        std::array<const char*, 3>{"Vehicle", "car", "vehicle"},
        std::array<const char*, 3>{"both", "", ""}}) {
    for (const char* set : kPaperSets)
      addTracking(outcomes, {set, "", kind}, label, set, published(paper, set), table);
  }
  return table;
}

StudyTable weatherTable(const std::vector<PaperOutcome>& outcomes) {
  StudyTable table = trackingTable("weather", "By weather, simulated", "weather");
  for (const char* set : kPaperSets) {
    for (const PaperWeather& w : paperWeathers()) {
      if (*w.table)
        addTracking(outcomes, {set, w.table, ""}, w.title, set, published(w.table, set), table);
    }
  }
  return table;
}

StudyTable particlesTable(const std::vector<PaperOutcome>& outcomes) {
  StudyTable table = trackingTable("particles", "By particles, Sunny, simulated", "particles");
  for (const int n : {1, 4, 8}) {
    const std::string name = n == 8 ? "C+L+R" : particlesName(n);  // the INI's own number
    addTracking(outcomes, {name, "sunny", ""}, fmt::format("{}", n), "C+L+R",
                published("particles", "C+L+R", particlesName(n)), table);
  }
  return table;
}

StudyTable beyondTable(const std::vector<PaperOutcome>& outcomes) {
  StudyTable table = {
      "beyond",
      "What the paper's tables do not say, simulated: tracked over the instants "
      "within the sensor set's range (B) and from first to last return (C)",
      {"weather", "sensors", "tracked B", "tracked C", "position [m]", "velocity [m/s]",
       "headings reversed", "false objects an instant", "GOSPA [m]"},
      {}};
  for (const char* set : kPaperSets) {
    for (const PaperWeather& w : paperWeathers()) {
      if (!*w.table) continue;
      const Pool pool(outcomes, {set, w.table, ""});
      table.rows.push_back(
          {w.title, set, pool.text(&TrackingFigures::tracked_b),
           pool.text(&TrackingFigures::tracked_c), pool.text(&TrackingFigures::position_rms, 2),
           pool.text(&TrackingFigures::velocity_rms, 2),
           pool.text(&TrackingFigures::heading_reversed),
           pool.text([](const Evaluation& e) { return falseObjectFigures(e).per_instant; }, 2),
           pool.text([](const Evaluation& e) { return setFigures(e, 2).gospa_mean; }, 2)});
    }
  }
  return table;
}

std::string percent(std::size_t part, std::size_t whole) {
  if (whole == 0) return "n/a";
  return fmt::format("{:.0f} %", 100 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.0f} %", 100 * *share) : std::string();
}

/// Recall by class, precision by the labels that name it.
void addRates(const std::optional<FrontEndEvaluation>& found, const std::string& kind,
              const std::vector<std::string>& labels, std::string& recall, std::string& precision) {
  if (!found) return;
  const RecallCounts r = found->recall({kind}, false);
  recall = percent(r.named_primary, r.in_view);
  PrecisionCounts p;
  for (const std::string& label : labels) p += found->precision(label);
  precision = percent(p.right_class, p.measurements);
}

StudyTable ratesTable(const std::vector<PaperOutcome>& outcomes) {
  StudyTable table = {"rates",
                      "Recall over the sensor's range, and precision, simulated",
                      {"sensor", "weather", "car recall", "paper: car recall", "car precision",
                       "paper: car precision", "person recall", "paper: person recall",
                       "person precision", "paper: person precision"},
                      {}};
  for (const char* sensor : {"Lidar", "Camera"}) {
    for (const PaperWeather& w : paperWeathers()) {
      if (!*w.table && std::string(sensor) == "Lidar") continue;
      std::optional<FrontEndEvaluation> found;
      for (const PaperOutcome& o : outcomes) {
        const auto own = o.front_ends.find(sensor);
        if (o.of.weather.name != std::string(w.name) || own == o.front_ends.end()) continue;
        if (found) {
          *found += own->second;
        } else {
          found = own->second;
        }
      }
      Row row(10);
      row[0] = sensor, row[1] = w.title;
      addRates(found, "car", {"car_sized", "car"}, row[2], row[4]);
      addRates(found, "pedestrian", {"person_sized", "person"}, row[6], row[8]);
      for (const PaperFrontEndRow& p : paperFrontEndRows()) {
        if (p.sensor != row[0] || p.condition != row[1]) continue;
        row[3] = percent(p.car_recall), row[5] = percent(p.car_precision);
        row[7] = percent(p.person_recall), row[9] = percent(p.person_precision);
      }
      table.rows.push_back(row);
    }
  }
  return table;
}

}  // namespace

std::vector<StudyTable> paperTables(const std::vector<PaperOutcome>& outcomes) {
  return {sensorsTable(outcomes), weatherTable(outcomes), particlesTable(outcomes),
          ratesTable(outcomes), beyondTable(outcomes)};
}

}  // namespace perception
