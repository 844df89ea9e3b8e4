// SPDX-License-Identifier: Apache-2.0
// Sections of .msh files, versions 2.x, 4.0 and 4.1. Source: Gmsh reference manual, "File formats".
#include "io/gmsh/msh_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/gmsh/elements.h"

namespace sg::gmsh {

const char* MshInput::raw(size_t bytes, const char* what) {
  if (text.left() < bytes) fail_data(fmt::format("byte {}: the file ends where {} was expected", text.position(), what), text.where());
  const char* p = text.text().data() + text.position();
  text.seek(text.position() + bytes);
  return p;
}

int64_t MshInput::integer(const char* what) { return binary ? load<int32_t>(raw(4, what), swapped) : text.integer(what); }
int64_t MshInput::whole(const char* what) { return binary ? load<int64_t>(raw(8, what), swapped) : text.integer(what); }
double MshInput::real(const char* what) { return binary ? load<double>(raw(8, what), swapped) : text.number(what); }

int64_t MshInput::count(const char* what, size_t bytes_each, bool wide) {
  const int64_t n = wide ? whole(what) : integer(what);
  if (n < 0 || uint64_t(n) > text.left() / bytes_each + 1)
    fail_data(fmt::format("{} is {}, but only {} bytes follow", what, n, text.left()),
              fmt::format("{}, {} {}", text.where(), binary ? "byte" : "line", binary ? text.position() : text.line_now()));
  return n;
}

std::string_view MshInput::name() {
  std::string_view s = text.line();
  while (s.empty() && text.left() > 0) s = text.line();
  if (s.size() > 1 && s.front() == '"' && s.back() == '"') s = s.substr(1, s.size() - 2);
  return s;
}

void MshInput::end_line() {
  if (binary) text.line();
}

namespace {

void parse_format(MshInput& in) {
  const double version = in.text.number("the version");
  const int64_t binary = in.text.integer("the file type");
  const int64_t size = in.text.integer("the size of numbers");
  if (!((version >= 2 && version < 3) || (version >= 4 && version < 4.2)))
    in.text.fail(fmt::format("version {}", version), "versions 2.x, 4.0 and 4.1 are supported; Gmsh converts: gmsh -save -format msh41");
  in.version = int(std::lround(version * 10));
  if (binary < 0 || binary > 1) in.text.fail(fmt::format("file type {}", binary), "0 is ASCII, 1 is binary");
  if (size != 8) in.text.fail(fmt::format("numbers of {} bytes", size), "8");
  if (binary == 0) return;
  in.binary = true;
  in.end_line();
  const int64_t one = in.integer("the number one");
  if (one == 0x01000000) in.swapped = true;
  else if (one != 1) in.text.fail("the number one is missing after the format of a binary file");
}

void parse_names(MshInput& in, MshFile& f) {
  const size_t n = in.text.count("the number of physical names", 5);
  for (size_t i = 0; i < n; ++i) {
    const int64_t dimension = in.text.integer("a dimension"), tag = in.text.integer("a tag");
    f.names[{dimension, tag}] = in.name();
  }
}

void parse_entities(MshInput& in, MshFile& f, bool partitioned) {
  if (partitioned) {
    in.whole("the number of partitions");
    const int64_t ghosts = in.count("the number of ghost entities", 4, true);
    for (int64_t i = 0; i < ghosts; ++i) in.integer("a tag"), in.integer("a partition");
    f.partitioned = true;
  }
  int64_t n[4];
  for (int64_t& k : n) k = in.count("the number of entities", 10, true);
  for (int d = 0; d < 4; ++d)
    for (int64_t i = 0; i < n[d]; ++i) {
      Entity e;
      const int64_t tag = in.integer("the tag of an entity");
      e.parent = int32_t(tag);
      if (partitioned) {
        in.integer("a dimension");
        e.parent = int32_t(in.integer("a tag"));
        const int64_t parts = in.count("the number of partitions", 2, true);
        for (int64_t k = 0; k < parts; ++k) {
          const int64_t p = in.integer("a partition");
          if (k == 0) e.partition = int32_t(p);
        }
      }
      for (int k = d == 0 && in.version > 40 ? 3 : 6; k > 0; --k) in.real("a coordinate");
      const int64_t groups = in.count("the number of physical groups", 2, true);
      for (int64_t k = 0; k < groups; ++k) {
        const int64_t group = in.integer("a physical group");
        if (k == 0) e.physical = int32_t(std::abs(group));  // the sign is the orientation
      }
      if (d > 0) {
        const int64_t around = in.count("the number of bounding entities", 2, true);
        for (int64_t k = 0; k < around; ++k) in.integer("the tag of an entity");
      }
      f.entities[{d, tag}] = e;
    }
}

void add_point(MshInput& in, MshFile& f) {
  for (int a = 0; a < 3; ++a) f.xyz.push_back(in.real("a coordinate"));
}

void parse_nodes(MshInput& in, MshFile& f) {
  if (in.version < 40) {
    const size_t n = in.text.count("the number of nodes", 8);
    in.end_line();
    for (size_t i = 0; i < n; ++i) f.node_tags.push_back(in.integer("the number of a node")), add_point(in, f);
    return;
  }
  const int64_t blocks = in.count("the number of blocks of nodes", 8, true);
  in.whole("the number of nodes");
  if (in.version > 40) in.whole("a tag"), in.whole("a tag");
  for (int64_t b = 0; b < blocks; ++b) {
    const int64_t first = in.integer("an entity"), second = in.integer("an entity");
    const int64_t dimension = in.version > 40 ? first : second;
    const int64_t parametric = in.integer("'parametric'");
    const int64_t n = in.count("the number of nodes", in.version > 40 ? 8 : 10, true);
    const int64_t extra = parametric ? std::clamp<int64_t>(dimension, 0, 3) : 0;
    if (in.version > 40)
      for (int64_t i = 0; i < n; ++i) f.node_tags.push_back(in.whole("the tag of a node"));
    for (int64_t i = 0; i < n; ++i) {
      if (in.version == 40) f.node_tags.push_back(in.integer("the tag of a node"));
      add_point(in, f);
      for (int64_t k = 0; k < extra; ++k) in.real("a parameter");
    }
  }
}

const ElementType& checked_type(MshInput& in, int64_t number) {
  const ElementType* type = element_type(number);
  if (!type)
    fail_data(
        fmt::format("element type {} is not supported", number),
        fmt::format("{}, {} {}", in.text.where(), in.binary ? "byte" : "line", in.binary ? in.text.position() : in.text.line_now()),
        "supported: points, complete lines, triangles, quads, tetrahedra, hexahedra and prisms up to order 10, pyramids up to order 2");
  return *type;
}

void add_element(MshInput& in, MshFile& f, int64_t type, const ElementType& t, bool wide) {
  for (size_t k = 0; k < t.nodes; ++k) f.element_nodes.push_back(wide ? in.whole("a node") : in.integer("a node"));
  f.element_types.push_back(uint8_t(type));
  f.element_begin.push_back(f.element_nodes.size());
}

// Tags of version 2: physical group, entity, number of partitions, partitions.
void add_tags(MshFile& f, const std::vector<int64_t>& tags) {
  f.physical.push_back(tags.empty() ? 0 : int32_t(tags[0]));
  f.entity.push_back(tags.size() < 2 ? 0 : int32_t(tags[1]));
  f.partition.push_back(tags.size() < 4 ? 0 : int32_t(std::abs(tags[3])));
  f.partitioned = f.partitioned || tags.size() > 3;
}

void parse_elements_2(MshInput& in, MshFile& f) {
  const size_t n = in.text.count("the number of elements", 6);
  in.end_line();
  std::vector<int64_t> tags;
  auto read_tags = [&](int64_t count) {
    tags.clear();
    for (int64_t k = 0; k < count; ++k) tags.push_back(in.integer("a tag"));
    add_tags(f, tags);
  };
  for (size_t e = 0; e < n;) {
    if (!in.binary) {
      f.element_tags.push_back(in.integer("the number of an element"));
      const int64_t type = in.integer("an element type");
      const ElementType& t = checked_type(in, type);
      read_tags(in.count("the number of tags", 2, false));
      add_element(in, f, type, t, false);
      ++e;
      continue;
    }
    const int64_t type = in.integer("an element type");
    const ElementType& t = checked_type(in, type);
    const int64_t block = in.count("the number of elements", 8, false), count = in.count("the number of tags", 4, false);
    if (block < 1 || uint64_t(block) > n - e) in.text.fail(fmt::format("a block has {} elements, but {} are left", block, n - e));
    for (int64_t i = 0; i < block; ++i, ++e) {
      f.element_tags.push_back(in.integer("the number of an element"));
      read_tags(count);
      add_element(in, f, type, t, false);
    }
  }
}

void parse_elements_4(MshInput& in, MshFile& f) {
  const bool wide = in.version > 40;
  const int64_t blocks = in.count("the number of blocks of elements", 8, true);
  in.whole("the number of elements");
  if (wide) in.whole("a tag"), in.whole("a tag");
  for (int64_t b = 0; b < blocks; ++b) {
    const int64_t first = in.integer("an entity"), second = in.integer("an entity");
    const int dimension = int(std::clamp<int64_t>(wide ? first : second, -1, 4));
    const int64_t tag = wide ? second : first, type = in.integer("an element type");
    const ElementType& t = checked_type(in, type);
    const int64_t n = in.count("the number of elements", 4, true);
    const auto it = f.entities.find({dimension, tag});
    Entity e;
    if (it != f.entities.end()) e = it->second;
    else e.parent = int32_t(tag);
    for (int64_t i = 0; i < n; ++i) {
      f.element_tags.push_back(wide ? in.whole("the tag of an element") : in.integer("the tag of an element"));
      f.physical.push_back(e.physical);
      f.entity.push_back(e.parent);
      f.partition.push_back(e.partition);
      add_element(in, f, type, t, wide);
    }
  }
}

void parse_data(MshInput& in, MshFile& f, DataSection::Kind kind) {
  DataSection d;
  d.kind = kind;
  const size_t strings = in.text.count("the number of string tags", 1);
  in.text.line();
  for (size_t i = 0; i < strings; ++i) {
    const std::string_view s = in.name();
    if (i == 0) d.name = std::string(s);
  }
  const size_t reals = in.text.count("the number of real tags", 2);
  for (size_t i = 0; i < reals; ++i) {
    const double v = in.text.number("a real tag");
    if (i == 0) d.time = v;
  }
  const size_t integers = in.text.count("the number of integer tags", 2);
  int64_t tags[3] = {0, 1, 0};
  for (size_t i = 0; i < integers; ++i) {
    const int64_t v = in.text.integer("an integer tag");
    if (i < 3) tags[i] = v;
  }
  d.step = tags[0], d.components = tags[1], d.entries = tags[2];
  if (integers < 3) in.text.fail("a data section needs three integer tags", "time step, components and number of values");
  if (d.components < 1 || d.components > 64) in.text.fail(fmt::format("{} components", d.components), "1, 3 or 9");
  if (d.entries < 0 || uint64_t(d.entries) > in.text.left() / 4 + 1)
    in.text.fail(fmt::format("{} values, but only {} bytes follow", d.entries, in.text.left()));
  in.end_line();
  d.begin = in.text.position();
  if (d.name.empty()) d.name = "data";
  f.data.push_back(d);
}

}  // namespace

MshFile parse_msh(MshInput& in) {
  MshFile f;
  in.text.expect("$MeshFormat");
  parse_format(in);
  while (true) {
    // Sections end with their own line; unknown ones, and the values of data, are passed over. In binary data a line that begins
    // with '$End' and the name is as good as certain.
    const std::string_view all = in.text.text();
    const size_t end = all.find("$End", in.text.position());
    if (end == std::string_view::npos) break;
    in.text.seek(end);
    in.text.line();
    const size_t begin = all.find('$', in.text.position());
    if (begin == std::string_view::npos) break;
    in.text.seek(begin);
    const std::string_view name = in.text.word();
    if (name == "$PhysicalNames") parse_names(in, f);
    else if (name == "$Entities" || name == "$PartitionedEntities") in.end_line(), parse_entities(in, f, name[1] == 'P');
    else if (name == "$Nodes") in.version < 40 ? (void)0 : in.end_line(), parse_nodes(in, f);
    else if (name == "$Elements" && in.version < 40) parse_elements_2(in, f);
    else if (name == "$Elements") in.end_line(), parse_elements_4(in, f);
    else if (name == "$NodeData") parse_data(in, f, DataSection::node);
    else if (name == "$ElementData") parse_data(in, f, DataSection::element);
    else if (name == "$ElementNodeData") parse_data(in, f, DataSection::element_node);
  }
  if (f.node_tags.empty()) fail_data("has no nodes", in.text.where(), "expected a section $Nodes");
  if (f.element_tags.empty()) fail_data("has no elements", in.text.where(), "expected a section $Elements");
  return f;
}

}  // namespace sg::gmsh
