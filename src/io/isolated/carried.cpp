// SPDX-License-Identifier: Apache-2.0
#include "io/isolated/carried.h"

#include "base/error.h"

namespace sg {

namespace {

constexpr size_t apart = 64;
constexpr int deepest = 200;

size_t rounded(size_t bytes) { return (bytes + apart - 1) / apart * apart; }

// Stand-ins for values that were not read (io/mesh/unread.h) hold one number for all.
bool is_one_number(const Array& a) { return a.count() > 1 && a.stride_bytes() == 0 && a.component_stride_bytes() == 0; }

bool alike(const Array& a, const Array& b) {
  return a.type() == b.type() && a.count() == b.count() && a.components() == b.components() && a.stride_bytes() == b.stride_bytes() &&
         a.component_stride_bytes() == b.component_stride_bytes();
}

}  // namespace

void CarryWriter::string(std::string_view s) {
  number(uint64_t(s.size()));
  text += s;
}

void CarryWriter::array(const Array& a) {
  const bool one = is_one_number(a);
  number(uint8_t(a.type())), number(uint8_t(one)), number(uint64_t(a.count())), number(int32_t(a.components()));
  if (a.empty()) return;
  auto& same = placed_[a.raw()];
  for (const Place& p : same)
    if (alike(p.array, a)) return number(uint64_t(p.offset));
  number(uint64_t(array_bytes_));
  same.push_back({a, array_bytes_});  // keeps the bytes alive, so that no other array can reuse their address
  arrays.push_back(one ? a.slice(0, 1).component(0).made_packed() : a.made_packed());
  array_bytes_ += rounded(arrays.back().bytes());
}

void CarryWriter::field(const Field& f) {
  string(f.name), string(f.unit);
  number(uint8_t(f.association)), number(uint8_t(f.role)), number(uint8_t(f.look.shows));  // all that readers state of looks
  array(f.array);
}

void CarryWriter::mesh(const Mesh& m) {
  number(uint8_t(m.index()));
  const auto points = [&](const Points& p) { number(p.origin), array(p.xyz); };
  const auto cells = [&](const CellArray& c) { number(int32_t(c.fixed)), array(c.connectivity), array(c.offsets); };
  if (const auto* u = std::get_if<UniformGrid>(&m)) {
    number(*u);
  } else if (const auto* r = std::get_if<RectilinearGrid>(&m)) {
    array(r->x), array(r->y), array(r->z), number(r->extent_start);
  } else if (const auto* c = std::get_if<CurvilinearGrid>(&m)) {
    number(c->dims), points(c->points), number(c->extent_start);
  } else if (const auto* g = std::get_if<UnstructuredMesh>(&m)) {
    points(g->points), cells(g->cells), array(g->types), number(uint8_t(g->single_type));
    cells(g->faces), array(g->polyhedron_faces), array(g->degrees), array(g->weights);
  } else if (const auto* s = std::get_if<SurfaceMesh>(&m)) {
    points(s->points), cells(s->vertices), cells(s->lines), cells(s->polygons), cells(s->strips);
  } else if (const auto* p = std::get_if<PointCloud>(&m)) {
    points(p->points);
  } else if (const auto* a = std::get_if<AmrGrid>(&m)) {
    number(int32_t(a->dimension)), number(a->origin), number(uint64_t(a->levels.size()));
    for (const auto& level : a->levels) {
      number(level.spacing), number(level.ratio), number(uint64_t(level.patches.size()));
      for (const auto& patch : level.patches) number(patch);
    }
  }
}

void CarryWriter::dataset(const Dataset& d) {
  mesh(d.mesh());
  number(uint64_t(d.fields().size()));
  for (const Field& f : d.fields()) field(f);
  array(d.point_ghost()), array(d.cell_ghost());
  number(uint8_t(d.time().has_value())), number(d.time().value_or(0));
  number(uint64_t(d.notes().size()));
  for (const auto& [k, v] : d.notes()) string(k), string(v);
}

void CarryWriter::data(const Data& d) {
  number(uint8_t(d.index()));
  if (const auto* one = std::get_if<DatasetPtr>(&d)) {
    if (!*one) fail_internal("a part without a dataset cannot be carried");
    dataset(**one);
  } else if (const auto* all = std::get_if<CollectionPtr>(&d)) {
    number(uint64_t((*all)->parts.size()));
    for (const auto& part : (*all)->parts) string(part.name), data(part.data);
  } else {
    const Table& t = *std::get<TablePtr>(d);
    number(uint64_t(t.columns.size()));
    for (const Field& f : t.columns) field(f);
    number(uint64_t(t.labels.size()));
    for (const auto& words : t.labels) {
      number(uint64_t(words.size()));
      for (const std::string& w : words) string(w);
    }
  }
}

CarryReader::CarryReader(Buffer file, size_t begin, size_t end, size_t arrays, std::string path)
    : file_(std::move(file)), at_(begin), end_(end), arrays_(arrays), path_(std::move(path)) {
  if (begin > end || end > file_.size || arrays > file_.size) nonsense();
}

void CarryReader::nonsense() const { fail_data("is damaged: the process that reads it returned invalid data", path_); }

template <class E>
E CarryReader::one_of(E last) {
  const auto v = number<uint8_t>();
  if (v > uint8_t(last)) nonsense();
  return E(v);
}

std::string CarryReader::string() {
  const auto n = number<uint64_t>();
  need(n);
  std::string s(reinterpret_cast<const char*>(file_.data) + at_, n);
  at_ += n;
  return s;
}

Array CarryReader::array() {
  const auto type = one_of(ElementType::f64);
  const bool one = number<uint8_t>() != 0;
  const auto count = number<uint64_t>();
  const auto components = number<int32_t>();
  if (components < 1) nonsense();
  if (count == 0) return Array(Buffer{}, type, 0, components);
  const auto offset = number<uint64_t>();
  if (offset > file_.size - arrays_ || offset % apart) nonsense();
  const Buffer rest{file_.owner, file_.data + arrays_ + offset, file_.size - arrays_ - offset};
  if (one) return Array(rest, type, count, components, 0, 0, 0);
  return Array(rest, type, count, components);
}

Points CarryReader::points() {
  Points p;
  p.origin = number<Vec3>();
  p.xyz = array();
  return p;
}

CellArray CarryReader::cells() {
  CellArray c;
  c.fixed = number<int32_t>();
  c.connectivity = array(), c.offsets = array();
  if (c.fixed < 0) nonsense();
  return c;
}

Field CarryReader::field() {
  Field f;
  f.name = string(), f.unit = string();
  f.association = one_of(Association::whole), f.role = one_of(Role::labels);
  f.look.shows = one_of(FieldLook::Shows::zero);
  f.array = array();
  return f;
}

Mesh CarryReader::mesh() {
  switch (number<uint8_t>()) {
    case 0: return number<UniformGrid>();
    case 1: {
      RectilinearGrid r;
      r.x = array(), r.y = array(), r.z = array(), r.extent_start = number<std::array<long long, 3>>();
      return r;
    }
    case 2: {
      CurvilinearGrid c;
      c.dims = number<std::array<size_t, 3>>(), c.points = points(), c.extent_start = number<std::array<long long, 3>>();
      return c;
    }
    case 3: {
      UnstructuredMesh g;
      g.points = points(), g.cells = cells(), g.types = array(), g.single_type = CellType(number<uint8_t>());
      g.faces = cells(), g.polyhedron_faces = array(), g.degrees = array(), g.weights = array();
      return g;
    }
    case 4: {
      SurfaceMesh s;
      s.points = points(), s.vertices = cells(), s.lines = cells(), s.polygons = cells(), s.strips = cells();
      return s;
    }
    case 5: return PointCloud{points()};
    case 6: {
      AmrGrid a;
      a.dimension = number<int32_t>(), a.origin = number<Vec3>();
      for (auto n = number<uint64_t>(); n > 0; --n) {
        AmrGrid::Level& level = a.levels.emplace_back();
        level.spacing = number<Vec3>(), level.ratio = number<std::array<int, 3>>();
        for (auto m = number<uint64_t>(); m > 0; --m) level.patches.push_back(number<AmrGrid::Patch>());
      }
      return a;
    }
    default: nonsense();
  }
}

DatasetPtr CarryReader::dataset() {
  DatasetParts p;
  p.mesh = mesh();
  for (auto n = number<uint64_t>(); n > 0; --n) p.fields.add(field());
  p.point_ghost = array(), p.cell_ghost = array();
  const bool timed = number<uint8_t>() != 0;
  if (const double t = number<double>(); timed) p.time = t;
  for (auto n = number<uint64_t>(); n > 0; --n) {
    std::string key = string();
    p.notes.emplace_back(std::move(key), string());
  }
  return make_dataset(std::move(p));
}

Data CarryReader::data() {
  switch (number<uint8_t>()) {
    case 0: return dataset();
    case 1: {
      if (++depth_ > deepest) nonsense();
      auto all = std::make_shared<Collection>();
      for (auto n = number<uint64_t>(); n > 0; --n) {
        std::string name = string();
        all->parts.push_back({std::move(name), data()});
      }
      --depth_;
      return CollectionPtr(all);
    }
    case 2: {
      auto t = std::make_shared<Table>();
      for (auto n = number<uint64_t>(); n > 0; --n) t->columns.push_back(field());
      for (auto n = number<uint64_t>(); n > 0; --n) {
        auto& words = t->labels.emplace_back();
        for (auto m = number<uint64_t>(); m > 0; --m) words.push_back(string());
      }
      return TablePtr(t);
    }
    default: nonsense();
  }
}

}  // namespace sg
