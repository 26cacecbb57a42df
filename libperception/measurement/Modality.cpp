#include "libperception/measurement/Modality.h"

#include <algorithm>
#include <stdexcept>

namespace perception {
namespace {

std::vector<ModalityRow>& table() {
  static std::vector<ModalityRow> rows = [] {
    ModalityRow camera{Modality::kCamera, "camera"};
    camera.wide_headings = true;
    camera.mark_corners = 3;
    ModalityRow lidar{Modality::kLidar, "lidar"};
    lidar.gives_ground = lidar.covers_sector = true;
    lidar.output_rank = 1;
    ModalityRow radar{Modality::kRadar, "radar"};
    radar.mark_corners = 4;
    return std::vector<ModalityRow>{camera, lidar, radar};
  }();
  return rows;
}

}  // namespace

const std::vector<ModalityRow>& modalities() { return table(); }

void addModality(const ModalityRow& row) {
  auto& rows = table();
  const auto same = std::find_if(rows.begin(), rows.end(),
                                 [&](const ModalityRow& r) { return r.letter == row.letter; });
  if (same != rows.end()) {
    *same = row;
    return;
  }
  if (rows.size() == kMostModalities) throw std::length_error("too many modalities");
  rows.push_back(row);
}

const ModalityRow* findModality(char letter) {
  for (const ModalityRow& row : table()) {
    if (letterOf(row.letter) == letter) return &row;
  }
  return nullptr;
}

const ModalityRow& rowOf(Modality m) { return table()[modalityIndex(m)]; }

std::size_t modalityIndex(Modality m) {
  const auto& rows = table();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].letter == m) return i;
  }
  throw std::out_of_range(std::string("no modality has the letter ") + letterOf(m));
}

std::string modalityLetters() {
  std::string letters;
  for (const ModalityRow& row : table())
    letters += (letters.empty() ? "" : ", ") + std::string(1, letterOf(row.letter));
  return letters;
}

}  // namespace perception
