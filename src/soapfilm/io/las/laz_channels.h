// The first layer of LAZ's layered compression: scanner channels, returns, x and y. It says what the points of the
// other layers have in common.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "soapfilm/io/las/laz_coder.h"

namespace soapfilm::io {

constexpr size_t laz_channels = 4;

/// What the first layer says of a point. Channels are the scanner's, of which each has models of its own.
struct LazPointState {
  uint8_t channel = 0;
  uint8_t channel_before = 0;  ///< of the point before this one
  uint8_t level = 0;           ///< returns before or after this one, up to 7
  uint8_t height_context = 0;
  uint8_t returns = 0;       ///< 1: the first of its pulse; 2: the last; 3: both
  uint8_t item_channel = 0;  ///< whose models items beside the point use
  uint8_t item_last = 0;     ///< in which channel they find their last value, and leave this one
  uint8_t item_before = 0;   ///< item_channel of the point before this one
  bool is_new = false;       ///< the channel's first point: what it does not say is as in channel_before
  bool item_is_new = false;
  bool time_changes = false;
  bool angle_changes = false;
  bool source_changes = false;
};

class LazChannelLayer {
 public:
  /// `record`: the first point. `version`: 3 or 4, of the items.
  LazChannelLayer(LazDecoder from, const char* record, int version);

  /// The state of the first point.
  LazPointState first() const;
  /// Decodes the next point: writes its x, y, returns and channel.
  LazPointState next(char* record);
  bool failed() const { return from_.failed(); }

 private:
  struct Channel;

  Channel& channel(unsigned index, const Channel* like);
  unsigned next_return(Channel& own, uint32_t changes, bool time_changes);
  void set_items(LazPointState& state, bool switches);

  LazDecoder from_;
  int version_;
  std::array<std::shared_ptr<Channel>, laz_channels> channels_;
  LazPointState last_;
  std::array<bool, laz_channels> items_begun_{};
};

}  // namespace soapfilm::io
