#include "libperception/measurement/CObservationMeasurements.h"

#include <fmt/format.h>

#include <ostream>

#include "libperception/measurement/CArchiveGuards.h"

namespace perception {

IMPLEMENTS_SERIALIZABLE(CObservationMeasurements, CObservation, perception)

namespace {

using mrpt::serialization::CArchive;

constexpr std::uint32_t kMostMeasurements = 100000;
constexpr std::uint32_t kMostNames = 1000;

void writeScalar(CArchive& out, const std::optional<ScalarEstimate>& s) {
  out << s.has_value();
  if (s) out << s->mean << s->variance;
}

std::optional<ScalarEstimate> readScalar(CArchive& in) {
  if (!archive::readFlag(in)) return {};
  ScalarEstimate s;
  in >> s.mean >> s.variance;
  return s;
}

void writeSides(CArchive& out, const std::optional<PartialBox>& s) {
  out << s.has_value();
  if (!s) return;
  out << s->yaw << s->yaw_sigma << s->length << s->width << s->length_complete << s->width_complete
      << s->center.x() << s->center.y();
}

std::optional<PartialBox> readSides(CArchive& in) {
  if (!archive::readFlag(in)) return {};
  PartialBox s;
  in >> s.yaw >> s.yaw_sigma >> s.length >> s.width;
  s.length_complete = archive::readFlag(in);
  s.width_complete = archive::readFlag(in);
  in >> s.center.x() >> s.center.y();
  return s;
}

void writeEvidence(CArchive& out, const Measurement& m) {
  out << m.heading.has_value();
  if (m.heading) {
    out << m.heading->yaw << m.heading->sigma << m.heading->flip_probability
        << m.heading->flip_persistence;
  }
  if (m.sides) out << m.sides->length_sigma << m.sides->width_sigma;
  out.WriteAs<std::uint32_t>(m.log_class.size());
  for (const double lp : m.log_class) out << lp;
  out << m.log_clutter;
}

void readEvidence(CArchive& in, Measurement& m, std::uint8_t version) {
  if (archive::readFlag(in)) {
    m.heading.emplace();
    in >> m.heading->yaw >> m.heading->sigma >> m.heading->flip_probability;
    if (version >= 2) in >> m.heading->flip_persistence;
  }
  if (m.sides) in >> m.sides->length_sigma >> m.sides->width_sigma;
  m.log_class.resize(archive::readCount(in, kMostNames, "classes"));
  for (double& lp : m.log_class) in >> lp;
  in >> m.log_clutter;
}

void writeMeasurement(CArchive& out, const Measurement& m) {
  out.WriteAs<std::uint8_t>(m.z.size());
  for (Eigen::Index i = 0; i < m.z.size(); ++i) out << m.z[i];
  for (Eigen::Index i = 0; i < m.z.size();
       ++i) {  // all of R, not one triangle: an asymmetric R must remain visible
    for (Eigen::Index j = 0; j < m.z.size(); ++j) out << m.R(i, j);
  }
  out << m.seen;
  out.WriteAs<std::int32_t>(m.label).WriteAs<std::int32_t>(m.detection);
  out << m.log_score_ratio << m.position.x() << m.position.y() << m.position_sigma;
  writeScalar(out, m.base_z);
  writeScalar(out, m.height);
  writeSides(out, m.sides);
  writeEvidence(out, m);
}

Measurement readMeasurement(CArchive& in, std::size_t labels, std::uint8_t version) {
  Measurement m;
  const int axes = in.ReadAs<std::uint8_t>();
  if (axes > kMaxAxes) throw std::runtime_error(fmt::format("{} axes, at most {}", axes, kMaxAxes));
  m.z.resize(axes);
  m.R.resize(axes, axes);
  for (int i = 0; i < axes; ++i) in >> m.z[i];
  for (int i = 0; i < axes; ++i) {
    for (int j = 0; j < axes; ++j) in >> m.R(i, j);
  }
  in >> m.seen;
  m.label = in.ReadAs<std::int32_t>();
  m.detection = in.ReadAs<std::int32_t>();
  if (m.label < 0 || static_cast<std::size_t>(m.label) >= std::max<std::size_t>(labels, 1)) {
    throw std::runtime_error(fmt::format("label {} of {}", m.label, labels));
  }
  in >> m.log_score_ratio >> m.position.x() >> m.position.y() >> m.position_sigma;
  m.base_z = readScalar(in);
  m.height = readScalar(in);
  m.sides = readSides(in);
  if (version >= 1) readEvidence(in, m, version);
  return m;
}

void writeNames(CArchive& out, const std::vector<std::string>& names) {
  out.WriteAs<std::uint32_t>(names.size());
  for (const auto& name : names) out << name;
}

std::vector<std::string> readNames(CArchive& in) {
  std::vector<std::string> names(archive::readCount(in, kMostNames, "names"));
  for (auto& name : names) name = archive::readText(in);
  return names;
}

}  // namespace

uint8_t CObservationMeasurements::serializeGetVersion() const { return 2; }

void CObservationMeasurements::serializeTo(CArchive& out) const {
  out << timestamp << sensorLabel << sensor_pose << model;
  out.WriteAs<std::uint8_t>(letterOf(modality));
  out << frame;
  writeNames(out, axes);
  writeNames(out, labels);
  out.WriteAs<std::uint32_t>(measurements.size());
  for (const auto& m : measurements) writeMeasurement(out, m);
}

void CObservationMeasurements::serializeFrom(CArchive& in, uint8_t version) {
  if (version > 2) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  in >> timestamp;
  sensorLabel = archive::readText(in);
  in >> sensor_pose;
  model = archive::readText(in);
  modality = static_cast<Modality>(in.ReadAs<std::uint8_t>());
  if (findModality(letterOf(modality)) == nullptr)
    throw std::runtime_error("a modality that is none of " + modalityLetters());
  in >> frame;
  axes = readNames(in);
  labels = readNames(in);
  measurements.clear();
  for (auto left = archive::readCount(in, kMostMeasurements, "measurements"); left > 0; --left) {
    measurements.push_back(readMeasurement(in, labels.size(), version));
  }
}

void CObservationMeasurements::getDescriptionAsText(std::ostream& out) const {
  CObservation::getDescriptionAsText(out);
  out << fmt::format("Measurements of model {}, modality {}, frame {}: {}\n", model,
                     letterOf(modality), frame, measurements.size());
  for (const auto& m : measurements) {
    const auto label = static_cast<std::size_t>(m.label);
    out << fmt::format("  {}", label < labels.size() ? labels[label] : "-");
    for (Eigen::Index i = 0; i < m.z.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const std::string axis = k < axes.size() ? axes[k] : fmt::format("z{}", i);
      if (m.seen >> i & 1) {
        out << fmt::format("  {} {:.4f} +- {:.4f}", axis, m.z[i], std::sqrt(m.R(i, i)));
      } else {
        out << fmt::format("  {} not seen", axis);
      }
    }
    out << '\n';
  }
}

std::string CObservationMeasurements::exportTxtHeader() const {
  return "frame model count [label seen z... sigma_z... x y]*";
}

std::string CObservationMeasurements::exportTxtDataRow() const {
  std::string row =
      fmt::format("{} {} {}", frame, model.empty() ? "-" : model, measurements.size());
  for (const auto& m : measurements) {
    row += fmt::format(" {} {}", m.label, m.seen);
    for (Eigen::Index i = 0; i < m.z.size(); ++i) row += fmt::format(" {:.6f}", m.z[i]);
    for (Eigen::Index i = 0; i < m.z.size(); ++i)
      row += fmt::format(" {:.6f}", std::sqrt(m.R(i, i)));
    row += fmt::format(" {:.3f} {:.3f}", m.position.x(), m.position.y());
  }
  return row;
}

}  // namespace perception
