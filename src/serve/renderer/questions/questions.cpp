// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/questions.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "data/cells/point_positions.h"
#include "filter/probe/probe.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "scene/choose/histogram.h"
#include "serve/renderer/questions/measures.h"
#include "serve/renderer/questions/place_values.h"
#include "serve/renderer/questions/probed_cell.h"
#include "serve/renderer/questions/transfer_questions.h"
#include "serve/renderer/wish.h"

namespace sg::serve {

namespace {

constexpr int64_t most_rows = 500, most_line_points = 4096;

Json vector_json(Vec3 v) { return numbers({v.x, v.y, v.z}); }

Json::Members answer_rows(const Json& q, const Data& data) {
  const bool cells = q["on"].text() == association_name(Association::cell);
  const size_t from = q["from"].whole(), wanted = std::min<size_t>(q["count"].whole(), most_rows);
  std::vector<const Field*> fields;
  std::vector<std::string> columns;
  size_t total = 0;
  DatasetPtr d;
  const Table* table = nullptr;
  if (const auto* t = std::get_if<TablePtr>(&data)) {
    table = t->get();
    for (const Field& f : table->columns) fields.push_back(&f), total = f.array.count();
  } else {
    for_each_dataset(data, [&](const std::string&, const DatasetPtr& part) {
      if (!d) d = part;
    });
    if (!d) return {{"total", Json(uint64_t(0))}, {"columns", list({})}, {"rows", Json(std::vector<Json>{})}};
    total = cells ? d->cell_count() : d->point_count();
    for (const Field& f : d->fields())
      if (f.association == (cells ? Association::cell : Association::point)) fields.push_back(&f);
    if (!cells) columns = {"x", "y", "z"};
  }
  for (const Field* f : fields) columns.push_back(f->name);
  std::vector<Json> rows;
  const bool places = d && !cells;
  const Array points = places ? point_positions(d->mesh()) : Array();
  for (size_t i = from; i < std::min(total, from + wanted); ++i) {
    std::vector<std::string> row;
    for (int a = 0; places && a < 3; ++a) row.push_back(short_number(points.get(i, a)));
    for (size_t c = 0; c < fields.size(); ++c) {
      const auto* words = table ? table->words(c) : nullptr;
      const double index = words ? fields[c]->array.get(i) : -1;
      if (words) row.push_back(index >= 0 ? (*words)[size_t(index)] : "");
      else row.push_back(value_text(fields[c]->array, i));
    }
    rows.push_back(list(row));
  }
  return {{"total", Json(uint64_t(total))}, {"columns", list(columns)}, {"rows", Json(std::move(rows))}};
}

Json::Members answer_line(const Json& q, const Data& data, Context& context) {
  DatasetPtr d;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& part) {
    if (!d) d = part;
  });
  if (!d) fail_usage("there are no values along a line of a table", "line");
  const Vec3 from = place_of(q["from"], "from"), to = place_of(q["to"], "to");
  const int64_t count = std::clamp<int64_t>(int64_t(q["count"].number()), 2, most_line_points);
  ProbeAtParams p;
  std::vector<Json> distances, values;
  for (int64_t i = 0; i < count; ++i) {
    const Vec3 at = from + (to - from) * (double(i) / double(count - 1));
    p.points.insert(p.points.end(), {at.x, at.y, at.z});
    distances.push_back(number(length(at - from)));
  }
  const DatasetPtr line = probe_at(d, p, context);
  const std::string name = bytes_of_text(q["field"].text());
  const Field* field = line->fields().find(name, Association::point);
  const Field* valid = line->fields().find("valid", Association::point);
  if (!field || !valid) fail_usage(fmt::format("there is no field '{}'", printable(name)), "line");
  const auto value_at = [&](size_t i) {
    if (field->components() == 1) return field->array.get(i);
    double squares = 0;
    for (int c = 0; c < field->components(); ++c) squares += field->array.get(i, c) * field->array.get(i, c);
    return std::sqrt(squares);
  };
  for (size_t i = 0; i < field->array.count(); ++i) values.push_back(valid->array.get(i) != 0 ? number(value_at(i)) : Json());
  return {{"unit", text(field->unit)}, {"distance", Json(std::move(distances))}, {"values", Json(std::move(values))}};
}

Json::Members answer_histogram(const Json& q, const Data& data, Context& context) {
  constexpr size_t bins = 64;
  const std::string name = bytes_of_text(q["field"].text());
  std::vector<size_t> sum(bins);
  Range range;
  std::vector<std::pair<DatasetPtr, const Field*>> fields;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    if (const Field* f = d->fields().find(name)) fields.emplace_back(d, f), range.add(d->range(*f));
  });
  if (fields.empty()) fail_usage(fmt::format("there is no field '{}'", printable(name)), "histogram");
  if (!range.empty() && range.lo < range.hi)
    for (const auto& [d, f] : fields) {
      const std::vector<size_t> counts = histogram(*f, -1, range.lo, range.hi, bins, context);
      for (size_t i = 0; i < bins; ++i) sum[i] += counts[i];
    }
  std::vector<Json> counts;
  for (const size_t n : sum) counts.emplace_back(uint64_t(n));
  return {{"range", range.empty() ? Json() : numbers({range.lo, range.hi})}, {"counts", Json(std::move(counts))}};
}

}  // namespace

Json::Members nothing_there() { return {{"position", Json()}, {"show", Json()}, {"values", Json(std::vector<Json>{})}, {"cell", Json()}}; }

Json::Members probe_picture(const DrawnPlanes& drawn, double x, double y, const PipelineFile& file, const PreparedPicture& prepared,
                            const std::shared_ptr<Cache>& cache, Context& context) {
  const size_t i = size_t(std::max(y, 0.0)) * size_t(drawn.width) + size_t(std::max(x, 0.0));
  if (!(x >= 0 && y >= 0 && x < drawn.width) || i >= drawn.seen.depth.size() || !std::isfinite(drawn.seen.depth[i])) return nothing_there();
  const double depth = double(drawn.seen.depth[i]);
  const Projection::Ray ray = drawn.projection.ray(std::floor(x) + 0.5 - drawn.area.x, std::floor(y) + 0.5 - drawn.area.y);
  Vec3 at = ray.origin + ray.direction * (depth * ray.per_depth);
  const Vec3& stretch = prepared.shown[0].stretch;
  for (int a = 0; a < 3; ++a) at[a] /= stretch[a];
  const uint32_t show = i < drawn.seen.show.size() ? drawn.seen.show[i] : 0;
  Json::Members answer{{"position", vector_json(at)}, {"show", show > 0 ? Json(uint64_t(show - 1)) : Json()}};
  std::vector<Json> values;
  std::optional<size_t> cell;
  if (show > 0 && show <= file.show.size()) {
    DatasetPtr nearest;
    Vec3 local = at;  // in the data's own coordinates, which a node of the scene has moved
    const std::vector<Affine> places = places_of_show(file, show - 1, cache, context);
    for_each_dataset(result_of(file, shown_step(file, show - 1), cache, context), [&](const std::string&, const DatasetPtr& d) {
      Box3 b = d->bounds();
      const double hair = 1e-3 * b.diagonal();
      for (const Affine& place : places) {
        const Vec3 there = inverse(place)(at);
        bool inside = !b.empty();
        for (int a = 0; a < 3; ++a) inside = inside && there[a] >= b.lo[a] - hair && there[a] <= b.hi[a] + hair;
        if (inside && !nearest) nearest = d, local = there;
      }
    });
    if (nearest) cell = probed_cell(nearest, local, context), values = values_at(nearest, local, cell, context);
  }
  answer.emplace_back("values", Json(std::move(values)));
  answer.emplace_back("cell", cell ? Json(uint64_t(*cell)) : Json());
  return answer;
}

Json::Members answer_about_steps(const Json& question, const PipelineFile& file, const PreparedPicture& prepared,
                                 const std::shared_ptr<Cache>& cache, const DrawnArea* area, Context& context) {
  const auto wish = wish_of(question);
  if (wish == Wish::proposals) return answer_proposals(question, prepared, context);
  if (wish == Wish::plane) return answer_plane(question, prepared, context);
  const Data data = result_of(file, bytes_of_text(question["step"].text()), cache, context);
  if (wish == Wish::rows) return answer_rows(question, data);
  if (wish == Wish::line) return answer_line(question, data, context);
  if (wish == Wish::histogram) return answer_histogram(question, data, context);
  if (wish == Wish::measures)
    return measures_of(data, selection_from(question["among"], area), bytes_of_text(question["field"].text()), context);
  fail_usage("that is no question", "question", "docs/protocol.md has them");
}

}  // namespace sg::serve
