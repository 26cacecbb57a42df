#include "libperception/sensors/satellites/PositionTrack.h"

#include <gtest/gtest.h>

#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

std::string fileWith(const test::TemporaryFolder& folder, const std::string& name,
                     const std::string& text) {
  const std::string path = folder / name;
  std::ofstream(path) << text;
  return path;
}

TEST(PositionTrack, ReadsGgaSentencesAndDropsBrokenOnes) {
  const test::TemporaryFolder folder;
  // The first is the example of the standard (checksum 47); the second has a wrong checksum, the
  // third no fix.
  const auto track = readPositionTrack(
      fileWith(folder, "a.nmea",
               "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
               "$GPGGA,123520,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
               "$GPGGA,123521,4807.038,N,01131.000,E,0,08,0.9,545.4,M,46.9,M,,\r\n"
               "$GPGGA,123522,4807.038,S,01131.000,W,1,08,0.9,545.4,M,46.9,M,,\r\n"));
  ASSERT_EQ(track.fixes.size(), 2u);
  EXPECT_EQ(track.dropped, 2u);
  EXPECT_NEAR(track.fixes[0].t, 12 * 3600 + 35 * 60 + 19, 1e-9);
  EXPECT_NEAR(track.fixes[0].latitude, 48 + 7.038 / 60, 1e-9);
  EXPECT_NEAR(track.fixes[0].longitude, 11 + 31.0 / 60, 1e-9);
  EXPECT_LT(track.fixes[1].latitude, 0);
  EXPECT_LT(track.fixes[1].longitude, 0);
}

TEST(PositionTrack, GoesOnAfterMidnight) {
  const test::TemporaryFolder folder;
  const auto track = readPositionTrack(
      fileWith(folder, "a.txt",
               "$GPGGA,235959,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n"
               "$GPGGA,000000,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n"));
  ASSERT_EQ(track.fixes.size(), 2u);
  EXPECT_NEAR(track.fixes[1].t - track.fixes[0].t, 1, 1e-9);
}

TEST(PositionTrack, ReadsGpx) {
  const test::TemporaryFolder folder;
  const auto track = readPositionTrack(
      fileWith(folder, "a.gpx",
               "<gpx version=\"1.1\"><trk><trkseg>"
               "<trkpt lat=\"42.5\" lon=\"-76.5\"><time>1970-01-02T00:00:01Z</time></trkpt>"
               "<trkpt lat=\"42.6\" lon=\"-76.5\"><time>2020-02-29T12:00:00.5Z</time></trkpt>"
               "</trkseg></trk></gpx>"));
  ASSERT_EQ(track.fixes.size(), 2u);
  EXPECT_NEAR(track.fixes[0].t, 86401, 1e-9);
  EXPECT_NEAR(track.fixes[1].t, 1582977600.5, 1e-6);
}

TEST(PositionTrack, LocalMetersAreThoseOfTheEllipsoid) {
  PositionTrack track;
  track.fixes = {{0, 0, 0}, {1, 0, 1.0 / 3600}, {2, 1.0 / 3600, 0}};
  const auto p = track.local();
  EXPECT_NEAR(p[1].x(), 30.922, 1e-3);  // a second of longitude at the equator
  EXPECT_NEAR(p[2].y(), 30.715, 1e-3);  // a second of latitude there
}

TEST(PositionTrack, FaultsNameFileAndPlace) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& text) -> std::string {
    try {
      readPositionTrack(fileWith(folder, name, text));
    } catch (const DataError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("a.nmea", "hello\n").find("expected $--GGA"), std::string::npos);
  EXPECT_NE(message("b.gpx", "<gpx><trk>\n").find("b.gpx:"), std::string::npos);
  EXPECT_NE(
      message("c.gpx", "<gpx><trk><trkseg>\n<trkpt lat=\"x\" lon=\"1\"/></trkseg></trk></gpx>")
          .find("c.gpx:2: <trkpt>"),
      std::string::npos);
  EXPECT_NE(message("d.csv", "t_s,lat_deg\n0,1\n").find("lon_deg"), std::string::npos);
  EXPECT_NE(message("e.kml", "").find("expected .nmea"), std::string::npos);
  EXPECT_THROW(readPositionTrack(folder / "none.gpx"), DataError);
}

}  // namespace
}  // namespace perception
