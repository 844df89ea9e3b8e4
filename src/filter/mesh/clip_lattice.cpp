// SPDX-License-Identifier: Apache-2.0
// Clips lattices: sides of points, whole and cut cells, kept points and cut edges are bits of rows, 64 at a time; a number is a count of
// bits. Only cut cells are looked at one by one, twice: to count their pieces, and to write them.
#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice.h"
#include "filter/mesh/clip_pieces.h"
#include "filter/mesh/lattice_cells.h"
#include "filter/mesh/surface_builder.h"

namespace sg::clipping {

namespace {

constexpr size_t grain = 64;  // rows

class LatticeClip {
 public:
  explicit LatticeClip(const Job& job)
      : job_(job),
        values_(job.values()),
        g_(lattice_dims(job.in->mesh())),
        kind_(lattice_cell_kind(job.in->mesh())),
        table_(*clip_table(kind_.type)) {}

  Build run() {
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
          g_.rows(), grain, false,
          [&](size_t begin, size_t end) {
            bool holes = false;
            uint8_t more[64], less[64];
            for (size_t row = begin; row < end; ++row)
              for (size_t w = 0; w < g_.words; ++w) {
                const size_t n = std::min<size_t>(64, g_.nx - 64 * w);
                const auto* x = v + row * g_.nx + 64 * w;
                if (n < 64) std::fill_n(more, 64, uint8_t(0)), std::fill_n(less, 64, uint8_t(0));
                bool nan = false;
                for (size_t i = 0; i < n; ++i) more[i] = double(x[i]) > level, less[i] = double(x[i]) < level, nan |= x[i] != x[i];
                const size_t at = row * g_.words + w;
                kept_[at] = packed_bits(above ? more : less);
                gone_[at] = packed_bits(above ? less : more);
                missing_[at] = 0;
                for (size_t i = 0; nan && i < n; ++i) missing_[at] |= uint64_t(x[i] != x[i]) << i;
                holes |= nan;
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
    parallel_for(g_.rows(), grain, [&](size_t begin, size_t end) {
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
    parallel_for(g_.rows(), grain, [&](size_t begin, size_t end) {
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
        for (uint64_t left = cut_[row * g_.words + w]; left; left &= left - 1)
          f(w * 64 + size_t(std::countr_zero(left)), row % g_.ny, row / g_.ny);
  }

  Build write() {
    const size_t chunks = (g_.rows() + grain - 1) / grain;
    std::vector<size_t> cell(chunks);
    std::vector<PieceCounts> piece(chunks);
    folded_.assign(g_.size(), 0);
    parallel_for(
        g_.rows(), grain,
        [&](size_t begin, size_t end) {
          size_t n = 0;
          for (size_t w = begin * g_.words; w < end * g_.words; ++w) n += count_bits(whole_[w]);
          cell[begin / grain] = n;
          CellClipper clipper(job_.keep, {});
          PieceCounts& counts = piece[begin / grain];
          each_cut(begin, end, [&](size_t i, size_t j, size_t k) {
            count_pieces(clipper, pieces(clipper, i, j, k, -1), counts, nullptr, [](uint64_t) {});
            folded_[g_.row(j, k) + (i >> 6)] |= uint64_t(clipper.folded()) << (i & 63);
          });
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
        g_.rows(), grain,
        [&](size_t begin, size_t end) {
          const size_t chunk = begin / grain, first = cell[chunk], last = chunk + 1 < chunks ? cell[chunk + 1] : whole;
          write_lattice_cells(g_, kind_, whole_, points_, begin, end, connectivity + 8 * first, b.source.data() + first);
          for (size_t c = first; c < last; ++c) offsets[c] = int32_t(8 * c);
          std::fill(types + first, types + last, uint8_t(kind_.type));
          CellClipper clipper(job_.keep, {});
          PieceWriter writer{b, connectivity, offsets, types, points_.total, points_.total + cuts, piece[chunk], {}, {}};
          writer.at.cells += whole, writer.at.ids += 8 * whole;
          each_cut(begin, end, [&](size_t i, size_t j, size_t k) {
            writer.write(
                clipper, pieces(clipper, i, j, k, int(folded_[g_.row(j, k) + (i >> 6)] >> (i & 63) & 1)),
                i + (g_.nx - 1) * (j + (g_.ny - 1) * k),
                [&](uint64_t id) { return points_(size_t(id) / g_.nx * g_.words, size_t(id) % g_.nx); },
                [&](uint64_t name) { return cut_number(name); });
          });
        },
        &job_.context);
    b.points.resize(points_.total);
    write_lattice_points(g_, points_, b.points.data());
    b.cuts.resize(cuts);
    const size_t step[3] = {1, g_.nx, g_.nx * g_.ny};
    for (size_t a = 0; a < 3; ++a)
      parallel_for(g_.rows(), grain, [&](size_t begin, size_t end) {
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
  bool holes_ = false;  // values that are missing or cells that are hidden
  Bits kept_, gone_, missing_, whole_, cut_, used_, edges_[3], folded_;
  BitRanks points_, ranks_[3];
  size_t cut_start_[3] = {0, 0, 0};
};

}  // namespace

Build clip_lattice(const Job& job) { return LatticeClip(job).run(); }

}  // namespace sg::clipping
