// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/plugins/hdf5/enzo.h"

namespace sg {

namespace {

constexpr size_t most_grids = 10000000;

struct Draft {
  EnzoGrid grid;
  size_t line = 0;
  int rank = 0;
  unsigned seen = 0;  // bits: dims, start, end, left, right
};

struct Links {
  std::map<int, int> same, finer;  // NextGridThisLevel, NextGridNextLevel
};

struct Parser {
  const std::string& path;
  size_t line = 0;

  [[noreturn]] void fail(std::string what, std::string hint = {}) const {
    fail_data(std::move(what), fmt::format("{}: line {}", path, line), std::move(hint));
  }
  // `rank` numbers of a value; the other axes keep what they are.
  template <class Set>
  void triple(std::string_view value, int rank, std::string_view key, Set set) const {
    const auto w = words(value);
    if (rank < 1 || int(w.size()) < rank) fail(fmt::format("{} has {} numbers for {} dimensions", key, w.size(), rank));
    for (int a = 0; a < rank; ++a) {
      const auto v = parse_double(w[size_t(a)]);
      if (!v || !std::isfinite(*v) || std::fabs(*v) > 1e15) fail(fmt::format("{} is '{}'", key, w[size_t(a)]), "a number");
      set(a, *v);
    }
  }
  void index_triple(std::string_view value, int rank, std::string_view key, std::array<long long, 3>& out) const {
    triple(value, rank, key, [&](int a, double v) {
      if (v != std::floor(v) || v < 0 || v > 1e9) fail(fmt::format("{} is {}", key, v), "a whole number");
      out[size_t(a)] = static_cast<long long>(v);
    });
  }

  void entry(Draft& d, EnzoHierarchy& h, std::string_view key, std::string_view value) const {
    EnzoGrid& g = d.grid;
    if (key == "GridRank") {
      const auto r = parse_int(value);
      if (!r || *r < 2 || *r > 3) fail(fmt::format("GridRank is '{}'", value), "2 or 3");
      d.rank = int(*r);
    } else if (key == "GridDimension") {
      index_triple(value, d.rank, key, g.dims), d.seen |= 1;
    } else if (key == "GridStartIndex") {
      index_triple(value, d.rank, key, g.start), d.seen |= 2;
    } else if (key == "GridEndIndex") {
      index_triple(value, d.rank, key, g.end), d.seen |= 4;
    } else if (key == "GridLeftEdge") {
      triple(value, d.rank, key, [&](int a, double v) { g.left[a] = v; }), d.seen |= 8;
    } else if (key == "GridRightEdge") {
      triple(value, d.rank, key, [&](int a, double v) { g.right[a] = v; }), d.seen |= 16;
    } else if (key == "Time") {
      if (!h.time) h.time = parse_double(value);
    } else if (key == "BaryonFileName") {
      g.file = std::string(value.substr(value.rfind('/') + 1));  // where it lay when it was written does not matter
    } else if (key == "NumberOfParticles") {
      if (const auto n = parse_int(value); n && *n > 0) h.particles += size_t(*n);
    }
  }

  void pointer(std::string_view text, Links& links) const {  // "Grid[1]->NextGridThisLevel = 0"
    const size_t open = text.find('['), close = text.find(']'), equal = text.find('=');
    if (open == text.npos || close == text.npos || close < open || equal == text.npos) fail("is not a pointer to a grid");
    const auto from = parse_int(trim(text.substr(open + 1, close - open - 1))), to = parse_int(trim(text.substr(equal + 1)));
    if (!from || !to || *from < 1 || *to < 0 || *from > int64_t(most_grids) || *to > int64_t(most_grids))
      fail("is not a pointer to a grid");
    const std::string_view name = trim(text.substr(close + 1, equal - close - 1));
    if (*to == 0) return;
    if (name == "->NextGridThisLevel") links.same[int(*from)] = int(*to);
    else if (name == "->NextGridNextLevel") links.finer[int(*from)] = int(*to);
  }
};

void check(const Draft& d, const std::string& path) {
  auto fail = [&](const std::string& what) {
    fail_data(fmt::format("grid {} {}", d.grid.number, what), fmt::format("{}: line {}", path, d.line), "the file is truncated or damaged");
  };
  if (d.seen != 31) fail("lacks its dimensions, indices or edges");
  for (int a = 0; a < d.rank; ++a) {
    const EnzoGrid& g = d.grid;
    const auto i = size_t(a);
    if (g.end[i] < g.start[i] || g.end[i] >= g.dims[i]) fail(fmt::format("extends from {} to {} of {}", g.start[i], g.end[i], g.dims[i]));
    if (!(g.right[a] > g.left[a])) fail(fmt::format("has edges at {} and {}", g.left[a], g.right[a]));
  }
}

}  // namespace

EnzoHierarchy parse_enzo_hierarchy(std::string_view text, const std::string& path) {
  EnzoHierarchy h;
  Parser parser{path};
  std::map<int, Draft> grids;
  Links links;
  Draft* now = nullptr;
  while (!text.empty()) {
    ++parser.line;
    const size_t end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    if (line.starts_with("Pointer:")) {
      parser.pointer(line.substr(8), links);
      continue;
    }
    const size_t equal = line.find('=');
    if (equal == line.npos) continue;
    const std::string_view key = trim(line.substr(0, equal)), value = trim(line.substr(equal + 1));
    if (key == "Grid") {
      const auto n = parse_int(value);
      if (!n || *n < 1 || *n > int64_t(most_grids)) parser.fail(fmt::format("Grid is '{}'", value), "expected a number of at least 1");
      const auto [it, fresh] = grids.try_emplace(int(*n));
      if (!fresh) parser.fail(fmt::format("grid {} appears twice", *n));
      now = &it->second;
      now->grid.number = int(*n), now->line = parser.line;
    } else if (now) {
      parser.entry(*now, h, key, value);
    }
  }
  if (grids.empty() || grids.begin()->first != 1) fail_data("contains no grid 1", path, "the file is truncated");
  h.rank = grids.begin()->second.rank;
  // From grid 1 along the pointers: siblings keep the level, children are one deeper.
  std::vector<std::pair<int, int>> open{{1, 0}};
  std::map<int, int> level;
  while (!open.empty()) {
    const auto [n, l] = open.back();
    open.pop_back();
    const auto it = grids.find(n);
    if (it == grids.end()) fail_data(fmt::format("points to grid {}, which does not exist", n), path, "the file is truncated");
    if (l > 60 || !level.try_emplace(n, l).second) fail_data(fmt::format("reaches grid {} twice", n), path, "the pointers form a cycle");
    if (const auto s = links.same.find(n); s != links.same.end()) open.emplace_back(s->second, l);
    if (const auto f = links.finer.find(n); f != links.finer.end()) open.emplace_back(f->second, l + 1);
  }
  for (auto& [n, d] : grids) {
    check(d, path);
    if (d.rank != h.rank) fail_data(fmt::format("grid {} has {} dimensions, grid 1 has {}", n, d.rank, h.rank), path);
    const auto l = level.find(n);
    if (l == level.end()) fail_data(fmt::format("has no pointer to grid {}", n), path, "the file is truncated");
    d.grid.level = l->second;
    h.grids.push_back(d.grid);
  }
  std::stable_sort(h.grids.begin(), h.grids.end(), [](const EnzoGrid& a, const EnzoGrid& b) { return a.level < b.level; });
  return h;
}

std::map<std::string, double> enzo_factors(std::string_view text) {
  std::map<int64_t, std::string> labels;
  std::map<int64_t, double> factors;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view line = trim(text.substr(0, end));
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    const size_t open = line.find('['), close = line.find(']'), equal = line.find('=');
    if (open == line.npos || close == line.npos || equal == line.npos || close < open || equal < close) continue;
    const auto i = parse_int(trim(line.substr(open + 1, close - open - 1)));
    const std::string_view value = trim(line.substr(equal + 1));
    if (!i) continue;
    if (line.substr(0, open) == "DataLabel") labels[*i] = std::string(value);
    if (line.substr(0, open) == "#DataCGSConversionFactor")
      if (const auto v = parse_double(value); v && std::isfinite(*v) && *v != 0) factors[*i] = *v;
  }
  std::map<std::string, double> r;
  for (const auto& [i, factor] : factors)
    if (const auto l = labels.find(i); l != labels.end()) r[l->second] = factor;
  return r;
}

}  // namespace sg
