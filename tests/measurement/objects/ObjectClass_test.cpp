#include "libperception/measurement/objects/ObjectClass.h"

#include <gtest/gtest.h>

#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

ClassTable shipped() {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/classes.ini");
  const ClassTable table = readClassTable(config);
  EXPECT_EQ(faultsOf(config), "");
  return table;
}

TEST(ObjectClass, TheShippedTableHasTheClassesInOrder) {
  const ClassTable table = shipped();
  ASSERT_EQ(table.size(), 5);
  const char* names[] = {"pedestrian", "cyclist", "car", "bus", "static-other"};
  for (ClassId c = 0; c < table.size(); ++c) {
    EXPECT_EQ(table[c].name, names[c]);
    EXPECT_EQ(table.find(names[c]), c);
  }
  EXPECT_EQ(table.find("tram"), -1);
  EXPECT_EQ(table[0].motion, findMotionModel("constant-velocity"));
  EXPECT_EQ(table[2].motion, findMotionModel("wheeled"));
  EXPECT_EQ(table[4].motion, findMotionModel("static"));
  EXPECT_TRUE(table[3].reported);
  EXPECT_FALSE(table[4].reported);
}

TEST(ObjectClass, PriorsSumToOne) {
  double sum = 0;
  for (const auto& c : shipped().classes) sum += c.prior;
  EXPECT_NEAR(sum, 1, 1e-15);
  Config config = Config::fromText("[class.a]\nprior = 0.1\n[class.b]\nprior = 0.3\n");
  const ClassTable table = readClassTable(config);
  EXPECT_DOUBLE_EQ(table[0].prior, 0.25);
  EXPECT_DOUBLE_EQ(table[1].prior, 0.75);
}

TEST(ObjectClass, YawNoiseOfTheTableIsFifteenDegreesSquaredPerSecond) {
  EXPECT_NEAR(shipped()[2].yaw_rate_psd, radians(15) * radians(15), 5e-5);  // of [radecki2016]
  EXPECT_EQ(shipped()[3].yaw_rate_psd, shipped()[2].yaw_rate_psd);  // size tells buses from cars
}

TEST(ObjectClass, AnotherClassNeedsNoCode) {
  const TemporaryFolder folder;
  writeText(folder / "site.ini", "include = " PERCEPTION_SOURCE_DIR
                                 "/ini/classes.ini\n[class.tram]\nmotion = wheeled\nlength = 30\n"
                                 "[class.car]\nlength = 4.2\n");
  Config config = Config::fromFile(folder / "site.ini");
  const ClassTable table = readClassTable(config);
  EXPECT_EQ(faultsOf(config), "");
  EXPECT_EQ(table[table.find("tram")].length, 30);
  EXPECT_EQ(table[table.find("car")].length, 4.2);
}

TEST(ObjectClass, AMotionOfNoRowIsAFaultThatNamesTheRows) {
  Config config = Config::fromText("[class.tram]\nmotion = rail\n", "t.ini");
  readClassTable(config);
  EXPECT_EQ(faultsOf(config),
            "t.ini:2: [class.tram] motion: found 'rail', expected one of constant-velocity, "
            "wheeled, static");
}

TEST(ObjectClass, HasNotTheNameOfAColumnOfTracks) {
  Config config = Config::fromText("[class.front]\nmotion = static\nprior = 1\n", "t.ini");
  readClassTable(config);
  EXPECT_NE(faultsOf(config).find("tracks.csv has a column p_front"), std::string::npos);
}

TEST(ObjectClass, NoneAtAllIsAFault) {
  Config config = Config::fromText("", "t.ini");
  EXPECT_EQ(readClassTable(config).size(), 0);
  EXPECT_EQ(faultsOf(config), "t.ini: no [class.NAME] section: include classes.ini");
}

}  // namespace
}  // namespace perception::test
