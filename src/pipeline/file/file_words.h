// SPDX-License-Identifier: Apache-2.0
// Words that name files.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/schema/schema.h"

namespace sg {

/// The words with f(value) in the place of each value of a parameter that names a file to read (unit "file").
std::vector<std::string> map_file_words(std::vector<std::string> words, const Schema& schema,
                                        const std::function<std::string(const std::string&)>& f);

/// The same with paths that begin at the pipeline file `origin`, as those of read do.
std::vector<std::string> words_beside(std::vector<std::string> words, const Schema& schema, const std::string& origin);

}  // namespace sg
