#include "libperception/live/server/Outbox.h"

#include <gtest/gtest.h>

namespace perception::test {
namespace {

LiveMessage messageIn(const std::string& slot, const std::string& text) {
  return {slot, "", std::make_shared<const std::string>(text), false};
}

std::string taken(Outbox& outbox) {
  std::string all;
  while (const auto message = outbox.take()) all += *message->payload;
  return all;
}

TEST(Outbox, OfASlotTheNewestIsKeptAndWhatItReplacesIsCounted) {
  Outbox outbox;
  for (const char* text : {"1", "2", "3"}) outbox.put(messageIn("scene", text));
  outbox.put(messageIn("", "e"));
  outbox.put(messageIn("scene", "4"));
  EXPECT_EQ(taken(outbox), "4e") << "in the place of what it replaces";
  EXPECT_EQ(outbox.dropped(), 3U);
}

TEST(Outbox, WhatHasNoSlotIsKeptUpToTheBound) {
  Outbox outbox({3, 1000});
  for (const char* text : {"1", "2", "3", "4", "5"}) outbox.put(messageIn("", text));
  EXPECT_EQ(taken(outbox), "345");
  EXPECT_EQ(outbox.dropped(), 2U);
}

TEST(Outbox, BytesAreBoundedAndTheNewestIsAlwaysThere) {
  Outbox outbox({100, 10});
  outbox.put(messageIn("a", "123456"));
  outbox.put(messageIn("b", "123456"));
  EXPECT_EQ(outbox.dropped(), 1U);
  outbox.put(messageIn("c", std::string(50, 'x')));
  EXPECT_EQ(taken(outbox), std::string(50, 'x'));
  EXPECT_TRUE(outbox.isEmpty());
}

}  // namespace
}  // namespace perception::test
