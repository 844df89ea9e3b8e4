// SPDX-License-Identifier: Apache-2.0
// Fields of words: numbers of categories, whose names a note of the dataset tells.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sg {

/// More different words are no categories.
constexpr size_t most_categories = 4096;

struct WordCategories {
  std::vector<int32_t> numbers;              ///< one per word: its place among the sorted different ones, from 0
  std::pair<std::string, std::string> note;  ///< the names of the numbers (data/fields/label_names.h)
};

/// Nothing for more than most_categories different words.
std::optional<WordCategories> word_categories(const std::string& field, const std::vector<std::string>& words);

}  // namespace sg
