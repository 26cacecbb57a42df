#include "libperception/sensors/rawlog/ReadAhead.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

/// `count` comments, then the end, or a fault.
class Comments final : public ObservationInput {
 public:
  Comments(std::uint64_t count, bool faulty, std::uint64_t* calls = nullptr)
      : count_(count), faulty_(faulty), calls_(calls) {}
  std::shared_ptr<mrpt::obs::CObservation> next() override {
    if (calls_ != nullptr) ++*calls_;
    if (given_ == count_) {
      ended_ = true;
      if (faulty_) throw DataError("log.rawlog: unreadable");
      return nullptr;
    }
    auto comment = std::make_shared<mrpt::obs::CObservationComment>();
    comment->text = std::to_string(given_++);
    return comment;
  }
  bool isComplete() const override { return ended_; }
  std::string endName() const override { return ended_ ? "clean" : "not_yet"; }
  const std::string& endMessage() const override { return message_; }
  bool verifiable() const override { return true; }
  std::uint64_t entries() const override { return given_; }
  std::optional<Stamp> lastStamp() const override {
    if (given_ == 0) return std::nullopt;
    return Stamp{static_cast<std::int64_t>(given_)};
  }
  std::uint64_t bytesRead() const override { return 100 * given_; }
  std::uint64_t fileBytes() const override { return 100 * count_; }

 private:
  const std::uint64_t count_;
  const bool faulty_;
  std::uint64_t* calls_;
  std::uint64_t given_ = 0;
  bool ended_ = false;
  const std::string message_ = "why";
};

std::string textOf(const mrpt::obs::CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationComment&>(observation).text;
}

TEST(ReadAhead, GivesEveryObservationWithTheStateAfterIt) {
  ReadAhead input(std::make_unique<Comments>(100, false));
  EXPECT_EQ(input.fileBytes(), 10000u);
  EXPECT_EQ(input.entries(), 0u);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const auto observation = input.next();
    ASSERT_TRUE(observation);
    EXPECT_EQ(textOf(*observation), std::to_string(i));
    EXPECT_EQ(input.entries(), i + 1);
    EXPECT_EQ(input.bytesRead(), 100 * (i + 1));
    EXPECT_EQ(input.lastStamp()->ns, static_cast<std::int64_t>(i + 1));
    EXPECT_FALSE(input.isComplete());
    EXPECT_EQ(input.endName(), "not_yet");
  }
  for (int again = 0; again < 3; ++again) EXPECT_FALSE(input.next());
  EXPECT_TRUE(input.isComplete());
  EXPECT_TRUE(input.verifiable());
  EXPECT_EQ(input.endName(), "clean");
  EXPECT_EQ(input.endMessage(), "why");
}

TEST(ReadAhead, AFaultComesAfterWhatWasReadBeforeIt) {
  ReadAhead input(std::make_unique<Comments>(3, true));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(input.next());
  EXPECT_THROW(input.next(), DataError);
  EXPECT_FALSE(input.next());
}

TEST(ReadAhead, ReadsAFewAheadAndNoMore) {
  std::uint64_t calls = 0;
  {
    ReadAhead input(std::make_unique<Comments>(1000, false, &calls));
    ASSERT_TRUE(input.next());
  }  // its thread has ended
  EXPECT_GE(calls, 1u);
  EXPECT_LE(calls, 10u);
}

}  // namespace
}  // namespace perception
