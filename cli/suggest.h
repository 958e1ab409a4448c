// The word that was meant where another one was typed.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::cli {

/// The fewest letters added, dropped, replaced, or neighbors exchanged that turn one word into the other (Damerau 1964;
/// no part is edited twice: the optimal string alignment).
size_t edit_distance(std::string_view a, std::string_view b);

/// The known word that was most likely meant: the same but for upper and lower case and dashes in front, the only one
/// that begins so, or the one with the fewest edits, at most one in three letters. Empty: none.
std::string nearest(std::string_view typed, const std::vector<std::string>& known);

/// ", did you mean 'WORD'?", or nothing.
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known);

}  // namespace soapfilm::cli
