// SPDX-License-Identifier: Apache-2.0
// Files that name other files: VTK multiblock (.vtm, .vtmb, .vtpc, .vtpd) and ParaView's time series (.pvd), reading.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/vtk/vtk_missing.h"
#include "io/vtk/xml/vtk_xml.h"

namespace sg {

namespace vtk {
namespace {

constexpr size_t most_depth = 32;
// However often small files name each other: as many parts as their texts could name one by one.
constexpr size_t parts_always = 20'000, bytes_a_part = 16;

std::string_view type_in(std::span<const std::byte> head) { return xml_type({reinterpret_cast<const char*>(head.data()), head.size()}); }

bool is_multiblock(std::string_view type) {
  for (const char* t : {"vtkMultiBlockDataSet", "vtkMultiPieceDataSet", "vtkPartitionedDataSet", "vtkPartitionedDataSetCollection",
                        "vtkHierarchicalDataSet", "vtkMultiGroupDataSet"})
    if (type == t) return true;
  return false;
}

// Time steps of a .pvd file, ascending, and the DataSet elements of each.
struct Steps {
  std::vector<double> times;  // empty when the file has none
  std::vector<std::vector<pugi::xml_node>> sets;
};

Steps steps_of(const XmlFile& file) {
  std::map<double, std::vector<pugi::xml_node>> by_time;
  bool timed = false;
  for (const pugi::xml_node& n : file.dataset().children("DataSet")) {
    double time = 0;
    if (parse_doubles(file, n, "timestep", &time, 1)) timed = true;
    if (!std::isfinite(time)) file.fail(fmt::format("has the time step '{}'", n.attribute("timestep").value()), n, "a number");
    by_time[time + 0.0].push_back(n);
  }
  Steps s;
  for (auto& [time, sets] : by_time) {
    if (timed) s.times.push_back(time);
    s.sets.push_back(std::move(sets));
  }
  return s;
}

// What is being read: the files on the way down, those that are there already, and how many parts there are in all.
class TreeReader {
 public:
  TreeReader(const ReadOptions& options, Context& context) : options_(options), part_options_(options), context_(context) {
    part_options_.time.reset(), part_options_.step = -1;
  }

  Data read(const std::string& path) {
    const std::string real = real_path(path);
    if (const auto have = done_.find(real); have != done_.end()) {
      count(have->second.parts);
      return have->second.data;
    }
    if (std::find(stack_.begin(), stack_.end(), real) != stack_.end())
      fail_data("contains itself", path, "a file must name only other files");
    if (stack_.size() >= most_depth) fail_data(fmt::format("is nested in {} other files", stack_.size()), path);
    context_.check();
    stack_.push_back(real);
    const size_t before = parts_;
    Data data = read_new(path);
    stack_.pop_back();
    done_[real] = {data, parts_ - before};
    return data;
  }

 private:
  struct Done {
    Data data;
    size_t parts;
  };

  static std::string real_path(const std::string& path) {
    char* p = ::realpath(path.c_str(), nullptr);
    if (!p) fail_data("no such file", path);
    std::string r = p;
    std::free(p);
    return r;
  }

  void count(size_t parts) {
    parts_ += parts;
    const size_t most = parts_always + bytes_ / bytes_a_part;
    if (parts_ > most)
      fail_data(fmt::format("has more than {} parts, counting files that are named repeatedly", most), stack_[0], "name each part once");
  }

  Data read_new(const std::string& path) {
    const MappedFile head(path);
    bytes_ += head.size();
    const std::string_view type = type_in({head.data(), std::min<size_t>(head.size(), 4096)});
    if (type != "Collection" && !is_multiblock(type)) {
      count(1);
      return read_data(path, part_options_, context_);
    }
    const XmlFile file(path);
    if (type == "Collection") return read_series(file);
    take_share(file.dataset());
    auto collection = std::make_shared<Collection>();
    read_blocks(file, file.dataset(), *collection, 1);
    if (stack_.size() == 1) missing_.tell(path, context_);
    return CollectionPtr(std::move(collection));
  }

  // Which leaves this process reads: the share is taken in the first file that names several.
  void take_share(pugi::xml_node root) {
    if (options_.pieces < 1 || options_.piece < 0 || options_.piece >= options_.pieces)
      fail_usage(fmt::format("piece {} of {}", options_.piece, options_.pieces), stack_[0], "pieces count from 0");
    if (part_options_.pieces == 1) return;
    size_t n = 0;
    auto walk = [&](auto&& self, pugi::xml_node at, size_t depth) -> void {
      if (depth > most_depth) return;
      for (const pugi::xml_node& e : at.children()) {
        if (e.attribute("file")) ++n;
        self(self, e, depth + 1);
      }
    };
    walk(walk, root, 0);
    if (n < 2) return;
    share_depth_ = stack_.size();
    share_begin_ = n * size_t(options_.piece) / size_t(options_.pieces);
    share_end_ = n * size_t(options_.piece + 1) / size_t(options_.pieces);
    part_options_.piece = 0, part_options_.pieces = 1;
  }

  // Leaves count in the order of the file.
  bool is_mine() {
    if (stack_.size() != share_depth_) return true;
    const size_t i = leaf_++;
    return i >= share_begin_ && i < share_end_;
  }

  void read_blocks(const XmlFile& file, pugi::xml_node parent, Collection& out, size_t depth) {
    if (depth > most_depth) file.fail(fmt::format("nests blocks {} deep", depth), parent);
    for (const pugi::xml_node& n : parent.children()) {
      const std::string_view element = n.name();
      const bool leaf = element == "DataSet";
      if (!leaf && element != "Block" && element != "Piece" && element != "Partitions") continue;
      Collection::Part part{name_of(n, out.parts.size()), {}};
      if (!leaf) {
        auto inner = std::make_shared<Collection>();
        count(1);
        read_blocks(file, n, *inner, depth + 1);
        part.data = CollectionPtr(std::move(inner));
      } else {
        const std::string_view source = n.attribute("file").value();
        if (source.empty()) continue;  // a block without a mesh
        if (!is_mine()) continue;
        const std::optional<Data> data = read_named(file, source);
        if (!data) continue;
        part.data = *data;
      }
      out.parts.push_back(std::move(part));
    }
  }

  // Nothing for a file that is not there.
  std::optional<Data> read_named(const XmlFile& file, std::string_view source) {
    return with_context(fmt::format("reading the parts of '{}'", file.path()), [&]() -> std::optional<Data> {
      const std::string name = named_file(file.path(), source);
      if (missing_.lacks(name)) return std::nullopt;
      missing_.found();
      return read(name);
    });
  }

  static std::string name_of(pugi::xml_node n, size_t place) {
    if (const std::string_view name = n.attribute("name").value(); !name.empty()) return std::string(name);
    if (n.attribute("group") && n.attribute("dataset"))  // before version 1.0
      return fmt::format("{}.{}", n.attribute("group").value(), n.attribute("dataset").value());
    if (const std::string_view index = n.attribute("index").value(); !index.empty()) return std::string(index);
    return std::to_string(place);
  }

  Data read_series(const XmlFile& file) {
    const Steps steps = steps_of(file);
    if (steps.sets.empty()) file.fail("has no DataSet", file.dataset(), "the file is truncated or not complete");
    const size_t step = steps.times.empty() ? 0 : chosen_step(steps.times, options_, file.path());
    const auto& sets = steps.sets[step];
    take_share(only(sets));
    auto collection = std::make_shared<Collection>();
    size_t i = 0;
    for (const pugi::xml_node& n : sets) {
      const std::string_view source = n.attribute("file").value();
      if (source.empty()) file.fail("has no file", n, "expected the file name of that step");
      const size_t place = i++;
      if (!is_mine()) continue;
      std::optional<Data> data = read_named(file, source);
      if (!data) continue;
      if (!steps.times.empty()) data = at_time(*data, steps.times[step]);
      collection->parts.push_back({part_name(n, sets, place), std::move(*data)});
    }
    if (stack_.size() == 1) missing_.tell(file.path(), context_);
    if (sets.size() == 1 && !collection->parts.empty()) return collection->parts[0].data;
    return CollectionPtr(std::move(collection));
  }

  // A document with only these elements, for counting.
  pugi::xml_node only(const std::vector<pugi::xml_node>& sets) {
    counting_.reset();
    for (const pugi::xml_node& n : sets) counting_.append_copy(n);
    return counting_;
  }

  static Data at_time(const Data& data, double time) {
    return map_datasets(data, [&](const DatasetPtr& d) {
      if (d->time() == time) return d;
      DatasetParts parts = d->parts();
      parts.time = time;
      return make_dataset(std::move(parts));
    });
  }

  static std::string part_name(pugi::xml_node n, const std::vector<pugi::xml_node>& sets, size_t place) {
    if (const std::string_view name = n.attribute("name").value(); !name.empty()) return std::string(name);
    const std::string_view group = n.attribute("group").value(), part = n.attribute("part").value();
    bool one_group = true;
    for (const pugi::xml_node& other : sets) one_group = one_group && group == other.attribute("group").value();
    if (!part.empty()) return group.empty() || one_group ? std::string(part) : fmt::format("{}.{}", group, part);
    return group.empty() || one_group ? std::to_string(place) : std::string(group);
  }

  ReadOptions options_, part_options_;
  Context& context_;
  MissingFiles missing_;
  pugi::xml_document counting_;
  std::vector<std::string> stack_;
  std::map<std::string, Done> done_;
  size_t parts_ = 0, bytes_ = 0, leaf_ = 0, share_depth_ = 0, share_begin_ = 0, share_end_ = SIZE_MAX;
};

}  // namespace
}  // namespace vtk

bool sniff_vtk_multiblock(std::span<const std::byte> head) { return vtk::is_multiblock(vtk::type_in(head)); }
bool sniff_pvd(std::span<const std::byte> head) { return vtk::type_in(head) == "Collection"; }

Data read_vtk_multiblock(const std::string& path, const ReadOptions& options, Context& context) {
  return vtk::TreeReader(options, context).read(path);
}

Data read_pvd(const std::string& path, const ReadOptions& options, Context& context) {
  return vtk::TreeReader(options, context).read(path);
}

std::vector<double> times_of_pvd(const std::string& path, const ReadOptions&, Context&) { return vtk::steps_of(vtk::XmlFile(path)).times; }

}  // namespace sg
