#pragma once
#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/sensors/rawlog/FileSink.h"

namespace perception {

class Inflater;

/// Reads a rawlog file, plain, gzip or zstd (several members allowed; MRPT writes zstd since
/// 2.15.7). Unlike MRPT's CFileGZInputStream it checks length and CRC of every gzip member, never
/// returns fewer bytes than requested, and reports why it ended.
class CRawlogInput final : public mrpt::serialization::CArchive {
 public:
  enum class State {
    kGood,
    kEnd,      ///< all bytes were read and the container is complete
    kTorn,     ///< the file ends inside its container or inside the requested bytes
    kDamaged,  ///< invalid compressed data, wrong checksum, or other data behind the end
    kFailed    ///< read error of the operating system
  };

  /// Throws DataError: kNoInput when missing, kBadInput when it is empty, unreadable or no regular
  /// file.
  explicit CRawlogInput(const std::string& path, FileSink sink = {});
  ~CRawlogInput() override;

  /// True when no byte is left; state() has the reason.
  bool atEnd();
  /// The next bytes without consuming them; fewer than `count` (at most 1024) only at the end.
  std::string peek(std::size_t count);
  State state() const { return state_; }
  const std::string& reason() const { return reason_; }  ///< for kTorn, kDamaged, kFailed

  std::uint64_t position() const { return position_; }        ///< [bytes] consumed, after inflating
  std::uint64_t fileBytes() const { return file_bytes_; }     ///< [bytes] size of the file
  std::uint64_t fileBytesRead() const { return file_read_; }  ///< [bytes] read so far
  bool compressed() const { return inflater_ != nullptr; }
  std::uint64_t members() const { return members_; }  ///< of the container, begun so far
  std::string container() const;                      ///< "gzip", "zstd"; empty: plain
  std::string getArchiveDescription() const override { return path_; }

 protected:
  /// Throws when fewer than `count` bytes are left.
  std::size_t read(void* to, std::size_t count) override;
  std::size_t write(const void*, std::size_t) override;

 private:
  bool fill();  ///< appends bytes to ready_; false at the end
  bool fillPlain();
  bool fillInflated();
  unsigned char* roomFor(std::size_t bytes);
  bool haveRaw();
  bool readFile();  ///< reads the next part of the file into raw_
  void stop(State state, const std::string& reason);

  std::string path_;
  FileSink sink_;
  int file_ = -1;
  std::uint64_t file_bytes_ = 0, file_read_ = 0, position_ = 0;
  std::uint64_t members_ = 0;
  std::unique_ptr<Inflater> inflater_;  ///< null: plain
  bool in_member_ = true;               ///< between the header and the trailer of a member
  std::vector<unsigned char> raw_;  ///< as read from the file; [raw_begin_, end) is not used yet
  std::size_t raw_begin_ = 0;
  /// Inflated; [ready_begin_, ready_end_) is not consumed yet, what lies behind is room.
  std::vector<unsigned char> ready_;
  std::size_t ready_begin_ = 0, ready_end_ = 0;
  State state_ = State::kGood;
  std::string reason_;
};

}  // namespace perception
