#include "libperception/evaluation/tables/ReportCells.h"

#include <fmt/format.h>

#include "libperception/scene/files/NumberFormat.h"

namespace perception {

ReportTable makeTable(std::string title, Row labels, const Row& numbers) {
  ReportTable table;
  table.title = std::move(title);
  table.labels = labels.size();
  table.header = std::move(labels);
  table.header.insert(table.header.end(), numbers.begin(), numbers.end());
  return table;
}

std::string number(const Figure& figure, int places) {
  return figure ? fixedPlaces(*figure, places) : kNotAvailable;
}

std::string countOf(std::size_t count, bool known) {
  return known ? fmt::format("{}", count) : kNotAvailable;
}

const char* nameOf(Pairing pairing) {
  return pairing == Pairing::kClosest ? "closest" : "one-to-one";
}

std::string className(const Evaluation& evaluation, ClassId c) {
  return c < 0 ? "all" : evaluation.class_names[static_cast<std::size_t>(c)];
}

}  // namespace perception
