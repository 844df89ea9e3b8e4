// SPDX-License-Identifier: Apache-2.0
// Clips lattices: sides of points, whole and cut cells, kept points and cut edges are bits of rows, 64 at a time; a number is a count of
// bits. Only cut cells are looked at one by one: once to find their case and count its pieces, once to write them by that case.
#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice.h"
#include "filter/mesh/clip/clip_pieces.h"
#include "filter/mesh/select/lattice_cells.h"
#include "filter/mesh/select/row_bits.h"
#include "filter/mesh/surface_builder.h"

namespace sg::clipping {

namespace {

constexpr size_t rows_per_chunk = 64;  // rows

class LatticeClip {
 public:
  explicit LatticeClip(const Job& job)
      : job_(job),
        values_(job.values()),
        g_(lattice_dims(job.in->mesh())),
        kind_(lattice_cell_kind(job.in->mesh())),
        table_(*clip_table(kind_.type)),
        lattice_(job.in->mesh()),
        bent_(lattice_.view().mode == LatticeView::Mode::listed),
        rows_(std::make_shared<LatticePoints>(LatticePoints{g_, {}, {}})),
        used_(rows_->bits),
        points_(rows_->ranks) {
    // Patterns of a lattice's own order of corners as patterns of the table; a cell's edges by axis and first corner.
    for (size_t p = 0; p < 256; ++p) {
      pattern_[p] = 0;
      for (size_t c = 0; c < 8; ++c) pattern_[p] |= uint8_t((p >> kind_.corner[c] & 1) << c);
    }
    const auto edges = table_.topology().edges;
    for (size_t e = 0; e < 12; ++e) {
      const int a = kind_.corner[edges[e][0]], b = kind_.corner[edges[e][1]];
      edge_[e] = {uint8_t((a ^ b) >> 1), uint8_t(a & b)};
    }
  }

  Build run() {
    if (const auto* grid = job_.in->as<CurvilinearGrid>()) rounding_ = rounding_of(grid->points, *job_.in);
    classify();
    find_cells();
    job_.context.check();
    find_points();
    return write();
  }

 private:
  // Bits of points strictly on our side, strictly on the other, and without a value.
  void classify() {
    for (Bits* b : {&kept_, &gone_, &missing_}) b->resize(g_.size());
    const bool above = (job_.keep.sign > 0) != job_.keep.outside;
    const double level = job_.keep.level;
    auto rows = [&](const auto* v) {
      return parallel_reduce(
          g_.rows(), rows_per_chunk, false,
          [&](size_t begin, size_t end) {
            bool holes = false;
            for (size_t row = begin; row < end; ++row) {
              const auto* x = v + row * g_.nx;
              uint64_t *missing = missing_.data() + row * g_.words, *kept = kept_.data() + row * g_.words,
                       *gone = gone_.data() + row * g_.words;
              std::fill_n(missing, g_.words, 0);
              if (!compare_row(x, g_.nx, level, above ? kept : gone, above ? gone : kept)) continue;
              for (size_t i = 0; i < g_.nx; ++i) missing[i >> 6] |= uint64_t(x[i] != x[i]) << (i & 63);
              holes = true;
            }
            return holes;
          },
          [](bool a, bool b) { return a || b; }, &job_.context);
    };
    holes_ = values_.f32 ? rows(values_.f32) : rows(values_.f64);
  }

  void find_cells() {
    const std::vector<uint8_t> states = cell_states(*job_.in);
    holes_ = holes_ || !states.empty();
    whole_.resize(g_.size());
    cut_.resize(g_.size());
    parallel_for(g_.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        const size_t j = row % g_.ny, k = row / g_.ny;
        for (size_t w = 0; w < g_.words; ++w) {
          uint64_t kept = 0, gone = 0, out = ~uint64_t(0);
          if (j + 1 < g_.ny && k + 1 < g_.nz) {
            out = ~g_.cell_mask(w);
            for (const size_t r : {g_.row(j, k), g_.row(j + 1, k), g_.row(j, k + 1), g_.row(j + 1, k + 1)}) {
              kept |= both_ends(kept_, r, w), gone |= both_ends(gone_, r, w);
              if (holes_) out |= both_ends(missing_, r, w);
            }
            if (!states.empty())
              for (size_t i = 64 * w; i < std::min(64 * w + 64, g_.nx - 1); ++i)
                out |= uint64_t(states[i + (g_.nx - 1) * (j + (g_.ny - 1) * k)] != cell_visible) << (i & 63);
          }
          whole_[row * g_.words + w] = ~gone & ~out & (job_.keep.outside ? kept : ~uint64_t(0));
          cut_[row * g_.words + w] = gone & kept & ~out;
        }
      }
    });
  }

  uint64_t next_point(const Bits& b, size_t row, size_t w) const { return b[row + w] >> 1 | (w + 1 < g_.words ? b[row + w + 1] << 63 : 0); }
  uint64_t both_ends(const Bits& b, size_t row, size_t w) const { return b[row + w] | next_point(b, row, w); }

  // Points that are kept, and cut edges along each axis.
  void find_points() {
    Bits near;
    used_points(g_, whole_, used_);
    used_points(g_, cut_, near);
    for (Bits& e : edges_) e.resize(g_.size());
    parallel_for(g_.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        const size_t j = row % g_.ny, k = row / g_.ny;
        for (size_t w = 0; w < g_.words; ++w) {
          const size_t at = row * g_.words + w;
          used_[at] |= near[at] & ~gone_[at] & ~missing_[at];
          const uint64_t kept = kept_[at], gone = gone_[at];
          edges_[0][at] = ((kept & next_point(gone_, row * g_.words, w)) | (gone & next_point(kept_, row * g_.words, w))) & g_.cell_mask(w);
          for (size_t a = 1; a < 3; ++a) {
            edges_[a][at] = 0;
            if (a == 1 ? j + 1 >= g_.ny : k + 1 >= g_.nz) continue;
            const size_t o = g_.row(j + (a == 1), k + (a == 2)) + w;
            edges_[a][at] = (kept & gone_[o]) | (gone & kept_[o]);
          }
          for (size_t a = 0; holes_ && a < 3; ++a) edges_[a][at] &= beside_cut(a, j, k, w);
        }
      }
    });
    points_.number(used_);
    for (size_t a = 0; a < 3; ++a) ranks_[a].number(edges_[a]);
  }

  // Edges along axis a that a cut cell has.
  uint64_t beside_cut(size_t a, size_t j, size_t k, size_t w) const {
    uint64_t r = 0;
    for (size_t dj = 0; dj < (a == 1 ? 1u : 2u); ++dj)
      for (size_t dk = 0; dk < (a == 2 ? 1u : 2u); ++dk) {
        if (j < dj || k < dk) continue;
        const size_t row = g_.row(j - dj, k - dk);
        r |= cut_[row + w];
        if (a != 0) r |= cut_[row + w] << 1 | (w > 0 ? cut_[row + w - 1] >> 63 : 0);
      }
    return r;
  }

  Vec3 position(size_t id) const {
    return lattice_.view().position(uint32_t(id % g_.nx), uint32_t(id / g_.nx % g_.ny), uint32_t(id / g_.nx / g_.ny));
  }
  CellClipper clipper() const {
    const auto place = [this](size_t id) { return position(id); };
    CellClipper c = bent_ ? CellClipper(job_.keep, place, rounding_) : CellClipper(job_.keep, {});
    if (job_.curved) c.follow(job_.curved, place);
    return c;
  }

  const CellPieces& pieces(CellClipper& clipper, size_t i, size_t j, size_t k, int folded) const {
    int64_t ids[8];
    double v[8];
    for (size_t c = 0; c < 8; ++c) {
      const size_t q = kind_.corner[c];
      const size_t id = i + (q & 1) + g_.nx * (j + (q >> 1 & 1) + g_.ny * (k + (q >> 2)));
      ids[c] = int64_t(id);
      v[c] = values_(id);
    }
    return clipper.solid(table_, ids, v, folded);
  }

  uint32_t cut_number(uint64_t name) const {
    const auto a = size_t(name >> 32), b = size_t(name & 0xffffffffu);
    const size_t axis = b - a == 1 ? 0 : b - a == g_.nx ? 1 : 2;
    return uint32_t(cut_start_[axis]) + ranks_[axis](a / g_.nx * g_.words, a % g_.nx);
  }

  template <class F>
  void each_cut(size_t first_row, size_t last_row, F&& f) const {
    for (size_t row = first_row; row < last_row; ++row)
      for (size_t w = 0; w < g_.words; ++w)
        if (const uint64_t cut = cut_[row * g_.words + w]) f(row % g_.ny, row / g_.ny, w, cut);
  }

  // The case of each cut cell of some rows: a variant of the table; from `listed` on, one by one.
  static constexpr uint16_t listed = 0xfffe, folded = 0xffff;
  void count_cut(size_t begin, size_t end, PieceCounts& n, std::vector<uint16_t>& cases) const {
    CellClipper clipper = this->clipper();
    each_cut(begin, end, [&](size_t j, size_t k, size_t w, uint64_t left) {
      const size_t rows[4] = {g_.row(j, k), g_.row(j + 1, k), g_.row(j, k + 1), g_.row(j + 1, k + 1)};
      const Bits& inside = job_.keep.outside ? gone_ : kept_;
      uint64_t in[8], zero = 0;
      for (size_t q = 0; q < 4; ++q) {
        const size_t r = rows[q];
        in[2 * q] = inside[r + w], in[2 * q + 1] = next_point(inside, r, w);
        zero |= ~(kept_[r + w] | gone_[r + w]) | ~(next_point(kept_, r, w) | next_point(gone_, r, w));
      }
      for (; left; left &= left - 1) {
        const auto bit = size_t(std::countr_zero(left)), i = w * 64 + bit;
        uint16_t found = zero >> bit & 1 ? listed : 0;
        if (found == 0) {
          size_t p = 0;
          for (size_t q = 0; q < 8; ++q) p |= (in[q] >> bit & 1) << q;
          found = find_case(pattern_[p], i, j, k);
        }
        if (found < listed) {
          const Region& r = region(found);
          n.cells += r.pieces.size(), n.ids += r.ids, n.inner += r.inner.size();
          for (const Inner& inner : r.inner) n.inner_ids += count_bits(inner.corners);
        } else {
          count_pieces(clipper, pieces(clipper, i, j, k, found == folded ? 1 : -1), n, nullptr, [](uint64_t) {});
          found = clipper.folded() ? folded : listed;
          if (clipper.split()) split_.store(true, std::memory_order_relaxed);
        }
        cases.push_back(found);
      }
    });
  }

  const Region& region(uint16_t found) const { return job_.keep.outside ? table_.at(found).out : table_.at(found).in; }

  // Heights of the corners over the level in the order of the table.
  void heights(size_t i, size_t j, size_t k, double* h) const {
    const size_t first = i + g_.nx * (j + g_.ny * k);
    for (size_t c = 0; c < 8; ++c) {
      const size_t q = kind_.corner[c];
      h[c] = job_.keep.sign * (values_(first + (q & 1) + g_.nx * ((q >> 1 & 1) + g_.ny * (q >> 2))) - job_.keep.level);
    }
  }

  // Whether faces that the level crosses are not flat. Fills in the positions of the corners in the order of the table.
  bool has_bent_faces(size_t i, size_t j, size_t k, Vec3* places) const {
    int64_t ids[8];
    double v[8];
    for (size_t c = 0; c < 8; ++c) {
      const size_t q = kind_.corner[c], id = i + (q & 1) + g_.nx * (j + (q >> 1 & 1) + g_.ny * (k + (q >> 2)));
      ids[c] = int64_t(id), v[c] = values_(id), places[c] = position(id);
    }
    return CellClipper::bent_faces(table_, ids, v, places, job_.keep, rounding_) != 0;
  }

  uint16_t find_case(uint32_t pattern, size_t i, size_t j, size_t k) const {
    double h[8];
    uint32_t joined = 0;
    const uint32_t ambiguous = table_.ambiguous(pattern);
    if (ambiguous) heights(i, j, k, h);
    for (uint32_t left = ambiguous; left; left &= left - 1) {
      const auto f = size_t(std::countr_zero(left));
      const auto face = table_.topology().face(f);
      joined |= uint32_t(joined_across(h[face[0]], h[face[1]], h[face[2]], h[face[3]])) << f;
    }
    const uint32_t found = table_.variant(pattern, joined);
    Vec3 places[8];
    if (bent_ && has_bent_faces(i, j, k, places)) return listed;
    if (job_.keep.flat || table_.at(found).cones.empty()) return uint16_t(found);
    if (!ambiguous) heights(i, j, k, h);
    const Sides& sides = table_.at(found);
    if (table_.folded(sides, h, bent_ ? places : nullptr)) return folded;
    return job_.curved && folds_when_moved(sides, h, i, j, k) ? folded : uint16_t(found);
  }
  bool folds_when_moved(const Sides& sides, const double* h, size_t i, size_t j, size_t k) const {
    Vec3 places[8];
    for (size_t c = 0; c < 8; ++c) {
      const size_t q = kind_.corner[c];
      places[c] = position(i + (q & 1) + g_.nx * (j + (q >> 1 & 1) + g_.ny * (k + (q >> 2))));
    }
    double shares[12];
    job_.curved.shares(table_.topology(), (sides.in.used | sides.out.used) >> first_cut, h, places, shares);
    return table_.folded(sides, h, places, shares);
  }

  // Numbers of everything on a cell: its corners and the cuts of its edges, whether they are used or not.
  struct Codes {
    uint32_t at[max_codes];
  };
  void number_codes(size_t i, size_t j, size_t k, Codes& codes) const {
    const size_t rows[4] = {g_.row(j, k), g_.row(j + 1, k), g_.row(j, k + 1), g_.row(j + 1, k + 1)};
    auto both = [&](const BitRanks& ranks, size_t row, uint32_t* first, uint32_t* second) {
      *first = ranks(row, i);
      *second = *first + uint32_t((*ranks.bits)[row + (i >> 6)] >> (i & 63) & 1);
    };
    uint32_t corner[8], cut[3][8];
    for (size_t q = 0; q < 4; ++q) {
      both(points_, rows[q], corner + 2 * q, corner + 2 * q + 1);
      cut[0][2 * q] = ranks_[0](rows[q], i);
    }
    both(ranks_[1], rows[0], cut[1], cut[1] + 1);
    both(ranks_[1], rows[2], cut[1] + 4, cut[1] + 5);
    both(ranks_[2], rows[0], cut[2], cut[2] + 1);
    both(ranks_[2], rows[1], cut[2] + 2, cut[2] + 3);
    for (size_t c = 0; c < 8; ++c) codes.at[c] = corner[kind_.corner[c]];
    for (size_t e = 0; e < 12; ++e)
      codes.at[first_cut + e] = uint32_t(points_.total + cut_start_[edge_[e].axis]) + cut[edge_[e].axis][edge_[e].corner];
  }

  // Shares of the cell's corners in an inner point that is the mean of others.
  void write_inner(const Inner& inner, const double* h, size_t first, PieceWriter& to) const {
    double weight[8] = {};
    const double share = 1 / double(inner.of.size());
    for (const uint8_t code : inner.of) {
      if (code < first_cut) weight[code] += share;
      else {
        const auto e = table_.topology().edges[size_t(code - first_cut)];
        const double t = h[e[0]] / (h[e[0]] - h[e[1]]);
        weight[e[0]] += share * (1 - t), weight[e[1]] += share * t;
      }
    }
    for (uint32_t left = inner.corners; left; left &= left - 1) {
      const auto c = size_t(std::countr_zero(left)), q = size_t(kind_.corner[c]);
      to.build.inner_points[to.at.inner_ids] = uint32_t(first + (q & 1) + g_.nx * ((q >> 1 & 1) + g_.ny * (q >> 2)));
      to.build.inner_weights[to.at.inner_ids++] = weight[c];
    }
    to.build.inner_first[++to.at.inner] = to.at.inner_ids;
  }

  void write_case(uint16_t found, size_t i, size_t j, size_t k, PieceWriter& to) const {
    const Region& r = region(found);
    Codes codes;
    number_codes(i, j, k, codes);
    if (!r.inner.empty()) {
      double h[8];
      heights(i, j, k, h);
      for (size_t n = 0; n < r.inner.size(); ++n) {
        codes.at[first_inner + n] = uint32_t(to.first_inner + to.at.inner);
        write_inner(r.inner[n], h, i + g_.nx * (j + g_.ny * k), to);
      }
    }
    const auto cell = uint32_t(i + (g_.nx - 1) * (j + (g_.ny - 1) * k));
    int32_t* ids = to.connectivity + to.at.ids;
    for (const Piece& p : r.pieces) {
      to.build.source[to.at.cells] = cell;
      to.types[to.at.cells] = uint8_t(p.type);
      to.offsets[to.at.cells++] = int32_t(ids - to.connectivity);
      for (size_t c = 0; c < p.count; ++c) *ids++ = int32_t(codes.at[p.v[c]]);
    }
    to.at.ids = size_t(ids - to.connectivity);
  }

  Build write() {
    const size_t chunks = (g_.rows() + rows_per_chunk - 1) / rows_per_chunk;
    std::vector<size_t> cell(chunks);
    std::vector<PieceCounts> piece(chunks);
    std::vector<std::vector<uint16_t>> cases(chunks);
    parallel_for(
        g_.rows(), rows_per_chunk,
        [&](size_t begin, size_t end) {
          size_t n = 0, cut = 0;
          for (size_t w = begin * g_.words; w < end * g_.words; ++w) n += count_bits(whole_[w]), cut += count_bits(cut_[w]);
          cell[begin / rows_per_chunk] = n;
          cases[begin / rows_per_chunk].reserve(cut);
          count_cut(begin, end, piece[begin / rows_per_chunk], cases[begin / rows_per_chunk]);
        },
        &job_.context);
    const size_t whole = exclusive_scan(cell);
    PieceCounts sum;
    for (PieceCounts& p : piece) {
      const PieceCounts n = p;
      p = sum;
      sum.add(n);
    }
    cut_start_[0] = 0, cut_start_[1] = ranks_[0].total, cut_start_[2] = cut_start_[1] + ranks_[1].total;
    const size_t cuts = cut_start_[2] + ranks_[2].total;
    if (points_.total + cuts + sum.inner > size_t(INT32_MAX))
      fail_usage("the result has more than 2^31 points", "clip", "take a part of the mesh first");
    Build b;
    int32_t *connectivity = nullptr, *offsets = nullptr;
    uint8_t* types = nullptr;
    allocate(b, whole, 8 * whole, sum, &connectivity, &offsets, &types);
    parallel_for(
        g_.rows(), rows_per_chunk,
        [&](size_t begin, size_t end) {
          const size_t chunk = begin / rows_per_chunk, first = cell[chunk], last = chunk + 1 < chunks ? cell[chunk + 1] : whole;
          write_lattice_cells(g_, kind_, whole_, points_, begin, end, connectivity + 8 * first, b.source.data() + first);
          for (size_t c = first; c < last; ++c) offsets[c] = int32_t(8 * c);
          std::fill(types + first, types + last, uint8_t(kind_.type));
          CellClipper clipper = this->clipper();
          PieceWriter writer{b, connectivity, offsets, types, points_.total, points_.total + cuts, piece[chunk], {}, {}};
          writer.at.cells += whole, writer.at.ids += 8 * whole;
          const uint16_t* next = cases[chunk].data();
          each_cut(begin, end, [&](size_t j, size_t k, size_t w, uint64_t left) {
            for (; left; left &= left - 1, ++next) {
              const size_t i = w * 64 + size_t(std::countr_zero(left));
              if (*next < listed) write_case(*next, i, j, k, writer);
              else
                writer.write(
                    clipper, pieces(clipper, i, j, k, *next == folded), i + (g_.nx - 1) * (j + (g_.ny - 1) * k),
                    [&](uint64_t id) { return points_(size_t(id) / g_.nx * g_.words, size_t(id) % g_.nx); },
                    [&](uint64_t name) { return cut_number(name); });
            }
          });
        },
        &job_.context);
    const std::span<int32_t> ids(connectivity, b.connectivity.count());
    if (split_) merge_shared(b, points_.total + cuts, {&ids, 1});
    b.kept = points_.total;
    b.rows = rows_;
    b.cuts.resize(cuts);
    const size_t step[3] = {1, g_.nx, g_.nx * g_.ny};
    for (size_t a = 0; a < 3; ++a)
      parallel_for(g_.rows(), rows_per_chunk, [&](size_t begin, size_t end) {
        size_t at = cut_start_[a] + ranks_[a].before[begin * g_.words];
        for (size_t row = begin; row < end; ++row)
          for (size_t w = 0; w < g_.words; ++w)
            for (uint64_t left = edges_[a][row * g_.words + w]; left; left &= left - 1) {
              const size_t id = row * g_.nx + w * 64 + size_t(std::countr_zero(left));
              b.cuts[at++] = edge_name(id, id + step[a]);
            }
      });
    return b;
  }

  const Job& job_;
  Values values_;
  BitRows g_;
  LatticeCellKind kind_;
  const ClipTable& table_;
  Lattice lattice_;
  bool bent_;            // cells have shapes of their own
  double rounding_ = 0;  // of coordinates, where bent_
  mutable std::atomic<bool> split_{false};
  bool holes_ = false;  // values that are missing or cells that are hidden
  struct Edge {
    uint8_t axis, corner;
  };
  uint8_t pattern_[256];
  Edge edge_[12];
  Bits kept_, gone_, missing_, whole_, cut_, edges_[3];
  std::shared_ptr<LatticePoints> rows_;
  Bits& used_;
  BitRanks& points_;
  BitRanks ranks_[3];
  size_t cut_start_[3] = {0, 0, 0};
};

}  // namespace

Build clip_lattice(const Job& job) { return LatticeClip(job).run(); }

}  // namespace sg::clipping
