#pragma once
#include <cstddef>
#include <memory>
#include <string>

namespace perception {

/// Decoder of a compressed container that comes in blocks: members of gzip, frames of zstd.
class Inflater {
 public:
  enum class Step {
    kMore,       ///< the block is used up, or `out` is full
    kMemberEnd,  ///< the member is complete, its checksum (where it has one) matches
    kBad         ///< see fault()
  };
  /// A block; the pointer advances, the size shrinks.
  struct In {
    const unsigned char* data;
    std::size_t size;
  };
  struct Out {
    unsigned char* data;
    std::size_t size;
  };

  virtual ~Inflater() = default;
  virtual const char* name() const = 0;
  /// Whether a member may begin with this byte.
  virtual bool begins(unsigned char byte) const = 0;
  /// Before every member but the first.
  virtual void reset() = 0;
  virtual Step step(In& in, Out& out) = 0;
  const std::string& fault() const { return fault_; }

 protected:
  std::string fault_;
};

/// The decoder for a file with these first bytes; null: it is not compressed. gzip (RFC 1952): 1F
/// 8B; zstd (RFC 8878): 28 B5 2F FD or a skippable frame, 50 to 5F 2A 4D 18.
std::unique_ptr<Inflater> inflaterFor(const unsigned char* bytes, std::size_t size);

}  // namespace perception
