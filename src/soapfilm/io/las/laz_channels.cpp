#include "soapfilm/io/las/laz_channels.h"

#include <algorithm>

#include "soapfilm/io/bytes/encode.h"

namespace soapfilm::io {

namespace {

/// Which earlier points a point is like, by its number of returns and which of them it is.
constexpr uint8_t new_return_groups[16][16] = {
    {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
    {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5},
};
constexpr unsigned return_group_count = 6;
constexpr unsigned most_level = 7;

// Places in a record.
constexpr size_t x_place = 0, y_place = 4, returns_place = 14, flags_place = 15;

uint8_t first_and_last(unsigned number, unsigned of) {
  return static_cast<uint8_t>((number == 1 ? 1 : 0) | (number >= of ? 2 : 0));
}

template <size_t count>
std::vector<LazSymbols> models(uint32_t symbols) {
  std::vector<LazSymbols> all;
  for (size_t k = 0; k < count; ++k) all.emplace_back(symbols);
  return all;
}

}  // namespace

struct LazChannelLayer::Channel {
  uint32_t x = 0, y = 0;
  unsigned number = 0, of = 0;  // of returns
  bool time_changed = false;

  std::vector<LazSymbols> changes = models<8>(128);
  LazSymbols channels{3};
  std::vector<LazSymbols> numbers_of_returns = models<16>(16);
  std::vector<LazSymbols> return_numbers = models<16>(16);
  LazSymbols returns_of_pulse{13};
  LazIntegers x_steps{32, 2}, y_steps{32, 22};
  std::array<LazMedian, 2 * return_group_count> x_medians, y_medians;
};

LazChannelLayer::LazChannelLayer(LazDecoder from, const char* record, int version) : from_(from), version_(version) {
  const unsigned returns = static_cast<uint8_t>(record[returns_place]);
  last_.channel = last_.channel_before = static_cast<uint8_t>(static_cast<uint8_t>(record[flags_place]) >> 4 & 3);
  last_.item_channel = last_.item_last = last_.item_before = last_.channel;
  last_.is_new = last_.item_is_new = true;
  items_begun_[last_.channel] = true;
  Channel& first = channel(last_.channel, nullptr);
  first.x = load_little<uint32_t>(record + x_place);
  first.y = load_little<uint32_t>(record + y_place);
  first.number = returns & 15;
  first.of = returns >> 4;
}

LazPointState LazChannelLayer::first() const { return last_; }

/// A channel begins with the values that the one before it had last.
LazChannelLayer::Channel& LazChannelLayer::channel(unsigned index, const Channel* like) {
  std::shared_ptr<Channel>& own = channels_[index];
  if (own) return *own;
  own = std::make_shared<Channel>();
  if (like != nullptr) {
    own->x = like->x;
    own->y = like->y;
    own->number = like->number;
    own->of = like->of;
  }
  return *own;
}

LazPointState LazChannelLayer::next(char* record) {
  LazPointState state;
  const Channel& before = *channels_[last_.channel];
  const unsigned context = first_and_last(before.number, before.of) | (before.time_changed ? 4u : 0u);
  Channel* own = channels_[last_.channel].get();
  const uint32_t changes = from_.symbol(own->changes[context]);
  const bool switches = (changes & 64) != 0;
  state.channel = state.channel_before = last_.channel;
  if (switches) {
    state.channel = static_cast<uint8_t>((last_.channel + from_.symbol(own->channels) + 1) % laz_channels);
    state.is_new = !channels_[state.channel];
    own = &channel(state.channel, own);
  }
  set_items(state, switches);
  state.source_changes = (changes & 32) != 0;
  state.time_changes = (changes & 16) != 0;
  state.angle_changes = (changes & 8) != 0;
  const unsigned of = (changes & 4) != 0 ? from_.symbol(own->numbers_of_returns[own->of]) : own->of;
  const unsigned number = next_return(*own, changes, state.time_changes);
  own->number = number;
  own->of = of;
  own->time_changed = state.time_changes;
  state.returns = first_and_last(number, of);
  state.level = static_cast<uint8_t>(std::min(of > number ? of - number : number - of, most_level));

  const unsigned single = of == 1;
  const auto even = [](unsigned bits, unsigned most) { return std::min(bits & ~1u, most); };
  const size_t median = 2 * size_t{new_return_groups[of][number]} + state.time_changes;
  const int32_t dx = own->x_steps.decode_signed(from_, own->x_medians[median].get(), single);
  own->x_medians[median].add(dx);
  const unsigned x_bits = own->x_steps.bits_of_last();
  const int32_t dy = own->y_steps.decode_signed(from_, own->y_medians[median].get(), single + even(x_bits, 20));
  own->y_medians[median].add(dy);
  state.height_context = static_cast<uint8_t>(single + even((x_bits + own->y_steps.bits_of_last()) / 2, 18));
  own->x += static_cast<uint32_t>(dx);
  own->y += static_cast<uint32_t>(dy);
  put_binary(record + x_place, own->x);
  put_binary(record + y_place, own->y);
  record[returns_place] = static_cast<char>(number | of << 4);
  record[flags_place] = static_cast<char>((static_cast<uint8_t>(record[flags_place]) & 0xcf) | state.channel << 4);
  last_ = state;
  return state;
}

unsigned LazChannelLayer::next_return(Channel& own, uint32_t changes, bool time_changes) {
  switch (changes & 3) {
    case 0:
      return own.number;
    case 1:
      return (own.number + 1) % 16;
    case 2:
      return (own.number + 15) % 16;
    default:
      if (time_changes) return from_.symbol(own.return_numbers[own.number]);
      return (own.number + from_.symbol(own.returns_of_pulse) + 2) % 16;
  }
}

/// Items beside the point (colors, extra bytes) of version 3 go back to channel 0 with the point after a change, and
/// the first time in a channel that they know they still take the other one's last value. Version 4 mended both.
void LazChannelLayer::set_items(LazPointState& state, bool switches) {
  state.item_before = last_.item_channel;
  state.item_channel = state.item_last = version_ >= 4 || switches ? state.channel : 0;
  if (state.item_channel == last_.item_channel) return;
  state.item_is_new = !items_begun_[state.item_channel];
  items_begun_[state.item_channel] = true;
  if (version_ == 3 && !state.item_is_new) state.item_last = state.item_before;
}

}  // namespace soapfilm::io
