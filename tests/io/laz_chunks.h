// A chunk of LAZ of records, for files that tests make.
#pragma once

#include <map>
#include <memory>

#include "laz_items.h"

namespace soapfilm::laz {

struct Places {
  size_t time = 0, color = 0, infrared = 0, waves = 0, extra = 0;  // 0: none
};
inline Places places_of(int format) {
  constexpr std::array<Places, 11> all{{{0, 0, 0, 0, 20},
                                        {20, 0, 0, 0, 28},
                                        {0, 20, 0, 0, 26},
                                        {20, 28, 0, 0, 34},
                                        {20, 0, 0, 28, 57},
                                        {20, 28, 0, 34, 63},
                                        {22, 0, 0, 0, 30},
                                        {22, 30, 0, 0, 36},
                                        {22, 30, 36, 0, 38},
                                        {22, 0, 0, 30, 59},
                                        {22, 30, 36, 38, 67}}};
  return all[static_cast<size_t>(format)];
}

inline Color color_of(const std::string& record, size_t place) {
  return {at<uint16_t>(record, place), at<uint16_t>(record, place + 2), at<uint16_t>(record, place + 4)};
}
inline uint32_t byte_of(const std::string& record, size_t place) { return static_cast<uint8_t>(record[place]); }

/// Formats 0 to 5: all in one stream.
class PointwiseEncoder {
 public:
  PointwiseEncoder(int format, const std::string& first)
      : places_(places_of(format)), last_(first), extra_(many(first.size() - places_.extra, 256)) {
    if (places_.time != 0) times_ = std::make_unique<TimeEncoder>(at<int64_t>(first, places_.time), true);
  }

  void encode(Encoder& to, const std::string& now) {
    encode_point(to, now);
    if (times_) times_->encode(to, at<int64_t>(now, places_.time));
    if (places_.color != 0) colors_.encode(to, color_of(last_, places_.color), color_of(now, places_.color));
    if (places_.waves != 0) waves_.encode(to, last_, now, places_.waves);
    for (size_t k = 0; k < extra_.size(); ++k)
      to.symbol(extra_[k], (byte_of(now, places_.extra + k) - byte_of(last_, places_.extra + k)) & 255);
    last_ = now;
  }

 private:
  void encode_point(Encoder& to, const std::string& now) {
    static constexpr uint8_t groups[8][8] = {{15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
                                             {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
                                             {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
                                             {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};
    const uint32_t returns = byte_of(now, 14), r = returns & 7, n = returns >> 3 & 7;
    const uint8_t m = groups[n][r];
    const auto intensity = at<uint16_t>(now, 12);
    const uint32_t changes = (last_[14] != now[14] ? 32u : 0u) | (intensities_[m] != intensity ? 16u : 0u) |
                             (last_[15] != now[15] ? 8u : 0u) | (last_[16] != now[16] ? 4u : 0u) |
                             (last_[17] != now[17] ? 2u : 0u) | (last_.substr(18, 2) != now.substr(18, 2) ? 1u : 0u);
    to.symbol(changes_, changes);
    const auto byte = [&](int which, size_t place) {
      auto& models = bytes_[which];
      to.symbol(models.try_emplace(byte_of(last_, place), 256).first->second, byte_of(now, place));
    };
    if ((changes & 32) != 0) byte(0, 14);
    if ((changes & 16) != 0) intensity_.encode(to, intensities_[m], intensity, std::min<size_t>(m, 3));
    intensities_[m] = intensity;
    if ((changes & 8) != 0) byte(1, 15);
    if ((changes & 4) != 0) to.symbol(angles_[returns >> 6 & 1], (byte_of(now, 16) - byte_of(last_, 16)) & 255);
    if ((changes & 2) != 0) byte(2, 17);
    if ((changes & 1) != 0) source_.encode(to, at<uint16_t>(last_, 18), at<uint16_t>(now, 18));

    const size_t single = n == 1;
    const auto step = [&](size_t place) {
      return static_cast<int32_t>(at<uint32_t>(now, place) - at<uint32_t>(last_, place));
    };
    x_.encode(to, x_medians_[m].get(), step(0), single);
    x_medians_[m].add(step(0));
    y_.encode(to, y_medians_[m].get(), step(4), single + std::min<size_t>(x_.last_size / 2 * 2, 20));
    y_medians_[m].add(step(4));
    const size_t size = (x_.last_size + y_.last_size) / 2;
    int32_t& height = heights_[n > r ? n - r : r - n];
    z_.encode(to, height, at<int32_t>(now, 8), single + std::min<size_t>(size / 2 * 2, 18));
    height = at<int32_t>(now, 8);
  }

  Places places_;
  std::string last_;
  SymbolCounts changes_{64};
  std::map<int, std::map<uint32_t, SymbolCounts>> bytes_;
  std::vector<SymbolCounts> angles_ = many(2, 256);
  IntegerEncoder intensity_{16, 4}, source_{16}, x_{32, 2}, y_{32, 22}, z_{32, 20};
  std::array<uint16_t, 16> intensities_{};
  std::array<Median, 16> x_medians_, y_medians_;
  std::array<int32_t, 8> heights_{};
  std::unique_ptr<TimeEncoder> times_;
  ColorEncoder colors_;
  WaveEncoder waves_;
  std::vector<SymbolCounts> extra_;
};

/// One scanner channel of formats 6 to 10.
struct Channel {
  explicit Channel(const std::string& first) : last(first), times(at<int64_t>(first, 22), false) {
    heights.fill(at<int32_t>(first, 8));
    intensities.fill(at<uint16_t>(first, 12));
  }

  std::string last;
  bool time_changed = false;
  std::vector<SymbolCounts> changes = many(8, 128), numbers = many(16, 16), returns = many(16, 16);
  SymbolCounts channels{3}, pulse_returns{13};
  IntegerEncoder x{32, 2}, y{32, 22}, z{32, 20}, intensity{16, 4}, angle{16, 2}, source{16};
  std::array<Median, 12> x_medians, y_medians;
  std::array<int32_t, 8> heights;
  std::array<uint16_t, 8> intensities;
  std::vector<SymbolCounts> classes = many(64, 256), flags = many(64, 64), users = many(64, 256);
  TimeEncoder times;
};

/// What a channel has of the items beside the point.
struct Items {
  Items(const std::string& first, size_t extra) : last(first), bytes(many(extra, 256)) {}
  std::string last;
  ColorEncoder colors;
  InfraredEncoder infrared;
  std::vector<SymbolCounts> bytes;
};

/// Formats 6 to 10: a stream for each layer.
class LayeredEncoder {
 public:
  LayeredEncoder(int format, int version, const std::string& first)
      : places_(places_of(format)), version_(version), first_(first), channel_(byte_of(first, 15) >> 4 & 3) {
    item_ = channel_;
    channels_.try_emplace(channel_, first);
    items_.try_emplace(item_, first, first.size() - places_.extra);
    layers_.resize(9 + (places_.color != 0) + (places_.infrared != 0) + (places_.waves != 0) + first.size() -
                   places_.extra);
  }

  void encode(const std::string& now) {
    const uint32_t channel = byte_of(now, 15) >> 4 & 3;
    const bool switches = channel != channel_;
    encode_position(now, channel);
    encode_fields(now);
    channels_.at(channel_).last = now;
    encode_items(now, version_ == 4 || switches ? channel : 0);
    ++count_;
  }

  /// Counts and sizes of layers, and the layers.
  std::string done() {
    std::string sizes(4, '\0'), all;
    std::memcpy(sizes.data(), &count_, 4);
    for (Layer& layer : layers_) {
      const std::string bytes = layer.changed ? layer.to.done() : std::string();
      const auto size = static_cast<uint32_t>(bytes.size());
      sizes.append(reinterpret_cast<const char*>(&size), 4);
      all += bytes;
    }
    return sizes + all;
  }

 private:
  struct Layer {
    Encoder to;
    bool changed = false;
  };

  void encode_position(const std::string& now, uint32_t channel) {
    Encoder& to = layers_[0].to;
    layers_[0].changed = true;
    Channel& before = channels_.at(channel_);
    Channel& own = channels_.try_emplace(channel, before.last).first->second;
    const std::string last = own.last;
    const uint32_t r = byte_of(now, 14) & 15, n = byte_of(now, 14) >> 4;
    const uint32_t last_r = byte_of(last, 14) & 15, last_n = byte_of(last, 14) >> 4;
    const uint32_t up = (r - last_r) & 15;
    time_changes_ = at<int64_t>(last, 22) != at<int64_t>(now, 22);
    const uint32_t changes = (channel != channel_ ? 64u : 0u) | (last.substr(20, 2) != now.substr(20, 2) ? 32u : 0u) |
                             (time_changes_ ? 16u : 0u) | (last.substr(18, 2) != now.substr(18, 2) ? 8u : 0u) |
                             (n != last_n ? 4u : 0u) |
                             (up == 0    ? 0u
                              : up == 1  ? 1u
                              : up == 15 ? 2u
                                         : 3u);
    to.symbol(before.changes[returns_of(before.last) + 4 * before.time_changed], changes);
    if (channel != channel_) to.symbol(before.channels, (channel - channel_ - 1) & 3);
    channel_ = channel;
    if (n != last_n) to.symbol(own.numbers[last_n], n);
    if ((changes & 3) == 3 && time_changes_) to.symbol(own.returns[last_r], r);
    if ((changes & 3) == 3 && !time_changes_) to.symbol(own.pulse_returns, up - 2);
    own.time_changed = time_changes_;

    const size_t single = n == 1, median = 2 * group(n, r) + time_changes_;
    const auto step = [&](size_t place) {
      return static_cast<int32_t>(at<uint32_t>(now, place) - at<uint32_t>(last, place));
    };
    own.x.encode(to, own.x_medians[median].get(), step(0), single);
    own.x_medians[median].add(step(0));
    own.y.encode(to, own.y_medians[median].get(), step(4), single + std::min<size_t>(own.x.last_size / 2 * 2, 20));
    own.y_medians[median].add(step(4));
    const size_t size = (own.x.last_size + own.y.last_size) / 2;
    int32_t& height = own.heights[std::min(n > r ? n - r : r - n, 7u)];
    own.z.encode(layer(1, now, 8, 4), height, at<int32_t>(now, 8), single + std::min<size_t>(size / 2 * 2, 18));
    height = at<int32_t>(now, 8);
  }

  void encode_fields(const std::string& now) {
    Channel& own = channels_.at(channel_);
    const uint32_t returns = returns_of(now);
    const uint32_t last_class = byte_of(own.last, 16) & 31, last_user = byte_of(own.last, 17) / 4;
    layers_[3].changed |= ((now[15] ^ first_[15]) & 0xcf) != 0;
    to_symbol(2, now, 16, own.classes[2 * last_class + (returns == 3)]);
    const auto flags = [](uint32_t byte) { return (byte & 15) | (byte >> 6) << 4; };
    layers_[3].to.symbol(own.flags[flags(byte_of(own.last, 15))], flags(byte_of(now, 15)));
    uint16_t& intensity = own.intensities[2 * returns + time_changes_];
    own.intensity.encode(layer(4, now, 12, 2), intensity, at<uint16_t>(now, 12), returns);
    intensity = at<uint16_t>(now, 12);
    if (const auto last = at<int16_t>(own.last, 18), angle = at<int16_t>(now, 18); last != angle)
      own.angle.encode(layer(5, now, 18, 2), last, angle, time_changes_);
    to_symbol(6, now, 17, own.users[last_user]);
    if (const auto last = at<uint16_t>(own.last, 20), source = at<uint16_t>(now, 20); last != source)
      own.source.encode(layer(7, now, 20, 2), last, source);
    if (time_changes_) own.times.encode(layer(8, now, 22, 8), at<int64_t>(now, 22));
  }

  /// Version 3 forgets the channel after one point, and once more uses the last value of the one it comes from.
  void encode_items(const std::string& now, uint32_t channel) {
    Items* last = &items_.at(item_);
    if (channel != item_) {
      const bool is_new = items_.count(channel) == 0;
      Items& own = items_.try_emplace(channel, last->last, last->bytes.size()).first->second;
      if (is_new || version_ == 4) last = &own;
    }
    item_ = channel;
    Items& own = items_.at(channel);
    size_t k = 9;
    if (places_.color != 0)
      own.colors.encode(layer(k++, now, places_.color, 6), color_of(last->last, places_.color),
                        color_of(now, places_.color));
    if (places_.infrared != 0)
      own.infrared.encode(layer(k++, now, places_.infrared, 2), at<uint16_t>(last->last, places_.infrared),
                          at<uint16_t>(now, places_.infrared));
    if (places_.waves != 0) layer(k++, now, places_.waves, 29).bits(8, 77);  // readers pass it over
    for (size_t b = places_.extra; b < now.size(); ++b)
      layer(k++, now, b, 1).symbol(own.bytes[b - places_.extra], (byte_of(now, b) - byte_of(last->last, b)) & 255);
    last->last = now;
  }

  /// A layer is written if its bytes of the record change.
  Encoder& layer(size_t k, const std::string& now, size_t place, size_t bytes) {
    layers_[k].changed |= now.compare(place, bytes, first_, place, bytes) != 0;
    return layers_[k].to;
  }
  void to_symbol(size_t k, const std::string& now, size_t place, SymbolCounts& model) {
    layer(k, now, place, 1).symbol(model, byte_of(now, place));
  }
  static uint32_t returns_of(const std::string& record) {
    const uint32_t r = byte_of(record, 14) & 15, n = byte_of(record, 14) >> 4;
    return (r == 1 ? 1u : 0u) | (r >= n ? 2u : 0u);
  }
  /// The writer's table of 16 x 16, by its rules.
  static size_t group(uint32_t n, uint32_t r) {
    static constexpr uint8_t ends[16] = {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5};
    if (n == 0 || r == 0) return ends[n + r];
    if (n == 1 || r == 1) return n == r ? 0 : n + r == 3 ? 1 : 3;
    if (n == 2 && r == 2) return 2;
    if (n == 2) return r > 10 ? 3 : 4;
    if (r == 2) return n > 10 ? 3 : 4;
    const uint32_t apart = n > r ? n - r : r - n;
    return apart == 0 || (apart == 1 && std::min(n, r) >= 11) ? 5 : 4;
  }

  Places places_;
  int version_;
  std::string first_;
  uint32_t channel_, item_ = 0, count_ = 1;
  bool time_changes_ = false;
  std::map<uint32_t, Channel> channels_;
  std::map<uint32_t, Items> items_;
  std::vector<Layer> layers_;
};

}  // namespace soapfilm::laz
