#include "tools/render/image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "soapfilm/error.h"
#include "tools/render/font.h"

namespace soapfilm {
namespace TEST_FILE {

std::string written(const Image& image) {
  const std::string path = testing::TempDir() + "soapfilm_image_test.png";
  write_png(path, image);
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  return bytes;
}

TEST(Image, PngHasItsSizeAndChannels) {
  Image image(7, 5, {10, 20, 30, 255});
  std::string png = written(image);
  ASSERT_GT(png.size(), 33u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png[19], 7);
  EXPECT_EQ(png[23], 5);
  EXPECT_EQ(png[25], 2);  // color type RGB
  image.at(3, 3)[3] = 128;
  png = written(image);
  EXPECT_EQ(png[25], 6);  // RGBA
}

TEST(Image, RefusesWhatCannotBeWritten) {
  EXPECT_THROW(write_png("x.png", Image{}), ParameterError);
  EXPECT_THROW(write_png("/no/such/folder/x.png", Image(2, 2, {0, 0, 0, 255})), OutputError);
}

TEST(Image, BlendsOverOpaqueAndTransparentPixels) {
  Image image(2, 1, {0, 0, 0, 0});
  image.at(1, 0) = {100, 100, 100, 255};
  image.blend(0, 0, {200, 0, 0}, 0.5);
  image.blend(1, 0, {200, 0, 0}, 0.5);
  image.blend(2, 0, {200, 0, 0}, 0.5);  // off the image
  EXPECT_EQ(image.at(0, 0), (Rgba8{200, 0, 0, 128}));
  EXPECT_EQ(image.at(1, 0), (Rgba8{150, 50, 50, 255}));
}

TEST(Font, EveryPrintableCharacterButTheSpaceLeavesInkOfItsOwn) {
  std::vector<std::vector<Rgba8>> seen;
  for (char c = '!'; c <= '~'; ++c) {
    Image image(40, 60, {255, 255, 255, 255});
    draw_text(image, std::string(1, c), 5, 40, 28, {0, 0, 0});
    EXPECT_TRUE(std::any_of(image.pixels.begin(), image.pixels.end(), [](const Rgba8& p) { return p[0] < 64; })) << c;
    EXPECT_EQ(std::count(seen.begin(), seen.end(), image.pixels), 0) << c;
    seen.push_back(image.pixels);
  }
}

TEST(Font, WidthGrowsWithTheTextAndItsHeight) {
  EXPECT_EQ(text_width("", 10), 0);
  EXPECT_GT(text_width("ab", 10), text_width("a", 10));
  EXPECT_DOUBLE_EQ(text_width("film", 20), 2 * text_width("film", 10));
  EXPECT_DOUBLE_EQ(text_width("\xC3\xA9", 10), text_width("?", 10));  // two bytes, one character
}

}  // namespace TEST_FILE
}  // namespace soapfilm
