#include "libperception/live/FoxgloveProtocol.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace perception::test {
namespace {

TEST(FoxgloveProtocol, SpeaksTheTwoSubprotocolsInTheOrderOfTheOffer) {
  EXPECT_EQ(foxglove::chosenProtocol("foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove::chosenProtocol("x, foxglove.websocket.v1 ,foxglove.sdk.v1"),
            "foxglove.websocket.v1");
  EXPECT_FALSE(foxglove::chosenProtocol("foxglove.sdk.v2"));
  EXPECT_FALSE(foxglove::chosenProtocol(""));
}

TEST(FoxgloveProtocol, AMessageBeginsWithItsSubscriptionAndTimeLittleEndian) {
  EXPECT_EQ(foxglove::messageHead(0x01020304, {0x05060708090a0b0c}),
            std::string("\x01\x04\x03\x02\x01\x0c\x0b\x0a\x09\x08\x07\x06\x05", 13));
}

TEST(FoxgloveProtocol, AChannelIsAdvertisedWithItsSchema) {
  const auto text =
      nlohmann::json::parse(foxglove::advertisement({{3, "/tf", {"a.B", "jsonschema", "{}"}}}));
  EXPECT_EQ(text["op"], "advertise");
  EXPECT_EQ(text["channels"][0], nlohmann::json({{"id", 3},
                                                 {"topic", "/tf"},
                                                 {"encoding", "json"},
                                                 {"schemaName", "a.B"},
                                                 {"schemaEncoding", "jsonschema"},
                                                 {"schema", "{}"}}));
}

TEST(FoxgloveProtocol, SubscriptionsAreRead) {
  const auto request = foxglove::requestOf(
      R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":1},{"id":8,"channelId":2}]})");
  ASSERT_EQ(request.subscribe.size(), 2U);
  EXPECT_EQ(request.subscribe[1], (std::pair<std::uint32_t, std::uint32_t>{8, 2}));
  EXPECT_EQ(foxglove::requestOf(R"({"op":"unsubscribe","subscriptionIds":[7]})").unsubscribe,
            std::vector<std::uint32_t>{7});
}

TEST(FoxgloveProtocol, WhatChangesSomethingOrIsNoRequestIsRefused) {
  for (const std::string& text :
       {std::string(R"({"op":"advertise","channels":[]})"),
        std::string(R"({"op":"setParameters","parameters":[]})"), std::string(R"({"op":1})"),
        std::string(R"({"op":"subscribe"})"),
        std::string(R"({"op":"subscribe","subscriptions":[1]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
        std::string(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4294967296}]})"),
        std::string(R"({"op":"unsubscribe","subscriptionIds":"7"})"), std::string("[]"),
        std::string("{"), std::string(""), std::string("\xff\xfe"), std::string(60000, '[')})
    EXPECT_THROW(foxglove::requestOf(text), std::invalid_argument) << text.substr(0, 80);
}

}  // namespace
}  // namespace perception::test
