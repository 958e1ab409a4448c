// LZF against a compressor of the tests' own.
#include <gtest/gtest.h>

#include "pcd_files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io/bytes/lzf.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(Lzf, DecodesWhatACompressorMakesInPiecesOfAnySize) {
  Random random(7);
  for (int i = 0; i < 40; ++i) {
    std::string bytes;
    const auto letters = 1 + static_cast<int>(random.uniform(0, 250));
    while (bytes.size() < static_cast<size_t>(i * i * 150)) {
      const auto back = static_cast<size_t>(random.uniform(1, 9000));
      if (random.uniform() < 0.1 && back <= bytes.size())
        for (int k = 0; k < 400; ++k) bytes += bytes[bytes.size() - back];
      bytes += static_cast<char>(random.uniform(0, letters));
    }
    const std::string packed = lzf_of(bytes);
    ASSERT_EQ(io::lzf_decoded_size(packed), bytes.size());
    io::LzfBytes decoder(packed);
    for (size_t at = 0; at < bytes.size();) {
      const size_t count = std::min(bytes.size() - at,
                                    static_cast<size_t>(random.uniform(1, static_cast<double>(decoder.most_at_once))));
      ASSERT_EQ(std::string(decoder.take(count), count), bytes.substr(at, count));
      at += count;
    }
    EXPECT_EQ(decoder.used(), packed.size());
  }
  EXPECT_EQ(io::lzf_decoded_size(std::string("\x20\x00", 2)), std::nullopt);  // a copy of nothing
  EXPECT_EQ(io::lzf_decoded_size("\x05"
                                 "abc"),
            std::nullopt);  // a literal run that ends early
  EXPECT_EQ(io::lzf_decoded_size(std::string("\x00"
                                             "a\xe0\x01",
                                             4)),
            std::nullopt);  // a copy that ends early
}

}  // namespace TEST_FILE
}  // namespace soapfilm
