// SPDX-License-Identifier: Apache-2.0
#include "io/text/word_categories.h"

#include <algorithm>

#include "data/fields/label_names.h"

namespace sg {

std::optional<WordCategories> word_categories(const std::string& field, const std::vector<std::string>& words) {
  std::vector<std::string_view> different(words.begin(), words.end());
  std::sort(different.begin(), different.end());
  different.erase(std::unique(different.begin(), different.end()), different.end());
  if (different.size() > most_categories) return {};
  WordCategories r;
  r.numbers.reserve(words.size());
  for (const std::string& w : words)
    r.numbers.push_back(int32_t(std::lower_bound(different.begin(), different.end(), std::string_view(w)) - different.begin()));
  LabelNames names(field);
  for (size_t k = 0; k < different.size(); ++k) names.add(int64_t(k), std::string(different[k]));
  r.note = names.note();
  return r;
}

}  // namespace sg
