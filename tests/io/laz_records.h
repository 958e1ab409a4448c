// Point records for LAZ that do all that its coders tell apart.
#pragma once

#include "las_files.h"
#include "laz_chunks.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

/// Records as a scanner would make them, for most fields and most of the time, and as no scanner would.
class RandomRecords {
 public:
  RandomRecords(int format, size_t extra, uint64_t seed)
      : format_(format),
        places_(laz::places_of(format)),
        random_(seed),
        record_(LasFile::lengths[static_cast<size_t>(format)] + extra, '\0') {}

  std::string next() {
    for (const size_t place : {0, 4, 8}) {
      const auto step =
          sometimes(0.01)
              ? word()
              : static_cast<uint32_t>(static_cast<int32_t>(random_.normal() * (sometimes(0.1) ? 3000 : 20)));
      put(record_, place, laz::at<uint32_t>(record_, place) + step);
    }
    if (sometimes(0.7)) put(record_, 12, static_cast<uint16_t>(sometimes(0.02) ? word() : 300 + word() % 40));
    if (sometimes(0.5)) put_returns();
    for (const size_t place : {15, 16, 17})
      if (sometimes(0.05)) record_[place] = static_cast<char>(sometimes(0.3) ? word() : word() % 4);
    if (format_ >= 6 && sometimes(0.1)) record_[15] = static_cast<char>((record_[15] & 0xcf) | (word() & 3) << 4);
    if (format_ >= 6 && sometimes(0.3))
      put(record_, 18, static_cast<uint16_t>(laz::at<uint16_t>(record_, 18) + word() % 9 - 4));
    if (sometimes(0.02)) put(record_, format_ >= 6 ? 20 : 18, static_cast<uint16_t>(word() % 5));
    if (places_.time != 0) put_time();
    if (places_.color != 0 && sometimes(0.8)) put_color();
    if (places_.infrared != 0 && sometimes(0.5)) put(record_, places_.infrared, static_cast<uint16_t>(word() % 700));
    if (places_.waves != 0) put_waves();
    for (size_t place = places_.extra; place < record_.size(); ++place)
      if (sometimes(0.2) && place % 5 != 1) record_[place] = static_cast<char>(word());
    return record_;
  }

 private:
  uint32_t word() { return static_cast<uint32_t>(random_.next()); }
  bool sometimes(double probability) { return random_.uniform() < probability; }

  void put_returns() {
    const uint32_t most = format_ >= 6 ? 16 : 8, bits = format_ >= 6 ? 4 : 3;
    const uint32_t n = sometimes(0.1) ? word() % most : 1 + word() % 3;
    const uint32_t r = sometimes(0.1) ? word() % most : n > 0 ? 1 + word() % n : 0;
    const uint32_t rest = format_ >= 6 ? 0 : (word() & 3) << 6;
    record_[14] = static_cast<char>(r | n << bits | rest);
  }

  /// Up to five clocks by turns, which tick evenly, or nearly so, or stand, or jump.
  void put_time() {
    if (sometimes(0.1)) clock_ = word() % times_.size();
    int64_t& time = times_[clock_];
    if (time == 0 || sometimes(0.01)) time = static_cast<int64_t>(random_.next() >> 2);
    const double what = random_.uniform();
    if (what < 0.3)
      time += 1000;
    else if (what < 0.6)
      time += 1000 * static_cast<int64_t>(word() % 12) + static_cast<int64_t>(word() % 7);
    else if (what < 0.65)
      time += static_cast<int32_t>(word());
    else if (what < 0.75)
      time -= 1000 * static_cast<int64_t>(word() % 15);
    put(record_, places_.time, time);
  }

  void put_color() {
    const bool is_gray = sometimes(0.3);
    const bool is_wild = sometimes(0.1);
    uint16_t red = 0;
    for (size_t k = 0; k < 3; ++k) {
      const size_t place = places_.color + 2 * k;
      const auto color =
          static_cast<uint16_t>(is_wild ? word() : laz::at<uint16_t>(record_, place) + 257 * (word() % 5));
      if (k == 0) red = color;
      put(record_, place, is_gray ? red : color);
    }
  }

  void put_waves() {
    const size_t place = places_.waves;
    record_[place] = static_cast<char>(word() % 3);
    const uint64_t step = sometimes(0.3)   ? 0
                          : sometimes(0.5) ? laz::at<uint32_t>(record_, place + 9)
                          : sometimes(0.8) ? word() % 5000
                                           : random_.next();
    put(record_, place + 1, laz::at<uint64_t>(record_, place + 1) + step);
    for (size_t k = 9; k < 29; k += 4)
      if (sometimes(0.5)) put(record_, place + k, sometimes(0.1) ? word() : word() % 300);
  }

  int format_;
  laz::Places places_;
  Random random_;
  std::string record_;
  size_t clock_ = 0;
  std::array<int64_t, 5> times_{};
};

/// A LAS file of such records.
inline std::string random_las(int format, size_t count, size_t extra, uint64_t seed) {
  LasFile file;
  file.format = format;
  file.minor = format >= 6 ? 4 : format >= 4 ? 3 : 2;
  file.points.resize(count);
  for (LasPoint& point : file.points) point.extra = std::string(extra, '\0');
  std::string bytes = file.bytes();
  RandomRecords records(format, extra, seed);
  for (size_t i = 0; i < count; ++i)
    bytes.replace(file.points_offset() + i * file.record_bytes(), file.record_bytes(), records.next());
  return bytes;
}

/// A file with what a cloud can have, and points that are left out.
inline LasFile survey(int format, size_t count) {
  LasFile file;
  file.format = format;
  file.minor = format >= 6 ? 4 : 2;
  Random random(3);
  for (size_t i = 0; i < count; ++i) {
    LasPoint point;
    for (int32_t& v : point.xyz) v = static_cast<int32_t>(random.next() % 100000);
    point.intensity = static_cast<uint16_t>(random.next() % 1000);
    point.classification = static_cast<uint8_t>(random.next() % 9);
    point.source = static_cast<uint16_t>(2 * i / count);
    point.withheld = i % 7 == 3;
    point.time = static_cast<double>(i) * 0.25;
    for (uint16_t& v : point.rgb) v = static_cast<uint16_t>(random.next());
    point.infrared = static_cast<uint16_t>(i);
    point.extra = bytes_of(static_cast<float>(random.normal()));
    file.points.push_back(point);
  }
  file.records = {LasFile::record("LASF_Spec", 4, LasFile::extra("width", 9))};
  return file;
}

/// Of items in files of this format.
inline std::vector<uint16_t> versions_of(int format) {
  return format < 6 ? std::vector<uint16_t>{1, 2} : std::vector<uint16_t>{3, 4};
}

}  // namespace soapfilm
