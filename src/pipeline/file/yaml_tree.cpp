// SPDX-License-Identifier: Apache-2.0
// Built from the parser's events, not from its nodes: an alias is seen before it is followed.
#include "pipeline/file/yaml_tree.h"

#include <fmt/core.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"

namespace sg {

namespace {

constexpr size_t most_bytes = size_t(1) << 20, most_nodes = 100'000;
constexpr size_t deepest = 32, longest = size_t(256) << 10, most_keys = 4096;

class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& origin) : origin_(origin) {}
  YamlNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { fail(mark, "aliases (*name) are not allowed"); }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { put(make(mark, anchor, YamlNode::Kind::null)); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    check_tag(mark, tag);
    YamlNode n = make(mark, anchor, YamlNode::Kind::scalar);
    if (value.size() > longest) fail(mark, fmt::format("a value has more than {}", human_bytes(longest)));
    n.text = bytes_of_text(value);
    put(std::move(n));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(mark, make(mark, anchor, YamlNode::Kind::list));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(mark, make(mark, anchor, YamlNode::Kind::map));
  }
  void OnMapEnd() override { close(); }

 private:
  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what) const {
    fail_usage(what, fmt::format("{}:{}", origin_, mark.line + 1));
  }
  void check_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!") fail(mark, "tags (" + tag + ") are not allowed");
  }

  YamlNode make(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind) {
    if (anchor != YAML::NullAnchor) fail(mark, "anchors (&name) are not allowed");
    if (++nodes_ > most_nodes) fail(mark, fmt::format("has more than {} values", most_nodes));
    YamlNode n;
    n.kind = kind;
    n.line = mark.line + 1;
    return n;
  }
  void open(const YAML::Mark& mark, YamlNode n) {
    if (stack_.size() >= deepest) fail(mark, fmt::format("has more than {} levels", deepest));
    stack_.push_back({std::move(n), {}, false});
  }
  void close() {
    YamlNode n = std::move(stack_.back().node);
    stack_.pop_back();
    put(std::move(n));
  }
  void put(YamlNode n) {
    if (stack_.empty()) {
      root = std::move(n);
      return;
    }
    Level& top = stack_.back();
    if (top.node.kind == YamlNode::Kind::list) {
      top.node.items.push_back(std::move(n));
    } else if (!top.has_key) {
      if (n.kind != YamlNode::Kind::scalar || n.text.empty())
        fail_usage("a key must be a plain word", fmt::format("{}:{}", origin_, n.line));
      if (n.text.size() > 256) fail_usage("a key has more than 256 characters", fmt::format("{}:{}", origin_, n.line));
      if (top.node.pairs.size() >= most_keys)
        fail_usage(fmt::format("has more than {} keys", most_keys), fmt::format("{}:{}", origin_, n.line));
      top.key = std::move(n);
      top.has_key = true;
    } else {
      top.node.pairs.push_back({std::move(top.key), std::move(n)});
      top.has_key = false;
    }
  }

  struct Level {
    YamlNode node, key;
    bool has_key;
  };
  std::string origin_;
  std::vector<Level> stack_;
  size_t nodes_ = 0;
};

void check_utf8(std::string_view text, const std::string& origin) {
  int line = 1;
  uint32_t code = 0;
  for (size_t i = 0; i < text.size();) {
    const size_t n = decode_utf8(text, i, code);
    if (n == 0) fail_usage("is not UTF-8 text", fmt::format("{}:{}", origin, line));
    line += code == '\n';
    i += n;
  }
}

}  // namespace

YamlNode parse_yaml(std::string_view text, const std::string& origin) {
  const std::string name = origin.empty() ? "pipeline" : origin;
  if (text.size() > most_bytes)
    fail_usage(fmt::format("has {}; a pipeline file has at most {}", human_bytes(text.size()), human_bytes(most_bytes)), name);
  check_utf8(text, name);
  TreeBuilder builder(name);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return {};
    TreeBuilder second(name);
    if (parser.HandleNextDocument(second)) fail_usage("contains more than one document", name, "remove what follows '---'");
  } catch (const YAML::Exception& e) {
    fail_usage(e.msg, fmt::format("{}:{}", name, e.mark.line + 1));
  }
  return std::move(builder.root);
}

namespace {

bool plain(const std::string& s) {
  if (s.empty() || s == "null" || s == "Null" || s == "NULL") return false;
  const auto word = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
  const bool sign = s[0] == '-' || s[0] == '+';
  if (!word(s[0]) && s[0] != '/' && s[0] != '.' && !(sign && s.size() > 1 && (word(s[1]) || s[1] == '.'))) return false;
  if (s.starts_with("...") || s.starts_with("---")) return false;
  return std::all_of(s.begin() + sign, s.end(), [&](char c) { return word(c) || c == '/' || c == '.' || c == '+' || c == '-'; });
}

}  // namespace

std::string yaml_scalar(const std::string& bytes) {
  if (plain(bytes)) return bytes;
  const std::string s = text_of_bytes(bytes);
  std::string r = "\"";
  for (size_t i = 0; i < s.size();) {
    uint32_t code = 0;
    const size_t n = decode_utf8(s, i, code);
    if (code == '"' || code == '\\') r += '\\', r += s[i];
    else if (code < 0x20 || (code >= 0x7f && code < 0xa0)) r += fmt::format("\\x{:02x}", code);
    else if (code < 0x10000 && (is_control(code) || code >= 0xfffe)) r += fmt::format("\\u{:04x}", code);
    else if (is_control(code)) r += fmt::format("\\U{:08x}", code);
    else r.append(s, i, n);
    i += n;
  }
  return r + '"';
}

}  // namespace sg
