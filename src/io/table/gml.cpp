// SPDX-License-Identifier: Apache-2.0
// GML graphs: a Collection of the tables "nodes" and "edges"; each key of a node or edge is a column. Values are numbers, strings
// and lists of them: keys of nested lists are joined by a point ("graphics.x"). Source: M. Himsolt, "GML: A portable Graph File
// Format", 1997.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/table/table_columns.h"

namespace sg {

namespace {

constexpr int deepest = 64;

struct Scanner {
  std::string_view text;
  const std::string& path;
  size_t p = 0;
  size_t line = 1;

  [[noreturn]] void fail(const std::string& what) const { fail_data(fmt::format("line {}: {}", line, what), path); }

  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

  void skip() {
    for (; p < text.size(); ++p) {
      if (text[p] == '#') p = std::min(text.find('\n', p), text.size());
      if (p == text.size() || !blank(text[p])) return;
      line += text[p] == '\n';
    }
  }
  bool at(char c) {
    skip();
    return p < text.size() && text[p] == c;
  }
  bool end() {
    skip();
    return p == text.size();
  }
  // Letters up to a blank or bracket.
  std::string_view word() {
    skip();
    const size_t begin = p;
    while (p < text.size() && !blank(text[p]) && text[p] != '[' && text[p] != ']' && text[p] != '"') ++p;
    return text.substr(begin, p - begin);
  }
  // A quoted string, with the entities for quotes and ampersands.
  std::string quoted() {
    const size_t close = text.find('"', p + 1);
    if (close == std::string_view::npos) fail("a string has no end");
    std::string s;
    for (size_t i = p + 1; i < close; ++i) {
      line += text[i] == '\n';
      if (text.substr(i, 6) == "&quot;") s += '"', i += 5;
      else if (text.substr(i, 5) == "&amp;") s += '&', i += 4;
      else s += text[i];
    }
    p = close + 1;
    return s;
  }

  // Calls value(name, text) for each value up to the ']' that ends this list; nested lists by their joined names.
  template <class F>
  void list(const std::string& prefix, int depth, F&& value) {
    if (depth > deepest) fail(fmt::format("lists are nested more than {} deep", deepest));
    while (!at(']')) {
      const std::string_view key = word();
      if (key.empty()) fail(p == text.size() ? "a list has no end" : "expected a key");
      const std::string name = prefix + std::string(key);
      if (at('[')) {
        ++p;
        list(name + ".", depth + 1, value);
      } else if (at('"')) {
        value(name, quoted());
      } else {
        const std::string_view v = word();
        if (v.empty()) fail(fmt::format("'{}' has no value", key));
        value(name, std::string(v));
      }
    }
    ++p;
  }
};

struct Graph {
  TableBuilder nodes, edges;
};

// The entries of "graph [ ... ]".
void read_graph(Scanner& in, Graph& g) {
  while (!in.at(']')) {
    const std::string_view key = in.word();
    if (key.empty()) in.fail(in.p == in.text.size() ? "a graph has no end" : "expected a key");
    if (in.at('[')) {
      ++in.p;
      TableBuilder* table = key == "node" ? &g.nodes : key == "edge" ? &g.edges : nullptr;
      if (table) table->begin_row();
      in.list("", 1, [&](const std::string& name, std::string value) {
        if (table) table->set(name, std::move(value));
      });
    } else if (in.at('"')) {
      in.quoted();
    } else {
      // Values of the graph itself; some writers declare columns by two words ("node_data size float").
      if (in.word().empty()) in.fail(fmt::format("'{}' has no value", key));
      if (key == "node_data" || key == "edge_data") in.word();
    }
  }
  ++in.p;
}

}  // namespace

Data read_gml(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  Scanner in{file.text(), path};
  Graph g;
  bool found = false;
  while (!in.end()) {
    const std::string_view key = in.word();
    if (key.empty()) in.fail("expected a key");
    if (in.at('[')) {
      ++in.p;
      if (key == "graph") read_graph(in, g), found = true;
      else in.list("", 1, [](const std::string&, const std::string&) {});
    } else if (in.at('"')) {
      in.quoted();
    } else if (in.word().empty()) {
      in.fail(fmt::format("'{}' has no value", key));
    }
  }
  if (!found) fail_data("contains no 'graph [ ... ]'", path);
  auto r = std::make_shared<Collection>();
  if (g.nodes.rows() > 0) r->parts.push_back({"nodes", g.nodes.build()});
  if (g.edges.rows() > 0) r->parts.push_back({"edges", g.edges.build()});
  if (r->parts.empty()) fail_data("its graph has neither nodes nor edges", path);
  return CollectionPtr(r);
}

}  // namespace sg
