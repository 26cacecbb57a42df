#include "libperception/interop/ros/RosDefinition.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace perception::ros {
namespace {

const std::string kTurnText =
    "# of a turning scanner\n"
    "uint8 SPINS=1\n"
    "string NAME = \"a b\"\n"
    "Header header\n"
    "my_msgs/Hit[] hits   # in order\n"
    "float32[2] range\n"
    "string<=8 unit\n"
    "uint8[] raw\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: my_msgs/Hit\n"
    "Point place\nint16 power\n"
    "================================================================================\n"
    "MSG: my_msgs/Point\n"
    "float64 x\n";

std::string refusal(const std::string& text) {
  try {
    const Definition definition(text);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

TEST(RosDefinition, MembersAreThoseOfTheTextWithoutConstantsAndRemarks) {
  const Definition definition(kTurnText);
  const MessagePart& message = definition.message();
  ASSERT_EQ(message.fields.size(), 5U);
  EXPECT_EQ(message.fields[0].part->name, "std_msgs/Header");
  const MessageField* const hits = message.find("hits");
  ASSERT_NE(hits, nullptr);
  EXPECT_EQ(hits->list, MessageField::List::kSequence);
  EXPECT_EQ(hits->part->find("place")->part->name, "my_msgs/Point") << "of the same package";
  EXPECT_EQ(message.find("range")->count, 2U);
}

TEST(RosDefinition, AMessageOfRos1IsDecodedByIt) {
  // seq 7, stamp 1 s 2 ns, frame "f"; one hit at x = 2.5, power -3; ranges 1 and 2; "mm"; two bytes
  const std::string bytes(
      "\7\0\0\0\1\0\0\0\2\0\0\0\1\0\0\0f"
      "\1\0\0\0\0\0\0\0\0\0\4\x40\xfd\xff"
      "\0\0\x80\x3f\0\0\0\x40"
      "\2\0\0\0mm"
      "\2\0\0\0\xfe\xff",
      17 + 14 + 8 + 6 + 6);
  const Definition definition(kTurnText);
  const RosValue value = decoded(bytes, Encoding::kRos1, definition);
  EXPECT_EQ(value.text("header.frame_id"), "f");
  ASSERT_EQ(value.find("hits")->items.size(), 1U);
  EXPECT_EQ(value.find("hits")->items[0].number("place.x"), 2.5);
  EXPECT_EQ(value.find("hits")->items[0].number("power"), -3);
  EXPECT_EQ(value.find("range")->numbers, (std::vector<double>{1, 2}));
  EXPECT_EQ(value.text("unit"), "mm");
  EXPECT_EQ(value.find("raw")->bytes, "\xfe\xff");
  EXPECT_EQ(value.find("hits.place"), nullptr) << "a list has no members";
  EXPECT_THROW(decoded(bytes + "x", Encoding::kRos1, definition), std::runtime_error);
  EXPECT_THROW(decoded(bytes.substr(0, 40), Encoding::kRos1, definition), std::runtime_error);
}

TEST(RosDefinition, UsualPartsNeedNotTravelAndCdrAligns) {
  const Definition definition("uint8 kind\ngeometry_msgs/Point at\n");
  const std::string bytes(
      "\0\1\0\0\5\0\0\0\0\0\0\0\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\x40\0\0\0\0\0\0\x08\x40", 36);
  const RosValue value = decoded(bytes, Encoding::kCdr, definition);
  EXPECT_EQ(value.number("kind"), 5);
  EXPECT_EQ(value.number("at.x"), 1);
  EXPECT_EQ(value.number("at.z"), 3);
}

TEST(RosDefinition, WhatIsNoDefinitionIsRefused) {
  EXPECT_NE(refusal("their_msgs/Odd thing\n").find("lacks that of their_msgs/Odd"),
            std::string::npos);
  EXPECT_NE(refusal("uint8\n").find("the line 'uint8'"), std::string::npos);
  EXPECT_NE(refusal("uint8[99999999] big\n").find("a list uint8[99999999] big"), std::string::npos);
  EXPECT_NE(refusal("uint8 .its\n").find("a member '.its'"), std::string::npos);
  std::string deep = "a/M0 m\n";
  for (int i = 0; i < 40; ++i)
    deep += "===\nMSG: a/M" + std::to_string(i) + "\nM" + std::to_string(i + 1) + " m\n";
  EXPECT_NE(refusal(deep).find("too deep"), std::string::npos) << refusal(deep);
  EXPECT_NE(refusal("a/M m\n===\nMSG: a/M\na/M m\n").find("too deep"), std::string::npos);
}

}  // namespace
}  // namespace perception::ros
