#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace perception {

/// Kind of sensor, by its letter: any letter of modalities(), the shipped ones with a name.
enum class Modality : char { kCamera = 'C', kLidar = 'L', kRadar = 'R' };

inline char letterOf(Modality m) { return static_cast<char>(m); }

/// Properties of a modality besides its front end and measurement model.
struct ModalityRow {
  Modality letter = Modality::kLidar;
  std::string name;  ///< in [detection.NAME.CLASS] and messages
  /// Its point clouds are used to estimate the ground plane.
  bool gives_ground = false;
  /// It locates objects to within their size and covers the whole evaluated sector; without such a
  /// sensor the ranges of a camera apply (method.md 11).
  bool covers_sector = false;
  /// LETTER/H in a sensor set: its headings enter as one wide Gaussian, a baseline of
  /// [radecki2016].
  bool wide_headings = false;
  int output_rank = 0;    ///< default output sensor: the first one in use with the largest rank
  int mark_corners = 12;  ///< number of corners of its marks in pictures
};

/// Largest number of rows: every track holds an entry for each.
constexpr std::size_t kMostModalities = 8;

/// The table, in the order of the columns last_hit_* of tracks.csv: camera, lidar, radar, then the
/// added ones.
const std::vector<ModalityRow>& modalities();
/// Adds a row, or replaces that of the same letter. Not thread-safe; call it before a configuration
/// is read. Throws std::length_error beyond kMostModalities.
void addModality(const ModalityRow& row);

/// Null where no row has the letter.
const ModalityRow* findModality(char letter);
/// The row of a modality; throws std::out_of_range where there is none.
const ModalityRow& rowOf(Modality m);
/// Its index in the table; throws like rowOf().
std::size_t modalityIndex(Modality m);
/// "C, L, R": for messages.
std::string modalityLetters();

}  // namespace perception
