// SPDX-License-Identifier: Apache-2.0
// The words of an enum: one table of word and value beside the enum. Parameters, help, files and messages read it; everything else
// compares values.
//
//   enum class Border { clamp, nan };
//   constexpr auto enum_words(Border) { return std::array{Word{"clamp", Border::clamp}, Word{"nan", Border::nan}}; }
#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <type_traits>

namespace sg {

template <class E>
struct Word {
  std::string_view word;
  E value;
};

template <class E>
concept WordedEnum = std::is_enum_v<E> && requires {
  enum_words(E{});
};

/// The word for a value; of several the first in the table. "" for a value without one.
template <WordedEnum E>
constexpr std::string_view word_of(E value) {
  for (const Word<E>& w : enum_words(E{}))
    if (w.value == value) return w.word;
  return {};
}

/// The value of a word, written as in the table; nothing when there is no such word.
template <WordedEnum E>
constexpr std::optional<E> value_of_word(std::string_view word) {
  for (const Word<E>& w : enum_words(E{}))
    if (w.word == word) return w.value;
  return std::nullopt;
}

}  // namespace sg
