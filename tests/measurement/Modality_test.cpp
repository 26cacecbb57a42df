#include "libperception/measurement/Modality.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace perception {
namespace {

TEST(Modality, TheTableHoldsCameraLidarAndRadarInThisOrder) {
  ASSERT_GE(modalities().size(), 3U);
  EXPECT_EQ(modalities()[0].letter, Modality::kCamera);
  EXPECT_EQ(modalities()[1].letter, Modality::kLidar);
  EXPECT_EQ(modalities()[2].letter, Modality::kRadar);
  EXPECT_EQ(modalityIndex(Modality::kRadar), 2U);
}

TEST(Modality, ARowIsFoundByItsLetterAlone) {
  ASSERT_NE(findModality('L'), nullptr);
  EXPECT_EQ(findModality('L')->name, "lidar");
  EXPECT_EQ(findModality('x'), nullptr);
  EXPECT_THROW(rowOf(static_cast<Modality>('x')), std::out_of_range);
}

TEST(Modality, OneIsAddedOnceAndFollowsTheOthers) {
  const std::size_t before = modalities().size();
  ModalityRow row;
  row.letter = static_cast<Modality>('U');
  row.name = "ultrasonic";
  addModality(row);
  row.output_rank = 3;
  addModality(row);
  EXPECT_EQ(modalities().size(), before + 1);
  EXPECT_EQ(modalityIndex(row.letter), before);
  EXPECT_EQ(rowOf(row.letter).output_rank, 3);
  EXPECT_EQ(modalityLetters(), "C, L, R, U");
}

}  // namespace
}  // namespace perception
