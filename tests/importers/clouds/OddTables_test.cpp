// Folders of clouds as text of many programs, as arrays of numpy, and as PCD with an odd header.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <minizip/zip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

class OddTables : public OddRecording {
 protected:
  /// Lines of x, y, z and intensity as they are, times 1, with `above` before them.
  void expectText(const std::string& above, const std::string& format, int code = 0,
                  double unit = 1) {
    SCOPED_TRACE(above + format);
    renew();
    writeClouds(".csv", [&](const LidarCloud& cloud) {
      std::string text = above;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        text += fmt::format(fmt::runtime(format), cloud.x[i] / unit, cloud.y[i] / unit,
                            cloud.z[i] / unit, cloud.intensity[i]);
      return text;
    });
    expectNear(code);
  }
  /// The same with decimal commas.
  void expectCommas(const std::string& above, const std::string& separator,
                    const std::string& quote) {
    SCOPED_TRACE(above + separator + quote);
    renew();
    writeClouds(".csv", [&](const LidarCloud& cloud) {
      std::string text = above;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const float row[] = {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]};
        for (int c = 0; c < 4; ++c) {
          std::string number = fmt::format("{:.4f}", row[c]);
          std::replace(number.begin(), number.end(), '.', ',');
          text += quote + number + quote + (c < 3 ? separator : "\r\n");
        }
      }
      return text;
    });
    expectNear(0);
  }
  void renew() {
    std::filesystem::remove_all(file("clouds"));
    std::filesystem::remove(file("out.rawlog"));
  }
  void expectNear(int code) {
    ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), code) << error_;
    const auto frames = framesOf("LIDAR_TOP");
    ASSERT_EQ(frames.size(), 3U);
    const auto& got = std::get<LidarCloud>(frames[1].data);
    const LidarCloud expected = oneTurn(1);
    ASSERT_EQ(got.size(), expected.size());
    ASSERT_EQ(got.intensity.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_NEAR(got.x[i], expected.x[i], 1e-3) << i;
      ASSERT_NEAR(got.y[i], expected.y[i], 1e-3) << i;
      ASSERT_NEAR(got.z[i], expected.z[i], 1e-3) << i;
      ASSERT_NEAR(got.intensity[i], expected.intensity[i], 1e-3) << i;
    }
  }
  /// A file of numpy, by its format.
  static std::string numpy(const std::string& type, bool fortran, const std::string& shape,
                           const std::string& data) {
    std::string header = fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': ({}), }}", type,
                                     fortran ? "True" : "False", shape);
    header.resize(182 - 1, ' ');
    header += '\n';
    return std::string("\x93NUMPY\1\0", 8) + bytesOf<std::uint16_t>({182}) + header + data;
  }
  template <class Number>
  static std::string rowsOf(const LidarCloud& cloud) {
    std::vector<Number> numbers;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (const float v : {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]})
        numbers.push_back(static_cast<Number>(v));
    return bytesOf(numbers);
  }
  static std::string columnsOf(const LidarCloud& cloud) {
    return bytesOf(cloud.x) + bytesOf(cloud.y) + bytesOf(cloud.z) + bytesOf(cloud.intensity);
  }
  /// An archive of numpy.
  void writeArchive(const std::string& name,
                    const std::vector<std::pair<std::string, std::string>>& arrays) {
    std::filesystem::create_directories(file("clouds"));
    const zipFile zip = zipOpen64(file(name).c_str(), APPEND_STATUS_CREATE);
    for (const auto& [entry, bytes] : arrays) {
      zipOpenNewFileInZip64(zip, (entry + ".npy").c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr,
                            Z_DEFLATED, 6, 0);
      zipWriteInFileInZip(zip, bytes.data(), static_cast<unsigned>(bytes.size()));
      zipCloseFileInZip(zip);
    }
    zipClose(zip, nullptr);
  }
};

TEST_F(OddTables, UnitsBehindNamesAreNoPartOfThemAndAreApplied) {
  const std::string row = "{:.4f},{:.4f},{:.4f},{:.4f}\n";
  expectText("x [m],y [m],z [m],intensity [-]\n", row);
  expectText("X(m);Y(m);Z(m);Intensity\r\n", "{:.4f};{:.4f};{:.4f};{:.4f}\r\n");
  expectText("x [mm], y [mm], z [mm], intensity\n", row, 0, 1e-3);
  expectText("x [m] y [m] z [m] intensity\n", "{:.4f} {:.4f} {:.4f} {:.4f}\n");
}

TEST_F(OddTables, AUnitThatNobodyKnowsIsRefused) {
  writeClouds(".csv", [](const LidarCloud&) { return "x [yd],y [yd],z [yd]\n1,2,3\n"; });
  expectFault(65, "column x is in 'yd', expected m, cm", "clouds", {"--clouds", file("clouds")});
}

TEST_F(OddTables, CommentsAndTitlesAboveTheTableAreNoRows) {
  const std::string row = "{:.4f},{:.4f},{:.4f},{:.4f}\n";
  expectText("# roof lidar, exported 2024\nx,y,z,intensity\n", row);
  expectText("# x,y,z,intensity\n", row);
  expectText("//X Y Z Intensity\n720\n", "{:.4f} {:.4f} {:.4f} {:.4f}\n");
  expectText("Scan of the roof lidar\n\nx,y,z,intensity\n", row);
  expectText("% no names\n", row);
}

TEST_F(OddTables, DecimalCommasAreReadBesideEachSeparator) {
  expectCommas("x,y,z,intensity\r\n", ",", "\"");
  expectCommas("", ",", "\"");
  expectCommas("x\ty\tz\tintensity\r\n", "\t", "");
  expectCommas("x y z intensity\r\n", " ", "");
  expectCommas("x;y;z;intensity\r\n", "; ", "");
}

TEST_F(OddTables, TabsEmptyFieldsAndVectorsOfViewersAreRead) {
  expectText("x\ty\tz\tintensity\n", "{:.4f}\t{:.4f}\t{:.4f}\t{:.4f}\n");
  expectText("x;y;z;label;intensity;\n", "{:.4f};{:.4f};{:.4f};;{:.4f};\n");
  expectText("\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\",\"intensity\"\n",
             "{:.4f},{:.4f},{:.4f},{:.4f}\n");
}

TEST_F(OddTables, AnArrayOfNumpyIsReadInEachOrder) {
  writeClouds(".npy", [](const LidarCloud& cloud) {
    return numpy("'<f4'", false, "720, 4", rowsOf<float>(cloud));
  });
  expectNear(0);
  expectSaid("columns found from the data: x y z intensity");
  renew();
  writeClouds(".npy", [](const LidarCloud& cloud) {
    return numpy("'<f4'", true, "720, 4", columnsOf(cloud));
  });
  expectNear(0);
  renew();
  writeClouds(".npy", [](const LidarCloud& cloud) {
    return numpy("'<f4'", false, "4, 720", columnsOf(cloud));
  });
  expectNear(0);
  renew();
  writeClouds(".npy", [](const LidarCloud& cloud) {
    return numpy("'<f8'", false, "2, 360, 4", rowsOf<double>(cloud));
  });
  expectNear(0);
}

TEST_F(OddTables, AnArrayOfNumpyWithNamesAndPaddingIsRead) {
  writeClouds(".npy", [](const LidarCloud& cloud) {
    std::string data;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      data += bytesOf<double>({cloud.y[i], cloud.x[i], cloud.z[i]}) + std::string("\1\2\3") +
              bytesOf<float>({cloud.intensity[i]});
    return numpy("[('y', '<f8'), ('x', '<f8'), ('z', '<f8'), ('', '|V3'), ('intensity', '<f4')]",
                 false, "720,", data);
  });
  expectNear(0);
}

TEST_F(OddTables, AnArchiveOfNumpyGivesTheArrayThatIsACloud) {
  for (int k = 0; k < 3; ++k)
    writeArchive(fmt::format("clouds/{}.npz", k),
                 {{"stamp", numpy("'<f8'", false, "", bytesOf<double>({1.5}))},
                  {"points", numpy("'<f4'", false, "720, 4", rowsOf<float>(oneTurn(k)))}});
  expectNear(0);
  renew();
  for (int k = 0; k < 3; ++k) {
    const LidarCloud cloud = oneTurn(k);
    const auto column = [](const std::vector<float>& v) {
      return numpy("'<f4'", false, "720,", bytesOf(v));
    };
    writeArchive(fmt::format("clouds/{}.npz", k), {{"x", column(cloud.x)},
                                                   {"y", column(cloud.y)},
                                                   {"z", column(cloud.z)},
                                                   {"intensity", column(cloud.intensity)}});
  }
  expectNear(0);
}

TEST_F(OddTables, ArraysThatAreNoCloudSayWhatTheyAre) {
  const std::vector<std::string> words = {"--clouds", file("clouds")};
  write("clouds/0.npy", numpy("'|O'", false, "3,", "abc"));
  expectFault(65, "type of its numbers is not known", "clouds", words);
  write("clouds/0.npy", numpy("'<f2'", false, "2, 4", std::string(16, 'a')));
  expectFault(65, "numpy's type 'f2', expected floats of 4 or 8 bytes", "clouds", words);
  write("clouds/0.npy", numpy("'<f4'", false, "100, 4", "short"));
  expectFault(65, "5 bytes of points, expected 1600", "clouds", words);
  write("clouds/0.npy", numpy("'<f4'", false, "99999999, 4", "short"));
  expectFault(65, "99999999 points, expected at most", "clouds", words);
  std::filesystem::remove(file("clouds/0.npy"));
  const std::string cloud = numpy("'<f4'", false, "720, 4", rowsOf<float>(oneTurn(0)));
  writeArchive("clouds/0.npz", {{"front", cloud}, {"rear", cloud}});
  expectFault(65, "2 arrays can be the points: front (720, 4), rear (720, 4)", "clouds", words);
  write("clouds/0.npz", "no archive");
  expectFault(65, "expected an archive of numpy", "clouds", words);
}

TEST_F(OddTables, APcdWithoutItsNumberOfPointsHasThatOfItsRows) {
  writeClouds(".pcd", [](const LidarCloud& cloud) {
    return "VERSION 0.7\r\nFIELDS X Y Z Intensity\r\nSIZE 4 4 4 4\r\nTYPE F F F F\r\nWIDTH 360\r\n"
           "HEIGHT 2\r\nDATA binary\r\n" +
           rowsOf<float>(cloud);
  });
  expectNear(0);
  renew();
  write("clouds/0.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n");
  expectFault(65, "no line POINTS or WIDTH before DATA", "clouds", {"--clouds", file("clouds")});
}

TEST_F(OddTables, InfiniteNumbersOfTextAreNoReturns) {
  write(
      "clouds/0.pcd",
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n-inf Inf nan\n1 2 3\n");
  ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  const auto& cloud = std::get<LidarCloud>(frames.at(0).data);
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_EQ(cloud.x[0], 1);
}

TEST_F(OddTables, ScansOfOtherFormatsAreRefusedByTheirName) {
  write("clouds/0.las", "LASF");
  write("clouds/1.las", "LASF");
  expectFault(66, "2 files that end in '.las'; .las is not read: save the scans as .pcd", "clouds",
              {"--clouds", file("clouds")});
}

}  // namespace
}  // namespace perception
