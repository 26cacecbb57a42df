#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace perception {

/// Kind of sensor, by its letter: any letter of modalities(). Three of them have a name here.
enum class Modality : char { kCamera = 'C', kLidar = 'L', kRadar = 'R' };

inline char letterOf(Modality m) { return static_cast<char>(m); }

/// What the program knows of a modality besides its front end and its measurement model.
struct ModalityRow {
  Modality letter = Modality::kLidar;
  std::string name;  ///< in [detection.NAME.CLASS] and messages
  /// Its point clouds give the ground plane.
  bool gives_ground = false;
  /// It places objects to within their size and sees all of the sector that is evaluated; without
  /// such a sensor ranges are those of the camera (method.md 11).
  bool covers_sector = false;
  /// LETTER/H in a sensor set: its headings enter as one wide Gaussian, a baseline of
  /// [radecki2016].
  bool wide_headings = false;
  int output_rank = 0;    ///< scenes come at scans of the sensor in use with the largest, the first
                          ///< of these
  int mark_corners = 12;  ///< of its measurements' marks in pictures
};

/// At most so many rows: tracks hold one entry for each.
constexpr std::size_t kMostModalities = 8;

/// The table, in the order of the columns last_hit_* of tracks.csv: camera, lidar, radar and what
/// was added.
const std::vector<ModalityRow>& modalities();
/// Adds a row: before a configuration is read, from one thread. A second row of the same letter
/// changes the first one. Throws std::length_error beyond kMostModalities.
void addModality(const ModalityRow& row);

/// Null where no row has the letter.
const ModalityRow* findModality(char letter);
/// The row of a modality; throws std::out_of_range where there is none.
const ModalityRow& rowOf(Modality m);
/// Its place in the table, as rowOf().
std::size_t modalityIndex(Modality m);
/// "C, L, R": for messages.
std::string modalityLetters();

}  // namespace perception
