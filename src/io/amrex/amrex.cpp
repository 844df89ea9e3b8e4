// SPDX-License-Identifier: Apache-2.0
// AMReX and BoxLib plotfiles: all levels as one AmrGrid, with the cells that a finer level covers marked.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/amrex/plotfile.h"
#include "io/formats.h"
#include "io/mesh/unread.h"

namespace sg {

using namespace amrex;

namespace {

/// A FAB whose first line is read and whose bytes are known to be there.
struct OpenFab {
  const std::byte* data = nullptr;                       // first number of the first component
  std::array<size_t, 3> cells{1, 1, 1}, first{0, 0, 0};  // of the FAB; where the box begins in it
  size_t bytes = 8;
  bool big_endian = false;
};

[[noreturn]] void fail_fab(const Fab& f, const std::string& problem) {
  fail_data(fmt::format("byte {}: {}", f.offset, problem), f.file,
            "FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1)))((0,0,0) (7,7,7) (0,0,0)) 4");
}

// The format: ((8, (64 11 52 ...)),(8, (8 7 6 5 4 3 2 1))) — bits of a number, then which byte comes where.
void take_format(std::string_view& line, const Fab& f, OpenFab& o) {
  std::vector<int64_t> n;
  int depth = 0;
  size_t i = 0;
  for (; i < line.size(); ++i) {
    if (line[i] == '(') ++depth;
    else if (line[i] == ')') {
      if (--depth == 0) break;
    } else if (line[i] >= '0' && line[i] <= '9') {
      int64_t v = 0;
      while (i < line.size() && line[i] >= '0' && line[i] <= '9' && v < 1000000) v = v * 10 + (line[i++] - '0');
      n.push_back(v);
      --i;
    }
  }
  if (i == line.size() || n.size() < 10 || n[0] != 8) fail_fab(f, "the number format is not recognised");
  const int64_t bits = n[1], order = n[9];
  if ((bits != 64 && bits != 32) || order != bits / 8 || int64_t(n.size()) != 10 + order)
    fail_fab(f, fmt::format("numbers of {} bits are not supported", bits));
  o.bytes = size_t(order);
  bool up = true, down = true;
  for (int64_t k = 0; k < order; ++k) up = up && n[size_t(10 + k)] == k + 1, down = down && n[size_t(10 + k)] == order - k;
  if (!up && !down) fail_fab(f, "a mixed byte order is not supported");
  o.big_endian = up;
  line.remove_prefix(i + 1);
}

OpenFab open_fab(const MappedFile& file, const Fab& f, const Box& box, int dimension, size_t components) {
  OpenFab o;
  if (f.offset >= file.size()) fail_fab(f, fmt::format("was expected, but the file has {} bytes", file.size()));
  std::string_view text = file.text().substr(f.offset);
  const size_t end = text.substr(0, 4096).find('\n');
  if (end == std::string_view::npos || !text.starts_with("FAB")) fail_fab(f, "expected a FAB here");
  std::string_view line = text.substr(3, end - 3);
  take_format(line, f, o);
  Box have;
  if (!take_box(line, dimension, have)) fail_fab(f, "the box of the FAB is not valid");
  const auto n = parse_int(line);
  if (!n || *n < 0 || uint64_t(*n) != components)
    fail_fab(f, fmt::format("'{}' components, expected {}", trim(line).substr(0, 20), components));
  uint64_t need = o.bytes;
  if (!multiply(need, components, need)) fail_fab(f, "too many components");
  for (size_t a = 0; a < 3; ++a) {
    if (have.lo[a] > box.lo[a] || have.hi[a] < box.hi[a]) fail_fab(f, "the FAB does not cover its box");
    o.cells[a] = size_t(have.hi[a] - have.lo[a]) + 1;
    o.first[a] = size_t(box.lo[a] - have.lo[a]);
    if (!multiply(need, o.cells[a], need)) fail_fab(f, "the box of the FAB is too large");
  }
  if (need > text.size() - end - 1) fail_fab(f, fmt::format("the FAB needs {} bytes, but {} are left", need, text.size() - end - 1));
  o.data = file.data() + f.offset + end + 1;
  return o;
}

template <class T>
void copy_component(const OpenFab& o, const AmrGrid::Patch& patch, size_t component, T* out) {
  const auto n = patch.cells();
  const std::byte* from = o.data + component * o.cells[0] * o.cells[1] * o.cells[2] * o.bytes;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j) {
      const std::byte* row = from + (o.first[0] + o.cells[0] * (o.first[1] + j + o.cells[1] * (o.first[2] + k))) * o.bytes;
      for (size_t i = 0; i < n[0]; ++i)
        *out++ = o.bytes == 8 ? T(load<double>(row + 8 * i, o.big_endian)) : T(load<float>(row + 4 * i, o.big_endian));
    }
}

long long floor_divide(long long a, long long b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// Marks the cells of a level that lie under patches of the next one.
void mark_refined(const AmrGrid& g, size_t level, uint8_t* ghost) {
  const auto& ratio = g.levels[level + 1].ratio;
  std::vector<Box> covered;
  for (const auto& fine : g.levels[level + 1].patches) {
    Box b;
    for (size_t a = 0; a < 3; ++a) b.lo[a] = floor_divide(fine.lo[a], ratio[a]), b.hi[a] = floor_divide(fine.hi[a], ratio[a]);
    covered.push_back(b);
  }
  std::sort(covered.begin(), covered.end(), [](const Box& a, const Box& b) { return a.lo[0] < b.lo[0]; });
  const auto& patches = g.levels[level].patches;
  parallel_for(patches.size(), 1, [&](size_t p, size_t) {
    const auto& coarse = patches[p];
    const auto n = coarse.cells();
    for (const Box& b : covered) {
      if (b.lo[0] > coarse.hi[0]) break;
      std::array<long long, 3> lo{}, hi{};
      bool meet = true;
      for (size_t a = 0; a < 3; ++a) {
        lo[a] = std::max(b.lo[a], coarse.lo[a]), hi[a] = std::min(b.hi[a], coarse.hi[a]);
        meet = meet && lo[a] <= hi[a];
      }
      if (!meet) continue;
      for (long long k = lo[2]; k <= hi[2]; ++k)
        for (long long j = lo[1]; j <= hi[1]; ++j) {
          const size_t row = size_t(lo[0] - coarse.lo[0]) + n[0] * (size_t(j - coarse.lo[1]) + n[1] * size_t(k - coarse.lo[2]));
          std::fill_n(ghost + coarse.cell_offset + row, size_t(hi[0] - lo[0] + 1), uint8_t(ghost_refined_cell));
        }
    }
  });
}

/// The grid of patches, without the numbers.
AmrGrid make_grid(const Plotfile& p, const std::string& path) {
  AmrGrid g;
  g.dimension = p.dimension;
  for (int a = 0; a < p.dimension; ++a) g.origin[a] = p.lo[a] - double(p.domain.lo[size_t(a)]) * p.levels[0].spacing[a];
  uint64_t cells = 0, points = 0;
  for (const Level& l : p.levels) {
    AmrGrid::Level level;
    level.spacing = l.spacing, level.ratio = l.ratio;
    if (p.dimension == 2) level.spacing.z = 1;
    for (const Box& b : l.boxes) {
      AmrGrid::Patch patch;
      patch.lo = b.lo, patch.hi = b.hi, patch.cell_offset = cells, patch.point_offset = points;
      const auto n = patch.cells();
      uint64_t c = 1, q = 1;
      for (size_t a = 0; a < size_t(p.dimension); ++a)
        if (!multiply(c, n[a], c) || !multiply(q, n[a] + 1, q)) fail_data("a box has too many cells to count", path);
      if (!add(cells, c, cells) || !add(points, q, points)) fail_data("the boxes have too many cells to count", path);
      level.patches.push_back(patch);
    }
    g.levels.push_back(std::move(level));
  }
  return g;
}

}  // namespace

bool sniff_amrex_folder(const std::string& path) {
  if (!file_exists(path + "/Header") || is_folder(path + "/Header")) return false;
  const MappedFile f(path + "/Header");
  const auto w = words(f.text().substr(0, 200));
  if (w.size() < 2 || !parse_int(w[1])) return false;
  return w[0].starts_with("HyperCLaw") || w[0].starts_with("NavierStokes") || w[0].starts_with("AMReX") || is_folder(path + "/Level_0");
}

std::vector<double> times_amrex(const std::string& path, const ReadOptions&, Context&) { return {read_headers(path).time}; }

Data read_amrex(const std::string& path, const ReadOptions& options, Context& context) {
  const Plotfile p = read_headers(path);
  chosen_step({p.time}, options, path);  // refuses a step that is not there
  if (p.names.empty()) fail_data("names no variables", path + "/Header");
  AmrGrid g = make_grid(p, path + "/Header");
  const size_t cells = cell_count(g);

  std::vector<size_t> wanted;
  for (size_t i = 0; i < p.names.size(); ++i)
    if (is_wanted(options.fields, p.names[i])) wanted.push_back(i);

  // All FABs are found and measured before memory is allocated: their bytes back every cell.
  struct Work {
    OpenFab fab;
    AmrGrid::Patch patch;
  };
  std::vector<Work> work;
  std::vector<std::pair<std::string, MappedFile>> files;
  bool doubles = false;
  for (size_t l = 0; l < p.levels.size(); ++l)
    for (size_t b = 0; b < p.levels[l].boxes.size(); ++b) {
      const Fab& f = p.levels[l].fabs[b];
      auto at = std::find_if(files.rbegin(), files.rend(), [&](const auto& e) { return e.first == f.file; });
      if (at == files.rend()) files.emplace_back(f.file, MappedFile(f.file)), at = files.rbegin();
      const OpenFab o = open_fab(at->second, f, p.levels[l].boxes[b], p.dimension, p.names.size());
      doubles = doubles || o.bytes == 8;
      work.push_back({o, g.levels[l].patches[b]});
    }

  // Boxes may share bytes by mistake or malice: more cells than all files hold are refused.
  uint64_t held = 0;
  for (const auto& f : files) held += f.second.size();
  if (cells > held / 4 / std::max<size_t>(p.names.size(), 1))
    fail_data(fmt::format("{} cells, but its files hold {}", cells, human_bytes(held)), path);

  DatasetParts d;
  const ElementType type = doubles ? ElementType::f64 : ElementType::f32;
  size_t done = 0;
  for (const size_t i : wanted) {
    context.check();
    context.progress(double(done++) / double(wanted.size()), "reading patches");
    if (options.header_only) {
      d.fields.add({p.names[i], Association::cell, unread_values(type, cells), "", Role::none});
      continue;
    }
    std::byte* out = nullptr;
    Array a = Array::make_raw(type, cells, 1, &out);
    parallel_for(work.size(), 1, [&](size_t w, size_t) {
      const Work& k = work[w];
      if (doubles) copy_component(k.fab, k.patch, i, reinterpret_cast<double*>(out) + k.patch.cell_offset);
      else copy_component(k.fab, k.patch, i, reinterpret_cast<float*>(out) + k.patch.cell_offset);
    });
    d.fields.add({p.names[i], Association::cell, std::move(a), "", Role::none});
  }
  if (g.levels.size() > 1) {
    std::vector<uint8_t> ghost(cells);
    for (size_t l = 0; l + 1 < g.levels.size(); ++l) mark_refined(g, l, ghost.data());
    d.cell_ghost = Array::from_vector(std::move(ghost));
  }
  d.mesh = std::move(g);
  if (std::isfinite(p.time)) d.time = p.time;
  return make_dataset(std::move(d));
}

}  // namespace sg
