// SPDX-License-Identifier: Apache-2.0
// An operation on every part of a collection, and what it says of them put together.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/alike_notes.h"
#include "data/cells/cell_type.h"
#include "data/lattice.h"
#include "pipeline/operation/operation.h"

namespace sg {

namespace {

using PartFunction = std::function<Data(const DatasetPtr&, Context&)>;

bool is_null(const Data& data) {
  return std::visit([](const auto& p) { return p == nullptr; }, data);
}

bool only_points_and_lines(const Dataset& d) {
  if (is_lattice(d.mesh())) return false;
  for (const auto& [name, count] : cell_type_counts(d.mesh()))
    for (int t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); count && info && info->name == name && info->dimension >= 2) return false;
  return true;
}

bool is_empty(const Data& data) {
  auto* d = std::get_if<DatasetPtr>(&data);
  return d && *d && (*d)->point_count() == 0;
}

struct Note {
  LogLevel level;
  std::string text;
  bool of_empty;  // nothing is left of the part
};

class Parts {
 public:
  Parts(const Data& data, Context& context, const PartFunction& f) : context_(context), f_(f) {
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { all_.push_back(d); });
  }

  Data map(const Data& data, const std::string& path) {
    if (auto* dataset = std::get_if<DatasetPtr>(&data)) return *dataset ? one(*dataset, path) : data;
    auto* collection = std::get_if<CollectionPtr>(&data);
    if (!collection || !*collection) return data;
    auto out = std::make_shared<Collection>();
    for (const Collection::Part& part : (*collection)->parts) {
      Data mapped = map(part.data, path.empty() ? part.name : path + "/" + part.name);
      if (!is_null(mapped)) out->parts.push_back({part.name, std::move(mapped)});
    }
    return CollectionPtr(out);
  }

  /// Throws what the first part was refused with when no part was taken.
  void finish(std::string_view who) const {
    if (refused_ && taken_ == 0) throw *refused_;
    if (refused_) {
      std::string names;
      for (size_t i = 0; i < std::min<size_t>(left_out_.size(), 3); ++i) names += fmt::format("{}'{}'", i ? ", " : "", left_out_[i]);
      if (left_out_.size() > 3) names += fmt::format(" and {} more", left_out_.size() - 3);
      context_.info(fmt::format("{}: parts of points and lines alone are left out: {}", who, names));
    }
    AlikeNotes told;
    for (const Note& n : notes_)
      if (!n.of_empty || n.level == LogLevel::warning || filled_ == 0) told.add(n.level, n.text);
    told.tell(context_);
  }

 private:
  Data one(const DatasetPtr& dataset, const std::string& path) {
    const size_t first = notes_.size();
    Context part(context_, 0, 1);
    part.parts = &all_;
    part.on_log = [&](LogLevel level, std::string_view text) { notes_.push_back({level, std::string(text), false}); };
    try {
      Data result = with_context(fmt::format("in part '{}'", path), [&] { return f_(dataset, part); });
      ++taken_;
      const bool empty = is_empty(result);
      filled_ += !empty;
      for (size_t i = first; i < notes_.size(); ++i) notes_[i].of_empty = empty;
      return result;
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::usage || !only_points_and_lines(*dataset)) throw;
      notes_.resize(first);
      left_out_.push_back(path);
      if (!refused_) refused_ = e;
      return DatasetPtr();
    }
  }

  Context& context_;
  const PartFunction& f_;
  std::vector<DatasetPtr> all_;
  std::vector<Note> notes_;
  std::vector<std::string> left_out_;
  std::optional<Error> refused_;
  size_t taken_ = 0, filled_ = 0;
};

}  // namespace

Data map_parts(const Data& data, std::string_view who, Context& context, const PartFunction& f) {
  if (is_null(data)) fail_internal("got no data", std::string(who));
  if (std::holds_alternative<TablePtr>(data))
    fail_usage("needs a mesh but got a table", std::string(who), "make points of its rows first: -f 'table_to_points x=... y=...'");
  if (auto* dataset = std::get_if<DatasetPtr>(&data)) return f(*dataset, context);
  Parts parts(data, context, f);
  Data result = parts.map(data, "");
  parts.finish(who);
  return result;
}

}  // namespace sg
