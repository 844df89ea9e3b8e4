// SPDX-License-Identifier: Apache-2.0
// Clips unstructured meshes: whole cells by a bit each, cut ones cell by cell, twice: to count, and to write.
#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/mesh/clip/clip_pieces.h"
#include "filter/mesh/clip/corner_bits.h"
#include "filter/mesh/select/id_set.h"
#include "filter/mesh/surface_builder.h"

namespace sg::clipping {

void allocate(Build& b, size_t whole_cells, size_t whole_ids, const PieceCounts& pieces, int32_t** connectivity, int32_t** offsets,
              uint8_t** types) {
  const size_t cells = whole_cells + pieces.cells, ids = whole_ids + pieces.ids;
  if (ids > size_t(INT32_MAX)) fail_usage("the result has more than 2^31 corners", "clip", "take a part of the mesh first");
  b.connectivity = Array::make<int32_t>(ids, 1, connectivity);
  b.offsets = Array::make<int32_t>(cells + 1, 1, offsets);
  b.types = Array::make<uint8_t>(cells, 1, types);
  (*offsets)[cells] = int32_t(ids);
  b.source.resize(cells);
  b.inner_first.assign(pieces.inner + 1, 0);
  b.inner_points.resize(pieces.inner_ids);
  b.inner_weights.resize(pieces.inner_ids);
}

namespace {

constexpr size_t cells_per_chunk = 1 << 13;  // a multiple of 64

struct Chunk {
  std::vector<uint32_t> cut_cells;
  std::vector<uint8_t> cases;  // of tetrahedra, in a mesh of nothing else
  size_t whole = 0, whole_ids = 0;
  PieceCounts pieces;
  std::vector<uint32_t> face_counts, face_sizes;  // of polyhedra among the pieces; zeros for other pieces
  std::vector<int32_t> face_ids;
  bool polyhedra = false, split = false;
};

class ListClip {
 public:
  explicit ListClip(const Job& job)
      : job_(job),
        mesh_(*job.in->as<UnstructuredMesh>()),
        cells_(cells_view(mesh_.cells)),
        faces_(cells_view(mesh_.faces)),
        values_(job.values()),
        used_(mesh_.points.count()),
        whole_((cells_.count + 63) / 64),
        chunks_((cells_.count + cells_per_chunk - 1) / cells_per_chunk),
        cuts_(chunks_.size()),
        reader_(mesh_.points),
        tets_(mesh_.types.empty() && mesh_.single_type == CellType::tetra && cells_.fixed == 4 && !job.keep.between
                  ? clip_table(CellType::tetra)
                  : nullptr) {}

  Build run() {
    rounding_ = rounding_of(mesh_.points, *job_.in);
    classify_points();
    const std::vector<uint8_t> states = cell_states(*job_.in);
    parallel_for(
        cells_.count, cells_per_chunk,
        [&](size_t begin, size_t end) {
          if (tets_) cells_.connectivity.wide ? find_tets<int64_t>(begin, end, states) : find_tets<int32_t>(begin, end, states);
          else find(begin, end, states);
        },
        &job_.context);
    used_.number();
    CutNumbers numbers = number_names({cuts_.begin(), cuts_.end()}, mesh_.points.count());
    Build b;
    b.cuts = std::move(numbers.names);
    write(b, numbers.number);
    take_faces(b);
    return b;
  }

 private:
  void classify_points() {
    sides_.resize(mesh_.points.count());
    parallel_for(sides_.size(), 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) sides_[i] = side_of(values_(i), job_.keep);
    });
  }

  // Pieces of cell c, whatever it is.
  const CellPieces& pieces(CellClipper& clipper, size_t c, std::vector<int64_t>& ids, std::vector<double>& v) const {
    const CellType type = mesh_.type(c);
    ids.clear(), v.clear();
    for (size_t k = cells_.begin(c); k < cells_.end(c); ++k) ids.push_back(cells_.connectivity[k]);
    if (type == CellType::pixel) std::swap(ids[2], ids[3]);
    for (const int64_t id : ids) v.push_back(values_(size_t(id)));
    if (const ClipTable* table = clip_table(type)) return clipper.solid(*table, ids.data(), v.data());
    const int dimension = cell_type_info(type).dimension;
    if (dimension == 2) return clipper.polygon(ids, v);
    if (dimension == 1) return clipper.chain(ids, v);
    if (dimension == 0) return clipper.dots(ids, v);
    std::vector<std::vector<uint16_t>> faces;
    if (type == CellType::polyhedron) {
      const auto of_cell = mesh_.polyhedron_faces.view<int64_t>();
      for (size_t f = size_t(of_cell[c]); f < size_t(of_cell[c + 1]); ++f) {
        auto& face = faces.emplace_back();
        for (size_t k = 0; k < faces_.size(f); ++k)
          face.push_back(uint16_t(std::find(ids.begin(), ids.end(), faces_.point(f, k)) - ids.begin()));
      }
    } else if (const LinearTopology* t = linear_topology(type)) {  // prisms
      for (size_t f = 0; f < t->face_count(); ++f) faces.emplace_back(t->face(f).begin(), t->face(f).end());
    }
    return clipper.polyhedron(ids, v, std::move(faces));
  }

  CellClipper clipper() const {
    const auto place = [this](size_t i) { return reader_[i]; };
    CellClipper c(job_.keep, place, rounding_);
    if (job_.curved) c.follow(job_.curved, place);
    return c;
  }

  void find(size_t begin, size_t end, const std::vector<uint8_t>& states) {
    Chunk& chunk = chunks_[begin / cells_per_chunk];
    std::vector<uint64_t>& cuts = cuts_[begin / cells_per_chunk];
    CellClipper clip = clipper();
    std::vector<int64_t> ids;
    std::vector<double> v;
    std::vector<uint8_t> joined(end - begin);
    any_of_corners(cells_, begin, end, sides_.data(), joined.data());
    for (size_t c = begin; c < end; ++c) {
      if (!states.empty() && states[c] != cell_visible) continue;
      const size_t first = cells_.begin(c), last = cells_.end(c);
      const Fate fate = fate_of(joined[c - begin], job_.keep.outside);
      if (fate == Fate::none || first == last) continue;
      if (fate == Fate::whole) {
        whole_[c >> 6] |= uint64_t(1) << (c & 63);
        ++chunk.whole, chunk.whole_ids += last - first;
        for (size_t k = first; k < last; ++k) used_.add(size_t(cells_.connectivity[k]));
        if (mesh_.type(c) == CellType::polyhedron) chunk.polyhedra = true;
        continue;
      }
      const CellPieces& p = pieces(clip, c, ids, v);
      if (p.types.empty()) continue;
      chunk.cut_cells.push_back(uint32_t(c));
      count_pieces(clip, p, chunk.pieces, &cuts, [&](uint64_t id) { used_.add(size_t(id)); });
      chunk.polyhedra = chunk.polyhedra || !p.face_sizes.empty();
      chunk.split = chunk.split || clip.split();
    }
  }

  // Tetrahedra have no inner points and no faces to decide about: a cell's case is the pattern of its corners.
  static constexpr uint8_t listed = 0xff;  // a value is the level's
  const Region& tet_region(uint8_t pattern) const {
    const Sides& s = tets_->sides(pattern, 0);
    return job_.keep.outside ? s.out : s.in;
  }

  template <class Id>
  void find_tets(size_t begin, size_t end, const std::vector<uint8_t>& states) {
    Chunk& chunk = chunks_[begin / cells_per_chunk];
    std::vector<uint64_t>& cuts = cuts_[begin / cells_per_chunk];
    CellClipper clip = clipper();
    std::vector<int64_t> ids;
    std::vector<double> v;
    const uint8_t flip = job_.keep.outside ? 15 : 0;
    const auto edges = tets_->topology().edges;
    const Id* corner = static_cast<const Id*>(cells_.connectivity.data) + 4 * begin;
    for (size_t c = begin; c < end; ++c, corner += 4) {
      if (!states.empty() && states[c] != cell_visible) continue;
      const uint8_t side[4] = {sides_[size_t(corner[0])], sides_[size_t(corner[1])], sides_[size_t(corner[2])], sides_[size_t(corner[3])]};
      const auto joined = uint8_t(side[0] | side[1] | side[2] | side[3]);
      const Fate fate = fate_of(joined, job_.keep.outside);
      if (fate == Fate::none) continue;
      if (fate == Fate::whole) {
        whole_[c >> 6] |= uint64_t(1) << (c & 63);
        ++chunk.whole, chunk.whole_ids += 4;
        for (int k = 0; k < 4; ++k) used_.add(size_t(corner[k]));
        continue;
      }
      if (joined & side_on_low) {
        const CellPieces& p = pieces(clip, c, ids, v);
        if (p.types.empty()) continue;
        chunk.cut_cells.push_back(uint32_t(c)), chunk.cases.push_back(listed);
        count_pieces(clip, p, chunk.pieces, &cuts, [&](uint64_t id) { used_.add(size_t(id)); });
        continue;
      }
      uint8_t pattern = flip;
      for (int k = 0; k < 4; ++k) pattern ^= uint8_t((side[k] & side_kept) << k);
      chunk.cut_cells.push_back(uint32_t(c)), chunk.cases.push_back(pattern);
      const Region& r = tet_region(pattern);
      chunk.pieces.cells += r.pieces.size(), chunk.pieces.ids += r.ids;
      for (uint32_t left = r.used & 15; left; left &= left - 1) used_.add(size_t(corner[std::countr_zero(left)]));
      for (uint32_t left = r.used >> first_cut; left; left &= left - 1) {
        const auto e = edges[size_t(std::countr_zero(left))];
        const auto p = uint64_t(corner[e[0]]), q = uint64_t(corner[e[1]]);
        cuts.push_back(edge_name(std::min(p, q), std::max(p, q)));
      }
    }
  }

  // The pieces of a tetrahedron; `cut` are the numbers of its cuts in the order of find_tets().
  void write_tet(uint8_t pattern, size_t c, const uint32_t*& cut, PieceWriter& to) const {
    const Region& r = tet_region(pattern);
    uint32_t at[max_codes];
    for (uint32_t left = r.used & 15; left; left &= left - 1) {
      const auto k = size_t(std::countr_zero(left));
      at[k] = rank_[size_t(cells_.connectivity[4 * c + k])];
    }
    for (uint32_t left = r.used & ~15u; left; left &= left - 1) at[std::countr_zero(left)] = uint32_t(to.first_cut) + *cut++;
    int32_t* ids = to.connectivity + to.at.ids;
    for (const Piece& p : r.pieces) {
      to.build.source[to.at.cells] = uint32_t(c);
      to.types[to.at.cells] = uint8_t(p.type);
      to.offsets[to.at.cells++] = int32_t(ids - to.connectivity);
      for (size_t k = 0; k < p.count; ++k) *ids++ = int32_t(at[p.v[k]]);
    }
    to.at.ids = size_t(ids - to.connectivity);
  }

  template <class Id>
  void write_whole_tets(size_t first_word, size_t last_word, size_t at, Build& b, int32_t* to, int32_t* offsets) const {
    const Id* ids = static_cast<const Id*>(cells_.connectivity.data);
    to += 4 * at;
    for (size_t w = first_word; w < last_word; ++w)
      for (uint64_t left = whole_[w]; left; left &= left - 1, ++at, to += 4) {
        const size_t c = w * 64 + size_t(std::countr_zero(left));
        b.source[at] = uint32_t(c);
        offsets[at] = int32_t(4 * at);
        for (size_t k = 0; k < 4; ++k) to[k] = int32_t(rank_[size_t(ids[4 * c + k])]);
      }
  }

  void write(Build& b, const Plane<uint32_t>& number) {
    // Where each chunk's results go.
    std::vector<size_t> cell(chunks_.size() + 1), id(chunks_.size() + 1), name(chunks_.size() + 1);
    std::vector<PieceCounts> piece(chunks_.size());
    PieceCounts sum;
    for (size_t i = 0; i < chunks_.size(); ++i) {
      cell[i] = chunks_[i].whole, id[i] = chunks_[i].whole_ids, name[i] = cuts_[i].size();
      piece[i] = sum;
      sum.add(chunks_[i].pieces);
      polyhedra_ = polyhedra_ || chunks_[i].polyhedra;
    }
    const size_t whole = exclusive_scan(cell), whole_ids = exclusive_scan(id);
    exclusive_scan(name);
    whole_count_ = whole;
    int32_t *connectivity = nullptr, *offsets = nullptr;
    uint8_t* types = nullptr;
    allocate(b, whole, whole_ids, sum, &connectivity, &offsets, &types);
    const std::vector<int64_t> members = used_.members();
    b.kept = members.size();
    b.points.resize(members.size());
    rank_.resize(mesh_.points.count());
    parallel_for(members.size(), 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) b.points[i] = uint32_t(members[i]), rank_[size_t(members[i])] = uint32_t(i);
    });
    const size_t points = members.size() + b.cuts.size() + sum.inner;
    if (points > size_t(INT32_MAX)) fail_usage("the result has more than 2^31 points", "clip", "take a part of the mesh first");

    parallel_for(
        chunks_.size(), 1,
        [&](size_t i, size_t) {
          size_t at = cell[i], to = id[i];
          const size_t words = std::min(whole_.size(), (i + 1) * cells_per_chunk / 64);
          if (tets_) {
            std::fill_n(types + at, chunks_[i].whole, uint8_t(CellType::tetra));
            if (cells_.connectivity.wide) write_whole_tets<int64_t>(i * cells_per_chunk / 64, words, at, b, connectivity, offsets);
            else write_whole_tets<int32_t>(i * cells_per_chunk / 64, words, at, b, connectivity, offsets);
          }
          for (size_t w = i * cells_per_chunk / 64; !tets_ && w < words; ++w)
            for (uint64_t left = whole_[w]; left; left &= left - 1) {
              const size_t c = w * 64 + size_t(std::countr_zero(left));
              b.source[at] = uint32_t(c);
              types[at] = uint8_t(mesh_.type(c));
              offsets[at++] = int32_t(to);
              for (size_t k = cells_.begin(c), end = cells_.end(c); k < end; ++k)
                connectivity[to++] = int32_t(rank_[size_t(cells_.connectivity[k])]);
            }
          CellClipper clip = clipper();
          PieceWriter writer{b, connectivity, offsets, types, members.size(), members.size() + b.cuts.size(), piece[i], {}, {}};
          writer.at.cells += whole, writer.at.ids += whole_ids;
          std::vector<int64_t> ids;
          std::vector<double> v;
          const uint32_t* next = number.data() + name[i];
          for (size_t n = 0; n < chunks_[i].cut_cells.size(); ++n) {
            const uint32_t c = chunks_[i].cut_cells[n];
            if (tets_ && chunks_[i].cases[n] != listed) {
              write_tet(chunks_[i].cases[n], c, next, writer);
              continue;
            }
            const CellPieces& p = pieces(clip, c, ids, v);
            writer.write(
                clip, p, c, [&](uint64_t point) { return rank_[size_t(point)]; }, [&](uint64_t) { return *next++; });
            if (!polyhedra_) continue;
            Chunk& chunk = chunks_[i];
            chunk.face_counts.insert(chunk.face_counts.end(), p.face_count.begin(), p.face_count.end());
            chunk.face_sizes.insert(chunk.face_sizes.end(), p.face_sizes.begin(), p.face_sizes.end());
            for (const uint16_t k : p.face_vertices) chunk.face_ids.push_back(int32_t(writer.number[k]));
          }
        },
        &job_.context);
    if (!std::any_of(chunks_.begin(), chunks_.end(), [](const Chunk& c) { return c.split; })) return;
    std::vector<std::span<int32_t>> ids{{connectivity, b.connectivity.count()}};
    for (Chunk& c : chunks_) ids.emplace_back(c.face_ids);
    merge_shared(b, members.size() + b.cuts.size(), ids);
  }

  // Faces of polyhedra, whole ones first.
  void take_faces(Build& b) {
    if (!polyhedra_) return;
    std::vector<int64_t> begin(1, 0);
    std::vector<int64_t> offsets(1, 0);
    std::vector<int32_t> ids;
    int64_t faces = 0;
    const bool listed = !mesh_.polyhedron_faces.empty();
    for (size_t i = 0; i < whole_count_; ++i) {
      if (listed) {
        const auto of_cell = mesh_.polyhedron_faces.view<int64_t>();
        for (auto f = size_t(of_cell[b.source[i]]); f < size_t(of_cell[b.source[i] + 1]); ++f, ++faces) {
          for (size_t k = 0; k < faces_.size(f); ++k) ids.push_back(int32_t(used_.rank(size_t(faces_.point(f, k)))));
          offsets.push_back(int64_t(ids.size()));
        }
      }
      begin.push_back(faces);
    }
    for (const Chunk& c : chunks_) {
      size_t face = 0, id = 0;
      for (const uint32_t n : c.face_counts) {
        for (uint32_t f = 0; f < n; ++f, ++face, ++faces) {
          for (uint32_t k = 0; k < c.face_sizes[face]; ++k) ids.push_back(c.face_ids[id++]);
          offsets.push_back(int64_t(ids.size()));
        }
        begin.push_back(faces);
      }
    }
    b.faces.connectivity = Array::from_vector(std::move(ids));
    b.faces.offsets = Array::from_vector(std::move(offsets));
    b.polyhedron_faces = Array::from_vector(std::move(begin));
  }

  const Job& job_;
  const UnstructuredMesh& mesh_;
  CellsView cells_, faces_;
  Values values_;
  IdSet used_;
  Plane<uint8_t> sides_;
  std::vector<uint64_t> whole_;
  std::vector<Chunk> chunks_;
  std::vector<std::vector<uint64_t>> cuts_;
  PointReader reader_;
  const ClipTable* tets_;  // when all cells are tetrahedra
  Plane<uint32_t> rank_;   // of kept points
  bool polyhedra_ = false;
  size_t whole_count_ = 0;
  double rounding_ = 0;
};

}  // namespace

Build clip_lists(const Job& job) { return ListClip(job).run(); }

}  // namespace sg::clipping
