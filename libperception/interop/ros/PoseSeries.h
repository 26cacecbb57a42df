#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"

namespace perception {

class PoseFile;

/// Poses of one frame over a drive of any length. The last thousand are in memory, those before in
/// a file without a name in the folder of temporary files, which is gone with this.
class PoseSeries {
 public:
  struct Row {
    Stamp stamp;
    Pose3 pose = Pose3::Identity();
  };

  PoseSeries();
  PoseSeries(PoseSeries&&) noexcept;
  PoseSeries& operator=(PoseSeries&&) noexcept;
  ~PoseSeries();

  /// Stamps in any order. Throws OutputError: no space for the file.
  void add(Stamp stamp, const Pose3& pose);
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// In the order in which they were added, or that of sort().
  Row row(std::size_t i) const;
  /// Puts the rows in the order of their stamps. Of equal stamps all stay in the order in which
  /// they came, or, with `last_only`, the last one.
  void sort(bool last_only = false);
  /// Forgets the rows outside of [first, last).
  void keep(std::size_t first, std::size_t last);
  /// The first row at a stamp or behind it; size(): there is none. Rows must be in order.
  std::size_t firstFrom(Stamp stamp) const;

 private:
  struct Stored {
    std::int64_t ns = 0;
    std::array<double, 12> matrix{};  ///< the upper three rows
  };
  using Block = std::vector<Stored>;
  struct Cached {
    std::size_t block = 0;
    Block rows;  ///< empty: none
  };
  const Stored& stored(std::size_t i) const;

  std::size_t size_ = 0;
  bool in_order_ = true, once_ = true;  ///< stamps do not fall; none comes twice
  std::vector<std::int64_t> begins_;    ///< [ns] of each block
  Block newest_;                        ///< behind those in the file
  std::unique_ptr<PoseFile> file_;      ///< none while a block holds all
  mutable std::array<Cached, 2> cached_;
};

}  // namespace perception
