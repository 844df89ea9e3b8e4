// SPDX-License-Identifier: Apache-2.0
// Overlapping AMR of VTK (.vthb, .vth), reading: versions 1.0 and 1.1, and the dialect before them (groups and refinement ratios).
// A box names the cells of a patch at its level; the patch itself is a file of image data.
#include "io/vtk/vtk_amr.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/bytes.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml.h"

namespace sg {

namespace vtk {

Array refined_cells(const AmrGrid& g) {
  size_t n = 0;
  for (const auto& level : g.levels)
    for (const auto& p : level.patches) n += p.cells()[0] * p.cells()[1] * p.cells()[2];
  uint8_t* bits = nullptr;
  Array a = Array::make<uint8_t>(n, 1, &bits);
  if (n > 0) std::memset(bits, 0, n);
  auto down = [](long long i, int ratio) { return i >= 0 ? i / ratio : -((-i + ratio - 1) / ratio); };
  for (size_t l = 0; l + 1 < g.levels.size(); ++l) {
    const auto& fine = g.levels[l + 1];
    const auto& r = fine.ratio;
    const uint32_t whole = uint32_t(r[0]) * uint32_t(r[1]) * uint32_t(r[2]);
    for (const auto& p : g.levels[l].patches) {
      const auto c = p.cells();
      std::vector<uint32_t> covered;  // fine cells in each cell
      for (const auto& f : fine.patches) {
        std::array<long long, 3> lo, hi;
        bool meets = true;
        for (size_t a = 0; a < 3; ++a) {
          lo[a] = std::max(p.lo[a], down(f.lo[a], r[a])), hi[a] = std::min(p.hi[a], down(f.hi[a], r[a]));
          meets = meets && lo[a] <= hi[a];
        }
        if (!meets) continue;
        if (covered.empty()) covered.assign(c[0] * c[1] * c[2], 0);
        auto part = [&](size_t a, long long i) {
          return uint32_t(std::min(f.hi[a], (i + 1) * r[a] - 1) - std::max(f.lo[a], i * r[a]) + 1);
        };
        for (long long k = lo[2]; k <= hi[2]; ++k)
          for (long long j = lo[1]; j <= hi[1]; ++j)
            for (long long i = lo[0]; i <= hi[0]; ++i)
              covered[size_t(i - p.lo[0]) + c[0] * (size_t(j - p.lo[1]) + c[1] * size_t(k - p.lo[2]))] +=
                  part(0, i) * part(1, j) * part(2, k);
      }
      for (size_t i = 0; i < covered.size(); ++i) bits[p.cell_offset + i] = covered[i] >= whole ? ghost_refined_cell : 0;
    }
  }
  return a;
}

namespace {

struct Patch {
  size_t level;
  pugi::xml_node node;
  std::array<long long, 6> box;
  DatasetPtr data;
};

bool is_amr(std::string_view type) {
  return type == "vtkHierarchicalBoxDataSet" || type == "vtkOverlappingAMR" || type == "vtkNonOverlappingAMR";
}

class AmrReader {
 public:
  AmrReader(const XmlFile& file, const ReadOptions& options, Context& context) : file_(file), options_(options), context_(context) {}

  DatasetPtr read() {
    list_patches();
    read_patches();
    choose_geometry();
    DatasetParts parts;
    parts.mesh = grid_;
    join_fields(Association::point, parts);
    join_fields(Association::cell, parts);
    for (const Patch& p : patches_)
      for (const Field& f : p.data->fields())
        if (f.association == Association::whole && !parts.fields.find(f.name, f.association)) parts.fields.add(f);
    if (!patches_.empty()) parts.time = patches_[0].data->time();
    add_ghosts(parts);
    return make_dataset(std::move(parts));
  }

 private:
  const std::string& path() const { return file_.path(); }

  void list_patches() {
    for (const pugi::xml_node& n : file_.dataset().children()) {
      const std::string_view element = n.name();
      if (element == "DataSet") {
        add_patch(parse_count(file_, n, "group"), n);
      } else if (element == "Block") {
        const uint64_t level = parse_count(file_, n, "level");
        for (const pugi::xml_node& set : n.children("DataSet")) add_patch(level, set);
        if (level < spacings_.size()) have_spacing_[level] = parse_doubles(file_, n, "spacing", &spacings_[level].x, 3);
      } else if (element == "RefinementRatio") {
        if (parse_count(file_, n, "level") == ratios_.size())
          ratios_.push_back(int(std::min<uint64_t>(parse_count(file_, n, "refinement"), 1024)));
      }
    }
    std::stable_sort(patches_.begin(), patches_.end(), [](const Patch& a, const Patch& b) { return a.level < b.level; });
  }

  void add_patch(uint64_t level, pugi::xml_node n) {
    if (level >= 64) file_.fail(fmt::format("is of level {}", level), n, "fewer than 64 levels are supported");
    if (level >= spacings_.size()) spacings_.resize(level + 1), have_spacing_.resize(level + 1, false);
    Patch p{level, n, {}, {}};
    parse_longs(file_, n, "amr_box", p.box.data(), 6);
    const std::string_view source = n.attribute("file").value();
    if (source.empty()) return;  // a patch that was not written
    if (!sources_.insert(source).second) file_.fail(fmt::format("names '{}' a second time", source), n, "name each patch once");
    auto sane = [](long long i) { return i >= -(1ll << 40) && i <= 1ll << 40; };
    for (size_t a = 0; a < 3; ++a)
      if (!sane(p.box[2 * a]) || !sane(p.box[2 * a + 1]) || p.box[2 * a + 1] < p.box[2 * a] - 1)
        file_.fail(fmt::format("amr_box extends from {} to {} along {}", p.box[2 * a], p.box[2 * a + 1], "xyz"[a]), n);
    patches_.push_back(std::move(p));
  }

  void read_patches() {
    ReadOptions options = options_;
    options.region = {}, options.time.reset(), options.step = -1;
    for (Patch& p : patches_) {
      context_.check();
      const std::string at = named_file(path(), p.node.attribute("file").value());
      p.data = with_context(fmt::format("reading the patches of '{}'", path()), [&] {
        const Data data = read_vtk_xml(at, options, context_);
        return std::get<DatasetPtr>(data);
      });
      const auto* g = p.data->as<UniformGrid>();
      if (!g) fail_data(fmt::format("holds a mesh of kind {}", p.data->kind()), at, "patches must be image data");
      if (!(g->direction == Mat3{})) fail_data("is turned", at, "patches must lie along the axes");
      for (size_t a = 0; a < 3; ++a) {
        const auto cells = static_cast<long long>(g->dims[a]) - 1;
        if (p.box[2 * a + 1] - p.box[2 * a] + 1 != cells && !(cells == 0 && p.box[2 * a + 1] == p.box[2 * a]))
          fail_data(fmt::format("has {} cells along {}, not {}", cells, "xyz"[a], p.box[2 * a + 1] - p.box[2 * a] + 1), at,
                    fmt::format("the box of {}", path()));
      }
    }
  }

  void choose_geometry() {
    bool flat = !patches_.empty();
    for (const Patch& p : patches_) {
      const auto& d = p.data->as<UniformGrid>()->dims;
      if (d[0] < 2 || d[1] < 2) fail_data("has patches that are flat along x or y", path(), "two-dimensional AMR must lie in the xy plane");
      flat = flat && d[2] == 1;
    }
    grid_.dimension = flat ? 2 : 3;
    grid_.levels.resize(spacings_.size());
    // The files of the patches know their spacing to the last digit; the boxes' file prints six.
    for (const Patch& p : patches_)
      if (const Vec3 s = p.data->as<UniformGrid>()->spacing; !seen_.count(p.level)) seen_[p.level] = s;
    for (size_t l = 0; l < spacings_.size(); ++l) {
      if (const auto exact = seen_.find(l); exact != seen_.end()) grid_.levels[l].spacing = exact->second;
      else if (have_spacing_[l]) grid_.levels[l].spacing = spacings_[l];
      else if (l > 0 && l <= ratios_.size()) grid_.levels[l].spacing = grid_.levels[l - 1].spacing / double(std::max(ratios_[l - 1], 1));
      else file_.fail(fmt::format("gives no spacing for level {}", l), file_.dataset());
      set_ratio(l);
    }
    if (!parse_doubles(file_, file_.dataset(), "origin", &grid_.origin.x, 3) && !patches_.empty()) {
      const auto* g = patches_[0].data->as<UniformGrid>();
      for (int a = 0; a < 3; ++a) grid_.origin[a] = g->origin[a] - double(patches_[0].box[size_t(2 * a)]) * g->spacing[a];
    }
    size_t cells = 0, points = 0;
    for (const Patch& p : patches_) {
      AmrGrid::Patch box;
      for (size_t a = 0; a < 3; ++a) box.lo[a] = p.box[2 * a], box.hi[a] = std::max(p.box[2 * a], p.box[2 * a + 1]);
      if (!flat && p.data->as<UniformGrid>()->dims[2] < 2) fail_data("has flat patches besides three-dimensional ones", path());
      box.cell_offset = cells, box.point_offset = points;
      cells += p.data->cell_count(), points += p.data->point_count();
      grid_.levels[p.level].patches.push_back(box);
    }
  }

  void set_ratio(size_t l) {
    AmrGrid::Level& level = grid_.levels[l];
    level.ratio = {1, 1, 1};
    if (l == 0) return;
    for (int a = 0; a < 3; ++a) {
      const double r = grid_.levels[l - 1].spacing[a] / level.spacing[a];
      const bool flat = a == 2 && grid_.dimension == 2;
      if (!flat && (!(r > 0.99 && r < 1024.5) || std::abs(r - std::round(r)) > 0.01))
        fail_data(fmt::format("refines {} by {} from level {} to {}", "xyz"[a], r, l - 1, l), path(),
                  "expected a whole number from 1 to 1024");
      level.ratio[size_t(a)] = flat ? 1 : int(std::round(r));
    }
  }

  // The arrays that all patches have, one after the other.
  void join_fields(Association association, DatasetParts& parts) const {
    if (patches_.empty()) return;
    for (const Field& f : patches_[0].data->fields()) {
      if (f.association != association) continue;
      std::vector<Array> arrays;
      for (const Patch& p : patches_) {
        const Field* other = p.data->fields().find(f.name, association);
        if (!other || other->array.type() != f.array.type() || other->components() != f.components()) break;
        arrays.push_back(other->array);
      }
      if (arrays.size() != patches_.size()) {
        context_.warn(fmt::format("{} array '{}' differs between patches and is left out", association_name(association), f.name));
        continue;
      }
      Field joined = f;
      joined.array = concatenated(arrays);
      parts.fields.add(std::move(joined));
    }
  }

  void add_ghosts(DatasetParts& parts) const {
    const Array refined = refined_cells(grid_);
    uint8_t* bits = nullptr;
    parts.cell_ghost = Array::make<uint8_t>(refined.count(), 1, &bits);
    for (size_t i = 0; i < refined.count(); ++i) bits[i] = refined.view<uint8_t>()[i];
    bool points = false;
    for (const Patch& p : patches_) {
      points = points || !p.data->point_ghost().empty();
      if (const Array& g = p.data->cell_ghost(); !g.empty())
        for (size_t i = 0; i < g.count(); ++i) bits[i] |= g.view<uint8_t>()[i];
      bits += p.data->cell_count();
    }
    if (!points) return;
    parts.point_ghost = Array::make<uint8_t>(point_count(parts.mesh), 1, &bits);
    std::memset(bits, 0, parts.point_ghost.count());
    for (const Patch& p : patches_) {
      const Array& g = p.data->point_ghost();
      for (size_t i = 0; i < g.count(); ++i) bits[i] = g.view<uint8_t>()[i];
      bits += p.data->point_count();
    }
  }

  const XmlFile& file_;
  const ReadOptions& options_;
  Context& context_;
  std::vector<Patch> patches_;
  std::vector<Vec3> spacings_;
  std::set<std::string_view> sources_;
  std::vector<char> have_spacing_;
  std::vector<int> ratios_;
  std::map<size_t, Vec3> seen_;
  AmrGrid grid_;
};

}  // namespace
}  // namespace vtk

bool sniff_vtk_amr(std::span<const std::byte> head) {
  return vtk::is_amr(vtk::xml_type({reinterpret_cast<const char*>(head.data()), head.size()}));
}

Data read_vtk_amr(const std::string& path, const ReadOptions& options, Context& context) {
  const vtk::XmlFile file(path);
  if (!vtk::is_amr(file.type())) fail_data(fmt::format("has the type '{}'", file.type()), path, "vtkOverlappingAMR");
  return vtk::AmrReader(file, options, context).read();
}

}  // namespace sg
