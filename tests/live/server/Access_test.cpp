#include "libperception/live/server/Access.h"

#include <gtest/gtest.h>

#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

AccessRequest asked(const std::string& host) { return {host, std::nullopt, "/", ""}; }

TEST(Access, LoopbackNamesAndAddressesReachThePage) {
  for (const char* host : {"localhost", "LOCALHOST:8765", "127.0.0.1:1", "127.9.9.9", "[::1]:8765"})
    EXPECT_FALSE(refusalOf({}, asked(host))) << host;
}

TEST(Access, ANameThatWasTurnedToOurAddressIsRefused) {
  for (const char* host :
       {"", "evil.example", "evil.example:8765", "localhost.evil.example", "192.168.0.9",
        "127.0.0.1.evil.example", "localhost:port", "[::1", "127.0.0.1:80@evil.example", "::1"}) {
    const auto refusal = refusalOf({}, asked(host));
    ASSERT_TRUE(refusal) << host;
    EXPECT_EQ(refusal->status, 403) << host;
  }
}

TEST(Access, OtherOriginsAreRefusedUnlessTheyAreNamed) {
  AccessRules rules;
  AccessRequest request = asked("localhost:8765");
  request.origin = "http://localhost:8765";
  EXPECT_FALSE(refusalOf(rules, request));
  for (const char* origin : {"https://evil.example", "http://localhost:3000", "null", "",
                             "https://localhost:8765", "http://localhost:8765.evil.example"}) {
    request.origin = origin;
    const auto refusal = refusalOf(rules, request);
    ASSERT_TRUE(refusal) << origin;
    EXPECT_EQ(refusal->status, 403) << origin;
  }
  request.origin = "https://app.example";
  rules.origins = {"https://app.example"};
  EXPECT_FALSE(refusalOf(rules, request));
}

TEST(Access, ATokenIsTakenFromQueryOrHeaderAndComparedWhole) {
  AccessRules rules;
  rules.token = "0123456789abcdef";
  AccessRequest request = asked("localhost");
  const auto status = [&] {
    const auto refusal = refusalOf(rules, request);
    return refusal ? refusal->status : 200;
  };
  EXPECT_EQ(status(), 401);
  for (const char* wrong : {"/?token=", "/?token=0123456789abcde", "/?token=0123456789abcdef0",
                            "/?xtoken=0123456789abcdef", "/token=0123456789abcdef"}) {
    request.target = wrong;
    EXPECT_EQ(status(), 401) << wrong;
  }
  request.target = "/?a=b&token=0123456789abcdef&c";
  EXPECT_EQ(status(), 200);
  request.target = "/";
  request.authorization = "Bearer 0123456789abcdef";
  EXPECT_EQ(status(), 200);
}

TEST(Access, AddressesThatOthersReachNeedAToken) {
  AccessRules rules;
  checkRules(rules);
  rules.address = "0.0.0.0";
  EXPECT_THROW(checkRules(rules), Error);
  rules.token = "0123456789abcdef";
  checkRules(rules);
  rules.address = "localhost";
  EXPECT_THROW(checkRules(rules), Error) << "a name may mean anything";
  rules.address = "0.0.0.0";
  AccessRequest request{"192.168.0.9:8765", std::nullopt, "/?token=0123456789abcdef", ""};
  EXPECT_FALSE(refusalOf(rules, request)) << "no name, nothing to turn";
  request.host = "evil.example";
  EXPECT_TRUE(refusalOf(rules, request));
}

TEST(Access, ATokenFileHoldsOneThatCannotBeGuessed) {
  const TemporaryFolder folder;
  const auto tokenOf = [&](const std::string& text) {
    std::ofstream(folder / "token") << text;
    return readToken(folder / "token");
  };
  EXPECT_EQ(tokenOf("0123456789abcdef\n"), "0123456789abcdef");
  EXPECT_THROW(tokenOf("short\n"), DataError);
  EXPECT_THROW(tokenOf("0123456789 abcdef\n"), DataError);
  EXPECT_THROW(tokenOf(""), DataError);
  EXPECT_THROW(readToken(folder / "none"), DataError);
}

}  // namespace
}  // namespace perception::test
