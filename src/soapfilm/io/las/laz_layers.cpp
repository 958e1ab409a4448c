// Points of formats 6 to 10: each field in a layer, a stream of its own; items of versions 3 and 4.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/las/laz_channels.h"
#include "soapfilm/io/las/laz_fields.h"
#include "soapfilm/io/las/laz_points.h"

namespace soapfilm::io {

namespace {

constexpr size_t layer_block = 1024;  // points that each layer decodes before the next one does

/// The points that a layer is to fill in: a record for each, which holds the values of the chunk's first point.
struct LazBlock {
  const LazPointState* states;
  char* records;
  size_t record_bytes;
  size_t count;
};

/// One field of a chunk.
class LazLayer {
 public:
  virtual ~LazLayer() = default;
  /// Before all others: the state of the chunk's first point, whose record is known.
  virtual void begin(const LazPointState& first) = 0;
  virtual void decode(const LazBlock& block) = 0;
  bool failed() const { return from_.failed(); }

 protected:
  explicit LazLayer(std::string_view bytes) : from_(bytes) {}
  LazDecoder from_;
};

/// A layer of the point's own fields, at `place` of the record; Value is the field's type. Model is of one channel: its
/// begin(value) is told what the channel begins with, its next(decoder, state, last) gives the next value.
template <class Value, class Model>
class LazPointLayer : public LazLayer {
 public:
  LazPointLayer(std::string_view bytes, size_t place, const char* first) : LazLayer(bytes), place_(place) {
    first_ = load_little<Value>(first + place);
  }

  void begin(const LazPointState& state) override {
    const bool is_first = state.channel == state.channel_before;
    last_[state.channel] = is_first ? first_ : last_[state.channel_before];
    models_[state.channel] = std::make_unique<Model>(last_[state.channel]);
  }

  void decode(const LazBlock& block) override {
    char* to = block.records + place_;
    for (size_t i = 0; i < block.count; ++i, to += block.record_bytes) {
      const LazPointState& state = block.states[i];
      if (state.is_new) begin(state);
      Value& last = last_[state.channel];
      last = models_[state.channel]->next(from_, state, last);
      put(to, last);
    }
  }

 private:
  static void put(char* to, Value value) {
    if constexpr (sizeof(Value) == 1)
      Model::put(to, value);
    else
      put_binary(to, value);
  }

  size_t place_;
  Value first_;
  std::array<Value, laz_channels> last_{};
  std::array<std::unique_ptr<Model>, laz_channels> models_;
};

struct LazHeights {
  explicit LazHeights(int32_t first) { last_of_level.fill(first); }
  int32_t next(LazDecoder& from, const LazPointState& state, int32_t /*last*/) {
    int32_t& last = last_of_level[state.level];
    return last = steps.decode_signed(from, last, state.height_context);
  }
  LazIntegers steps{32, 20};
  std::array<int32_t, 8> last_of_level{};
};

/// A byte by what it was before, in as many contexts as there are models.
struct LazBytes {
  LazBytes(size_t contexts, uint32_t symbols) {
    for (size_t k = 0; k < contexts; ++k) models.emplace_back(symbols);
  }
  static void put(char* to, uint8_t value) { *to = static_cast<char>(value); }
  std::vector<LazSymbols> models;
};

struct LazClasses : LazBytes {
  explicit LazClasses(uint8_t /*first*/) : LazBytes(64, 256) {}
  uint8_t next(LazDecoder& from, const LazPointState& state, uint8_t last) {
    return static_cast<uint8_t>(from.symbol(models[2u * (last & 31) + (state.returns == 3)]));
  }
};

/// Withheld and the like in bits 0 to 3, direction and edge in bits 6 and 7; between them the channel, which is there.
struct LazFlags : LazBytes {
  explicit LazFlags(uint8_t /*first*/) : LazBytes(64, 64) {}
  uint8_t next(LazDecoder& from, const LazPointState& /*state*/, uint8_t last) {
    const uint32_t found = from.symbol(models[(last >> 6u) << 4u | (last & 15u)]);
    return static_cast<uint8_t>((found >> 4) << 6 | (found & 15));
  }
  static void put(char* to, uint8_t value) { *to = static_cast<char>((static_cast<uint8_t>(*to) & 0x30) | value); }
};

struct LazIntensities {
  explicit LazIntensities(uint16_t first) { last_like_this.fill(first); }
  uint16_t next(LazDecoder& from, const LazPointState& state, uint16_t /*last*/) {
    uint16_t& last = last_like_this[2u * state.returns + state.time_changes];
    return last = static_cast<uint16_t>(steps.decode(from, last, state.returns));
  }
  LazIntegers steps{16, 4};
  std::array<uint16_t, 8> last_like_this{};
};

struct LazAngles {
  explicit LazAngles(uint16_t /*first*/) {}
  uint16_t next(LazDecoder& from, const LazPointState& state, uint16_t last) {
    return state.angle_changes ? static_cast<uint16_t>(steps.decode(from, last, state.time_changes)) : last;
  }
  LazIntegers steps{16, 2};
};

struct LazUsers : LazBytes {
  explicit LazUsers(uint8_t /*first*/) : LazBytes(64, 256) {}
  uint8_t next(LazDecoder& from, const LazPointState& /*state*/, uint8_t last) {
    return static_cast<uint8_t>(from.symbol(models[last / 4]));
  }
};

struct LazSources {
  explicit LazSources(uint16_t /*first*/) {}
  uint16_t next(LazDecoder& from, const LazPointState& state, uint16_t last) {
    return state.source_changes ? static_cast<uint16_t>(steps.decode(from, last)) : last;
  }
  LazIntegers steps{16, 1};
};

struct LazClock {
  explicit LazClock(uint64_t first) : times(first, false) {}
  uint64_t next(LazDecoder& from, const LazPointState& state, uint64_t last) {
    return state.time_changes ? times.decode(from) : last;
  }
  LazTimes times;
};

/// A layer of an item beside the point. Model: next(decoder, last) gives the next value.
template <class Value, class Model>
class LazItemLayer : public LazLayer {
 public:
  LazItemLayer(std::string_view bytes, size_t place, const char* first) : LazLayer(bytes), place_(place) {
    first_ = get(first + place);
  }

  void begin(const LazPointState& first) override {
    last_[first.item_channel] = first_;
    models_[first.item_channel] = std::make_unique<Model>();
  }

  void decode(const LazBlock& block) override {
    char* to = block.records + place_;
    for (size_t i = 0; i < block.count; ++i, to += block.record_bytes) {
      const LazPointState& state = block.states[i];
      if (state.item_is_new) {
        last_[state.item_channel] = last_[state.item_before];
        models_[state.item_channel] = std::make_unique<Model>();
      }
      Value& last = last_[state.item_last];
      last = models_[state.item_channel]->next(from_, last);
      put(to, last);
    }
  }

 private:
  static Value get(const char* at) {
    if constexpr (std::is_same_v<Value, LazColors::Color>)
      return {load_little<uint16_t>(at), load_little<uint16_t>(at + 2), load_little<uint16_t>(at + 4)};
    else
      return load_little<Value>(at);
  }
  static void put(char* to, const Value& value) {
    if constexpr (std::is_same_v<Value, LazColors::Color>)
      for (const uint16_t part : value) to = put_binary(to, part);
    else
      put_binary(to, value);
  }

  size_t place_;
  Value first_;
  std::array<Value, laz_channels> last_{};
  std::array<std::unique_ptr<Model>, laz_channels> models_;
};

struct LazColorItem {
  LazColors::Color next(LazDecoder& from, const LazColors::Color& last) { return colors.decode(from, last); }
  LazColors colors;
};
struct LazInfraredItem {
  uint16_t next(LazDecoder& from, uint16_t last) { return infrared.decode(from, last); }
  LazInfrared infrared;
};
struct LazExtraByte {
  uint8_t next(LazDecoder& from, uint8_t last) { return static_cast<uint8_t>(last + from.symbol(steps)); }
  LazSymbols steps{256};
};

/// Where a layer's field is in a record, and what decodes it; null: it is passed over.
struct LazLayerKind {
  size_t place;
  size_t bytes;
  std::unique_ptr<LazLayer> (*make)(std::string_view bytes, size_t place, const char* first);
};

template <class Layer>
std::unique_ptr<LazLayer> make_layer(std::string_view bytes, size_t place, const char* first) {
  return std::make_unique<Layer>(bytes, place, first);
}

/// In the order of the file, after the first one.
std::vector<LazLayerKind> layers_of(const LazLayout& layout) {
  std::vector<LazLayerKind> kinds{{8, 4, make_layer<LazPointLayer<int32_t, LazHeights>>},
                                  {16, 1, make_layer<LazPointLayer<uint8_t, LazClasses>>},
                                  {15, 1, make_layer<LazPointLayer<uint8_t, LazFlags>>},
                                  {12, 2, make_layer<LazPointLayer<uint16_t, LazIntensities>>},
                                  {18, 2, make_layer<LazPointLayer<uint16_t, LazAngles>>},
                                  {17, 1, make_layer<LazPointLayer<uint8_t, LazUsers>>},
                                  {20, 2, make_layer<LazPointLayer<uint16_t, LazSources>>},
                                  {22, 8, make_layer<LazPointLayer<uint64_t, LazClock>>}};
  const int format = layout.point_format;
  size_t place = 30;
  const auto add = [&](size_t bytes, auto make) {
    kinds.push_back({place, bytes, make});
    place += bytes;
  };
  if (format == 7 || format == 8 || format == 10) add(6, make_layer<LazItemLayer<LazColors::Color, LazColorItem>>);
  if (format == 8 || format == 10) add(2, make_layer<LazItemLayer<uint16_t, LazInfraredItem>>);
  if (format >= 9) add(LazWaves::bytes, nullptr);
  while (place < layout.record_bytes) add(1, make_layer<LazItemLayer<uint8_t, LazExtraByte>>);
  return kinds;
}

class LazLayers : public LazPoints {
 public:
  LazLayers(const LazLayout& layout, std::string_view bytes) : first_(bytes.substr(0, layout.record_bytes)) {}

  /// False if the layers are longer than the chunk, or of another number of points.
  bool open(const LazLayout& layout, uint64_t points, std::string_view bytes, const std::vector<bool>& wanted) {
    const std::vector<LazLayerKind> kinds = layers_of(layout);
    const char* size = bytes.data() + layout.record_bytes + sizeof(uint32_t);
    const auto take = [&](uint64_t& at) {
      const uint64_t begin = at, own = load_little<uint32_t>(size);
      size += sizeof(uint32_t);
      at += own;
      return at > bytes.size() ? std::string_view() : bytes.substr(begin, own);
    };
    uint64_t at = layout.record_bytes + sizeof(uint32_t) * (2 + kinds.size());
    if (at > bytes.size() || load_little<uint32_t>(bytes.data() + layout.record_bytes) != points) return false;
    const std::string_view channels = take(at);
    for (const LazLayerKind& kind : kinds) {
      const std::string_view own = take(at);
      if (at > bytes.size()) return false;
      const auto begin = wanted.begin() + static_cast<std::ptrdiff_t>(kind.place);
      const bool used = std::find(begin, begin + static_cast<std::ptrdiff_t>(kind.bytes), true) !=
                        begin + static_cast<std::ptrdiff_t>(kind.bytes);
      if (used && !own.empty() && kind.make != nullptr) layers_.push_back(kind.make(own, kind.place, first_.data()));
    }
    channels_.emplace(channels.empty() ? LazDecoder() : LazDecoder(channels), first_.data(), layout.version);
    has_channels_ = !channels.empty();
    return true;
  }

  bool read(size_t count, char* to) override {
    for (size_t done = 0; done < count;) {
      const size_t block = std::min(layer_block, count - done);
      if (!read_block(block, to + done * first_.size())) return false;
      done += block;
    }
    return true;
  }

 private:
  bool read_block(size_t count, char* records) {
    const size_t bytes = first_.size();
    for (size_t i = 0; i < count; ++i) std::memcpy(records + i * bytes, first_.data(), bytes);
    size_t first = 0;
    if (!begun_) {
      for (const auto& layer : layers_) layer->begin(channels_->first());
      begun_ = true;
      first = 1;
      if (count > 1 && !has_channels_) return false;
    }
    for (size_t i = first; i < count; ++i) states_[i] = channels_->next(records + i * bytes);
    if (channels_->failed()) return false;
    const LazBlock block{states_.data() + first, records + first * bytes, bytes, count - first};
    for (const auto& layer : layers_) {
      layer->decode(block);
      if (layer->failed()) return false;
    }
    return true;
  }

  std::string_view first_;  // record
  std::optional<LazChannelLayer> channels_;
  std::vector<std::unique_ptr<LazLayer>> layers_;
  std::array<LazPointState, layer_block> states_;
  bool has_channels_ = false;
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<LazPoints> laz_layers(const LazLayout& layout, uint64_t points, std::string_view bytes,
                                      const std::vector<bool>& wanted) {
  auto layers = std::make_unique<LazLayers>(layout, bytes);
  if (!layers->open(layout, points, bytes, wanted)) return nullptr;
  return layers;
}

}  // namespace soapfilm::io
