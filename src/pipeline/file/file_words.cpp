// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/file_words.h"

#include "base/file/file.h"
#include "base/schema/file_params.h"
#include "base/text/text.h"

namespace sg {

std::vector<std::string> map_file_words(std::vector<std::string> words, const Schema& schema,
                                        const std::function<std::string(const std::string&)>& f) {
  for (std::string& word : words) {
    const size_t sign = word.find('=');
    const ParamDecl* d = sign == word.npos ? nullptr : schema.find(std::string(trim(std::string_view(word).substr(0, sign))));
    if (d && names_file(*d) && sign + 1 < word.size()) word = word.substr(0, sign + 1) + f(word.substr(sign + 1));
  }
  return words;
}

std::vector<std::string> words_beside(std::vector<std::string> words, const Schema& schema, const std::string& origin) {
  return map_file_words(std::move(words), schema, [&](const std::string& path) { return path_beside(origin, path); });
}

}  // namespace sg
