// SPDX-License-Identifier: Apache-2.0
// Private to the pipeline: a bounded tree of YAML text. Every scalar stays the text that it is in the file.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sg {

struct YamlPair;

struct YamlNode {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  std::string text;             ///< scalar
  int line = 0;                 ///< from 1
  std::vector<YamlNode> items;  ///< list
  std::vector<YamlPair> pairs;  ///< map, in file order; keys are scalars
};

struct YamlPair {
  YamlNode first, second;
};

/// One document. Throws Error(usage) "origin:line: ..." for bad syntax, anchors, aliases, tags, keys that are not words, and sizes beyond
/// the limits.
YamlNode parse_yaml(std::string_view text, const std::string& origin);
/// `s` as a scalar that parse_yaml reads back to `s`, quoted when it needs to be; safe inside [] and {}.
std::string yaml_scalar(const std::string& s);

}  // namespace sg
