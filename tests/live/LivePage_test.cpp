#include "libperception/live/LivePage.h"

#include <gtest/gtest.h>

namespace perception::test {
namespace {

TEST(LivePage, HasOneScriptWithItsNonceAndEscapesTheLog) {
  const std::string page = livePage("<b>.rawlog");
  EXPECT_EQ(page.find("<b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;b&gt;.rawlog"), std::string::npos);
  const std::size_t script = page.find("<script");
  ASSERT_NE(script, std::string::npos);
  EXPECT_EQ(page.substr(script, 24), "<script nonce=\"{NONCE}\">");
  EXPECT_EQ(page.find("{NONCE}", script + 24), std::string::npos);
  EXPECT_NE(page.find("data-live"), std::string::npos);
  EXPECT_NE(page.find("perception.live.v1"), std::string::npos) << "the script connects";
}

}  // namespace
}  // namespace perception::test
